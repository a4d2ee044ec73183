# SPDX-License-Identifier: MIT
"""A test of a ray against a rectangle's two bounds on one axis."""

from myhdl import block, instances

from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus, register, times


@block
def extent_tester(
    clk, step, low, high, eye, back, slope, on_mirror, mirror_distance, n, e, ahead, between, in_mirror
):  # fmt: skip
    """Test whether a ray meets a plane between a rectangle's two bounds on an axis other than the plane's axis.

    The ray meets the plane at t = n / e. `rect_tester` explains the test: (near - E) e <= D n <= (far - E) e, where the
    axis is reversed for a negative D, and the last mirror's distance replaces the distance of a nearer bound.

    Args:
        step: strobe; takes low, high, eye, back, slope and on_mirror.
        low: unsigned; the lower bound, inclusive.
        high: unsigned, as wide as low; the upper bound, inclusive.
        eye: signed, wide enough for any distance in the world; E.
        back: flag; D is negative.
        slope: unsigned; |D|.
        on_mirror: flag; the mirror that the ray left last lies across this axis.
        mirror_distance: unsigned, one bit narrower than eye; the distance from the eye to that mirror. Read a cycle
            after step.
        n: unsigned, as wide as mirror_distance; the distance from the eye to the plane. Read a cycle after step.
        e: unsigned, as wide as slope; the slope towards the plane. Read a cycle after step.
        ahead: output flag, combinational, in the cycle of step; the far bound is not behind the eye.
        between: output flag; the ray meets the plane between the bounds, if ahead was high. Valid two cycles after
            step.
        in_mirror: output flag; the ray meets the plane where it meets the mirror. Valid two cycles after step.
    """
    distance_bits, coordinate_bits, slope_bits = len(eye) - 1, len(low) + 1, len(slope)
    way_bits = distance_bits + slope_bits

    lower, upper, near, far = (signed(coordinate_bits) for _ in range(4))
    flipped_eye = signed(len(eye))
    # One bit more than a signed distance needs: while signals settle, the operands may come from two rays.
    to_near, measure_near = minus(near, flipped_eye, Signed(len(eye) + 1))
    to_far, measure_far = minus(far, flipped_eye, Signed(len(eye) + 1))

    # A number at the end of a name is the stage whose registers hold it.
    slope_1, to_near_1, to_far_1 = unsigned(slope_bits), unsigned(distance_bits), unsigned(distance_bits)
    passed_1, on_mirror_1, clips, behind = bit(), bit(), bit(), bit()
    first = unsigned(distance_bits)
    way, multiply = times(n, slope_1, way_bits)
    way_to_near, multiply_near = times(first, e, way_bits)
    way_to_far, multiply_far = times(to_far_1, e, way_bits)
    way_2, way_to_near_2, way_to_far_2 = (unsigned(way_bits) for _ in range(3))
    behind_2, clips_2 = bit(), bit()

    extend = assign((lower, upper), lambda: (low, high))

    complement_near = assign(near, lambda: ~upper if back else lower)
    complement_far = assign(far, lambda: ~lower if back else upper)
    complement_flipped_eye = assign(flipped_eye, lambda: ~eye if back else eye)
    look_ahead = assign(ahead, lambda: not to_far[distance_bits])

    # passed_1: the near bound is behind the eye.
    stage_1 = register(
        clk,
        (slope_1, to_near_1, to_far_1, passed_1, on_mirror_1),
        lambda: (slope, to_near[distance_bits:], to_far[distance_bits:], to_near[distance_bits], on_mirror),
        step,
    )
    clip = assign(clips, lambda: on_mirror_1 and (passed_1 or (to_near_1 <= mirror_distance)))
    choose_first = assign(first, lambda: mirror_distance if clips else to_near_1)
    choose_behind = assign(behind, lambda: passed_1 and not clips)

    stage_2 = register(
        clk,
        (way_2, way_to_near_2, way_to_far_2, behind_2, clips_2),
        lambda: (way, way_to_near, way_to_far, behind, clips),
    )

    compare = assign(between, lambda: (behind_2 or (way_to_near_2 <= way_2)) and (way_2 <= way_to_far_2))
    see_mirror = assign(in_mirror, lambda: clips_2 and (way_to_near_2 == way_2))

    return instances()
