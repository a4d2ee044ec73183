# SPDX-License-Identifier: MIT
"""Where a ray meets a rectangle's plane, and whether inside the rectangle."""

from myhdl import always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import SLOPE_BITS, bit, position_bits, signed, unsigned
from raycaster.rtl.seed.intersection_helper import intersection_helper


@block
def intersection_finder(
    clk, steps, current_plane, finishing_rect, origin, signs, slope, hit, depth, point, ahead, config: Configuration
):
    """Two a + b * (c - d) / e units, one for each axis other than the plane's, and the test against the bounds.

    current_plane is taken at steps.find_intersection; finishing_rect is the same rectangle from the cycle after its
    store_quotient on. origin, signs and slope hold still while a ray is traced. hit, depth (|distance| along x, with
    the configured fraction) and point (the hit point) stand in the second cycle after store_quotient, which is
    steps.write_z_buf. ahead: the ray runs towards the plane, from the cycle after find_intersection.
    """
    fraction_bits = config.fraction_bits
    position_width = position_bits(config)

    start_a = unsigned(position_width)
    plane_start, plane_finish = unsigned(position_width), unsigned(position_width)
    u_slope, v_slope, e_slope = (unsigned(SLOPE_BITS) for _ in range(3))
    u_negative, v_negative, e_negative = bit(), bit(), bit()
    u_origin, v_origin = unsigned(position_width), unsigned(position_width)
    u_value, v_value = signed(position_width + 2), signed(position_width + 2)
    u_quotient, v_quotient = unsigned(position_width), unconnected(position_width)
    u_distance, v_distance = unsigned(position_width), unconnected(position_width)
    u_valid, v_valid = bit(), bit()
    u_low, u_high, v_low, v_high = (unsigned(position_width) for _ in range(4))
    inside_u, inside_v = bit(), bit()

    u_helper = intersection_helper(
        clk, steps, u_origin, u_slope, u_negative, plane_start, start_a, e_slope, e_negative,
        u_value, u_quotient, u_distance, u_valid, ahead, config,
    )  # fmt: skip
    v_helper = intersection_helper(
        clk, steps, v_origin, v_slope, v_negative, plane_start, start_a, e_slope, e_negative,
        v_value, v_quotient, v_distance, v_valid, unconnected(1), config,
    )  # fmt: skip

    # The plane's axis chooses what divides (e, and d beside it) and what is multiplied (b).
    @always_comb
    def choose_start():
        if current_plane.axis == 0:
            start_a.next = origin.x
            e_slope.next = slope.dx
            e_negative.next = signs.dx
            u_slope.next = slope.dy
            u_negative.next = signs.dy
            v_slope.next = slope.dz
            v_negative.next = signs.dz
        elif current_plane.axis == 1:
            start_a.next = origin.y
            e_slope.next = slope.dy
            e_negative.next = signs.dy
            u_slope.next = slope.dx
            u_negative.next = signs.dx
            v_slope.next = slope.dz
            v_negative.next = signs.dz
        else:
            start_a.next = origin.z
            e_slope.next = slope.dz
            e_negative.next = signs.dz
            u_slope.next = slope.dx
            u_negative.next = signs.dx
            v_slope.next = slope.dy
            v_negative.next = signs.dy

    # Scene coordinates are whole units; here they get the fraction that origins have.
    @always_comb
    def align():
        plane_start.next = 0
        plane_start.next[position_width:fraction_bits] = current_plane.position
        plane_finish.next = 0
        plane_finish.next[position_width:fraction_bits] = finishing_rect.position
        u_low.next = 0
        u_low.next[position_width:fraction_bits] = finishing_rect.u_low
        u_high.next = 0
        u_high.next[position_width:fraction_bits] = finishing_rect.u_high
        v_low.next = 0
        v_low.next[position_width:fraction_bits] = finishing_rect.v_low
        v_high.next = 0
        v_high.next[position_width:fraction_bits] = finishing_rect.v_high

    # What the quotients are added to, for the rectangle that comes out of the dividers.
    @always_comb
    def choose_finish():
        if finishing_rect.axis == 0:
            u_origin.next = origin.y
            v_origin.next = origin.z
        elif finishing_rect.axis == 1:
            u_origin.next = origin.x
            v_origin.next = origin.z
        else:
            u_origin.next = origin.x
            v_origin.next = origin.y

    # Bounds are inclusive.
    @always_comb
    def compare_bounds():
        inside_u.next = (u_value >= u_low) and (u_value <= u_high)
        inside_v.next = (v_value >= v_low) and (v_value <= v_high)

    # A hit needs both units' consent.
    @always_comb
    def judge():
        hit.next = u_valid and v_valid and inside_u and inside_v

    # Depth is measured along x: the plane's distance on that axis, the quotient of u (which is x) on the others.
    @always_comb
    def assemble():
        if finishing_rect.axis == 0:
            depth.next = u_distance
            point.x.next = plane_finish
            point.y.next = u_value[position_width:]
            point.z.next = v_value[position_width:]
        elif finishing_rect.axis == 1:
            depth.next = u_quotient
            point.x.next = u_value[position_width:]
            point.y.next = plane_finish
            point.z.next = v_value[position_width:]
        else:
            depth.next = u_quotient
            point.x.next = u_value[position_width:]
            point.y.next = v_value[position_width:]
            point.z.next = plane_finish

    return u_helper, v_helper, choose_start, align, choose_finish, compare_bounds, judge, assemble
