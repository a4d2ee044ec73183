# SPDX-License-Identifier: MIT
"""Where a ray meets a rectangle's plane, and whether inside the rectangle."""

from myhdl import always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import SLOPE_BITS, bit, position_bits, signed, unsigned
from raycaster.rtl.seed.cell_parity import cell_parity
from raycaster.rtl.seed.intersection_helper import intersection_helper


@block
def intersection_finder(
    clk, steps, rect, offered, ray, slope, hit, depth, point, odd_u, odd_v, towards, config: Configuration
):
    """Find where a ray meets a rectangle's plane, and test that point against the rectangle's bounds.

    There are two a + b * (c - d) / e units (intersection_helper), one for each axis other than the plane's: u and v, in
    the order x, y, z.

    steps.find_intersection takes the plane of rect. hit, depth, point, odd_u and odd_v are valid in the second cycle
    after its steps.store_quotient, which is the cycle of steps.write_z_buf.

    Args:
        clk: the clock.
        steps: `Steps`; find_intersection, load_divider and store_quotient are read.
        rect: `Rect` to start on; its axis and position are read with steps.find_intersection.
        offered: the same `Rect`, from the cycle after its steps.store_quotient on.
        ray: `Ray`; holds still while the ray is traced.
        slope: `Slope`, the magnitudes; holds still while the ray is traced.
        hit: output flag; the ray runs towards the plane, and meets it within offered's bounds. Valid with
            steps.write_z_buf.
        depth: unsigned output, `position_bits` bits, `config.fraction_bits` of them fraction bits; |distance| along x
            from the ray's start to the hit point. Valid with steps.write_z_buf.
        point: output `Origin`; the hit point. Valid with steps.write_z_buf.
        odd_u: output flag; the cell_parity of the point's u, valid with steps.write_z_buf. None without
            `config.patterns`.
        odd_v: output flag; the cell_parity of the point's v, valid with steps.write_z_buf. None without
            `config.patterns`.
        towards: output flag; the ray runs towards the plane. Valid from the cycle after steps.find_intersection.
        config: the design.
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

    if config.patterns:
        u_parity = cell_parity(value=u_value, size=offered.cell, odd=odd_u, config=config)
        v_parity = cell_parity(value=v_value, size=offered.cell, odd=odd_v, config=config)

    # Scene coordinates are whole units; here they get the fraction that origins have.
    @always_comb
    def align():
        plane_start.next = rect.position << fraction_bits
        plane_finish.next = offered.position << fraction_bits
        u_low.next = offered.u_low << fraction_bits
        u_high.next = offered.u_high << fraction_bits
        v_low.next = offered.v_low << fraction_bits
        v_high.next = offered.v_high << fraction_bits

    # The plane's axis chooses what divides (e, and d beside it) and what is multiplied (b).
    @always_comb
    def choose_start():
        if rect.axis == 0:
            start_a.next = ray.x
            e_slope.next = slope.dx
            e_negative.next = ray.dx
            u_slope.next = slope.dy
            u_negative.next = ray.dy
            v_slope.next = slope.dz
            v_negative.next = ray.dz
        elif rect.axis == 1:
            start_a.next = ray.y
            e_slope.next = slope.dy
            e_negative.next = ray.dy
            u_slope.next = slope.dx
            u_negative.next = ray.dx
            v_slope.next = slope.dz
            v_negative.next = ray.dz
        else:
            start_a.next = ray.z
            e_slope.next = slope.dz
            e_negative.next = ray.dz
            u_slope.next = slope.dx
            u_negative.next = ray.dx
            v_slope.next = slope.dy
            v_negative.next = ray.dy

    # What the quotients are added to, for the rectangle that comes out of the dividers.
    @always_comb
    def choose_finish():
        if offered.axis == 0:
            u_origin.next = ray.y
            v_origin.next = ray.z
        elif offered.axis == 1:
            u_origin.next = ray.x
            v_origin.next = ray.z
        else:
            u_origin.next = ray.x
            v_origin.next = ray.y

    @always_comb
    def compare_bounds():
        inside_u.next = (u_value >= u_low) and (u_value <= u_high)
        inside_v.next = (v_value >= v_low) and (v_value <= v_high)

    @always_comb
    def judge():
        hit.next = u_valid and v_valid and inside_u and inside_v

    # Depth is measured along x: the plane's distance on that axis, the quotient of u (which is x) on the others.
    @always_comb
    def assemble():
        if offered.axis == 0:
            depth.next = u_distance
            point.word.next = concat(plane_finish, u_value[position_width:], v_value[position_width:])
        elif offered.axis == 1:
            depth.next = u_quotient
            point.word.next = concat(u_value[position_width:], plane_finish, v_value[position_width:])
        else:
            depth.next = u_quotient
            point.word.next = concat(u_value[position_width:], v_value[position_width:], plane_finish)

    return instances()
