# SPDX-License-Identifier: MIT
"""A test of a ray against a rectangle, by cross-multiplication: no quotient, no rounding."""

from myhdl import block, instances

from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus, register
from raycaster.rtl.common.by_axis import along_a, along_u, along_v, by_axis
from raycaster.rtl.exact.extent_tester import extent_tester

LATENCY = 3
"""Cycles from steps.find_intersection to the outputs."""


@block
def rect_tester(clk, steps, rect, eye, signs, slope, mirror, hit, at_mirror, numerator, denominator):
    """Test a ray against one rectangle per clock, by cross-multiplication: no quotient, no rounding.

    steps.find_intersection takes a rectangle and a ray; hit, at_mirror, numerator and denominator follow `LATENCY`
    cycles later.

    The ray runs from the eye E with the slope D. If a component of D is negative, its axis is reversed: coordinates are
    complemented, which negates each difference of two, and the bounds change places. So D is taken as magnitudes, and
    the ray meets the plane k on axis a at t = n / e, with n = k - E[a] and e = D[a]. If both are positive, near <= E[u]
    + D[u] n / e <= far becomes (near - E[u]) e <= D[u] n <= (far - E[u]) e (Kensler and Shirley 2006 test triangles
    this way).

    A reflected ray must hit beyond its last mirror. For a rectangle on another axis, the mirror's distance from the eye
    replaces the distance of a nearer bound; for one on the mirror's axis, the distances are compared. A hit in the
    mirror's plane itself, on a rectangle on another axis, counts, because a ray reflects off all planes of a corner:
    at_mirror marks it. With corners in the `Mirror`, it does not count if a mirror on the rectangle's axis was met at
    that same point.

    Widths are taken from the ports: of coordinates from rect, of slopes from slope, and of the eye from eye, which must
    be wide enough for any distance in the world.

    Args:
        steps: `Steps`; only find_intersection is read.
        rect: `Rect`; read with steps.find_intersection.
        eye: `Vector`, E; read with steps.find_intersection.
        signs: `Signs` of the slope; read with steps.find_intersection.
        slope: `Slope`, the magnitudes; read with steps.find_intersection.
        mirror: `Mirror` that the ray left last; read with steps.find_intersection, except distance, which is read a
            cycle later.
        hit: output flag; the ray hits the rectangle. Valid `LATENCY` cycles after steps.find_intersection.
        at_mirror: output flag; the hit is in the plane of the mirror that the ray left last. Valid with hit, don't care
            unless hit is high.
        numerator: unsigned output; n. Valid with hit, don't care unless hit is high.
        denominator: unsigned output; e. Valid with hit, don't care unless hit is high.
    """
    slope_bits, eye_bits = len(slope.dx), len(eye.x)
    coordinate_bits, distance_bits = len(rect.position) + 1, eye_bits - 1

    eye_a, eye_u, eye_v, flipped_eye = (signed(eye_bits) for _ in range(4))
    e, slope_u, slope_v = (unsigned(slope_bits) for _ in range(3))
    back, back_u, back_v, met = (bit() for _ in range(4))
    mirror_on_x, mirror_on_y, mirror_on_z, mirror_on_a, mirror_on_u, mirror_on_v = (bit() for _ in range(6))
    position, plane = signed(coordinate_bits), signed(coordinate_bits)
    # One bit more than a signed distance needs: while signals settle, the operands may come from two rays.
    n, measure = minus(plane, flipped_eye, Signed(eye_bits + 1))
    ahead_u, ahead_v, inside_u, inside_v, in_mirror_u, in_mirror_v = (bit() for _ in range(6))
    crosses, beyond, in_mirror = bit(), bit(), bit()

    # A number at the end of a name is the stage whose registers hold it; the last stage holds the outputs.
    seen_1, seen_2 = (
        Record({"crosses": 1, "mirror_on_a": int(stage == 1), "met": 1, "n": distance_bits, "e": slope_bits})
        for stage in range(1, LATENCY)
    )

    of_eye, of_slope, of_signs = (eye.x, eye.y, eye.z), (slope.dx, slope.dy, slope.dz), (signs.dx, signs.dy, signs.dz)
    of_mirror = mirror_on_x, mirror_on_y, mirror_on_z
    choices = [
        by_axis(rect.axis, *along(*values), chosen, width=len(chosen))
        for along, values, chosen in (
            (along_a, of_eye, eye_a), (along_u, of_eye, eye_u), (along_v, of_eye, eye_v),
            (along_a, of_slope, e), (along_u, of_slope, slope_u), (along_v, of_slope, slope_v),
            (along_a, of_signs, back), (along_u, of_signs, back_u), (along_v, of_signs, back_v),
            (along_a, of_mirror, mirror_on_a), (along_u, of_mirror, mirror_on_u), (along_v, of_mirror, mirror_on_v),
            (along_a, (mirror.met_x, mirror.met_y, mirror.met_z), met),
        )
    ]  # fmt: skip
    extents = [
        extent_tester(
            clk, steps.find_intersection, low=low, high=high, eye=eye_there, back=back_there, slope=slope_there,
            on_mirror=on_mirror, mirror_distance=mirror.distance, n=seen_1.n, e=seen_1.e, ahead=ahead, between=inside,
            in_mirror=at,
        )
        for low, high, eye_there, back_there, slope_there, on_mirror, ahead, inside, at in (
            (rect.u_low, rect.u_high, eye_u, back_u, slope_u, mirror_on_u, ahead_u, inside_u, in_mirror_u),
            (rect.v_low, rect.v_high, eye_v, back_v, slope_v, mirror_on_v, ahead_v, inside_v, in_mirror_v),
        )
    ]  # fmt: skip

    place_x = assign(mirror_on_x, lambda: mirror.active and (mirror.axis == 0))
    place_y = assign(mirror_on_y, lambda: mirror.active and (mirror.axis == 1))
    place_z = assign(mirror_on_z, lambda: mirror.active and (mirror.axis == 2))
    extend = assign(position, lambda: rect.position)
    complement_plane = assign(plane, lambda: ~position if back else position)
    complement_flipped_eye = assign(flipped_eye, lambda: ~eye_a if back else eye_a)

    # The plane is ahead of the eye and not parallel to the ray, and no far bound is behind the eye.
    judge_plane = assign(
        crosses, lambda: (not n[distance_bits]) and (n[distance_bits:] != 0) and (e != 0) and ahead_u and ahead_v
    )

    measured = seen_1.joined(crosses=crosses, mirror_on_a=mirror_on_a, met=met, n=n(distance_bits, 0), e=e)
    clipped = seen_2.joined(crosses=beyond, met=seen_1.met, n=seen_1.n, e=seen_1.e)

    stage_1 = register(clk, seen_1.word, lambda: measured, steps.find_intersection)
    clip = assign(beyond, lambda: seen_1.crosses and ((not seen_1.mirror_on_a) or (seen_1.n > mirror.distance)))
    stage_2 = register(clk, seen_2.word, lambda: clipped)
    compare_with_mirror = assign(in_mirror, lambda: in_mirror_u or in_mirror_v)
    judge = register(clk, hit, lambda: seen_2.crosses and inside_u and inside_v and not (seen_2.met and in_mirror))
    stage_3 = register(clk, (at_mirror, numerator, denominator), lambda: (in_mirror, seen_2.n, seen_2.e))

    return instances()
