# SPDX-License-Identifier: MIT
"""The point where a ray meets a rectangle's plane, and its test against the rectangle's bounds."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, unconnected, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.by_axis import along_a, along_u, along_v, by_axis
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits
from raycaster.rtl.seed.cell_parity import cell_parity
from raycaster.rtl.seed.intersection_helper import intersection_helper


@block
def intersection_finder(
    clk, steps, rect, offered, ray, slope, hit, depth, point, odd_u, odd_v, towards, config: Configuration
):
    """Find where a ray meets a rectangle's plane, and test that point against the rectangle's bounds.

    There are two a + b * (c - d) / e units (intersection_helper), one for each axis other than the plane's axis: u and
    v, in the order x, y, z.

    steps.find_intersection takes the plane of rect. hit, depth, point, odd_u and odd_v are valid in the second cycle
    after its steps.store_quotient, which is the cycle of steps.write_z_buf.

    Args:
        steps: `Steps`; find_intersection, load_divider and store_quotient are read.
        rect: `Rect` whose test starts; its axis and position are read with steps.find_intersection.
        offered: the same `Rect`, from the cycle after its steps.store_quotient on.
        ray: `Ray`; stable while the ray is traced.
        slope: `Slope`, the magnitudes; stable while the ray is traced.
        hit: output flag; the ray runs towards the plane, and meets it within offered's bounds. Valid with
            steps.write_z_buf.
        depth: unsigned output, `position_bits` bits, `config.fraction_bits` of them fraction bits; |distance| along x
            from the ray's start to the hit point. Valid with steps.write_z_buf.
        point: output `Origin`; the hit point. Valid with steps.write_z_buf.
        odd_u: output flag; the cell_parity of the point's u, valid with steps.write_z_buf. Driven with
            `config.patterns`.
        odd_v: output flag; the cell_parity of the point's v, valid with steps.write_z_buf. Driven with
            `config.patterns`.
        towards: output flag; the ray runs towards the plane. Valid from the cycle after steps.find_intersection.
    """
    fraction_bits, position_width = config.fraction_bits, position_bits(config)

    start_a, plane_start, plane_finish, u_origin, v_origin = (unsigned(position_width) for _ in range(5))
    u_low, u_high, v_low, v_high = (unsigned(position_width) for _ in range(4))
    u_slope, v_slope, e_slope = (unsigned(SLOPE_BITS) for _ in range(3))
    u_negative, v_negative, e_negative = bit(), bit(), bit()
    u_value, v_value = signed(position_width + 2), signed(position_width + 2)
    u_quotient, u_distance = unsigned(position_width), unsigned(position_width)
    u_valid, v_valid = bit(), bit()
    inside_u, inside_v = bit(), bit()
    u_helper = intersection_helper(
        clk=clk, steps=steps, a=u_origin, b=u_slope, b_negative=u_negative, c=plane_start, d=start_a, e=e_slope,
        e_negative=e_negative, value=u_value, quotient=u_quotient, distance=u_distance, valid=u_valid, towards=towards,
        config=config,
    )  # fmt: skip
    v_helper = intersection_helper(
        clk=clk, steps=steps, a=v_origin, b=v_slope, b_negative=v_negative, c=plane_start, d=start_a, e=e_slope,
        e_negative=e_negative, value=v_value, quotient=unconnected(position_width),
        distance=unconnected(position_width), valid=v_valid, towards=unconnected(1), config=config,
    )  # fmt: skip

    if offered.has("cell"):
        u_parity = cell_parity(value=u_value, size=offered.cell, odd=odd_u, config=config)
        v_parity = cell_parity(value=v_value, size=offered.cell, odd=odd_v, config=config)

    # Scene coordinates are whole units; here they get the fraction bits of origins.
    @always_comb
    def align():
        plane_start.next, plane_finish.next = rect.position << fraction_bits, offered.position << fraction_bits
        u_low.next, u_high.next = offered.u_low << fraction_bits, offered.u_high << fraction_bits
        v_low.next, v_high.next = offered.v_low << fraction_bits, offered.v_high << fraction_bits

    # The plane's axis selects the divisor (e, with d), the factor (b) and, for the rectangle whose quotients leave the
    # dividers, the addend (a).
    origin, slopes, negative = (ray.x, ray.y, ray.z), (slope.dx, slope.dy, slope.dz), (ray.dx, ray.dy, ray.dz)
    choices = [
        by_axis(axis, *along(*values), chosen, width=len(chosen))
        for axis, along, values, chosen in (
            (rect.axis, along_a, origin, start_a), (rect.axis, along_a, slopes, e_slope),
            (rect.axis, along_a, negative, e_negative),
            (rect.axis, along_u, slopes, u_slope), (rect.axis, along_u, negative, u_negative),
            (rect.axis, along_v, slopes, v_slope), (rect.axis, along_v, negative, v_negative),
            (offered.axis, along_u, origin, u_origin), (offered.axis, along_v, origin, v_origin),
        )
    ]  # fmt: skip

    @always_comb
    def compare_bounds():
        inside_u.next = (u_value >= u_low) and (u_value <= u_high)
        inside_v.next = (v_value >= v_low) and (v_value <= v_high)

    judge = assign(hit, lambda: u_valid and v_valid and inside_u and inside_v)

    # Depth is measured along x: for a plane across x it is the distance, and otherwise the quotient of u, which is x.
    at_u, at_v = u_value(position_width, 0), v_value(position_width, 0)
    point_x = point.joined(x=plane_finish, y=at_u, z=at_v)
    point_y = point.joined(x=at_u, y=plane_finish, z=at_v)
    point_z = point.joined(x=at_u, y=at_v, z=plane_finish)
    points = by_axis(offered.axis, point_x, point_y, point_z, point.word, width=len(point.word))
    depths = by_axis(offered.axis, u_distance, u_quotient, u_quotient, depth, width=len(depth))

    return instances()
