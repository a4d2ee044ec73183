# SPDX-License-Identifier: MIT
"""Whether a ray hits a rectangle, by cross-multiplication: no quotient, no rounding."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.records import Record
from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def rect_tester(clk, steps, rect, eye, signs, slope, mirror, hit, numerator, denominator):
    """A rectangle and ray a clock, at steps.find_intersection; hit, numerator, denominator follow three cycles later.

    The ray runs from the eye E with the slope D; the plane k on axis a is at t = n / e, where n = k - E[a], e = D[a],
    and both are negated where e is negative. Where n > 0 and e > 0, the bounds low <= E[u] + D[u] n / e <= high become
    (low - E[u]) e <= D[u] n <= (high - E[u]) e (Kensler and Shirley 2006 test triangles so). A reflected ray must hit
    strictly beyond its last mirror, on the side that its slope points to: on another axis the mirror's plane takes the
    place of the bound behind it, and equality no longer counts; on the same axis planes are compared.

    rect: a `Rect`; numerator, denominator: n and e, unsigned, don't care unless hit is high. Widths are the
    ports': coordinates' from rect, slopes' from slope, and the eye's, which any distance in the world fits, from eye.
    """
    coordinate_bits, slope_bits, eye_bits = len(rect.position), len(slope.dx), len(eye.x)
    way_bits = eye_bits + slope_bits

    eye_a, eye_u, eye_v = (signed(eye_bits) for _ in range(3))
    plane, low_u, high_u, low_v, high_v = (signed(coordinate_bits + 1) for _ in range(5))
    e, slope_u, slope_v = (unsigned(slope_bits) for _ in range(3))
    back, back_u, back_v = (bit() for _ in range(3))
    mirror_on_a, mirror_on_u, mirror_on_v = (bit() for _ in range(3))
    beyond, crosses = bit(), bit()
    open_low_u, open_high_u, open_low_v, open_high_v = (bit() for _ in range(4))

    distance, opposite_distance, n, n_u, n_v = (signed(eye_bits) for _ in range(5))
    to_low_u, to_high_u, to_low_v, to_high_v = (signed(eye_bits) for _ in range(4))

    # The number at a name's end is that of the stage whose registers have it.
    n_u_1, n_v_1, to_low_u_1, to_high_u_1, to_low_v_1, to_high_v_1 = (signed(eye_bits) for _ in range(6))
    e_1, slope_u_1, slope_v_1 = (signed(slope_bits + 1) for _ in range(3))
    carried = dict.fromkeys(("crosses", "open_low_u", "open_high_u", "open_low_v", "open_high_v"), 1)
    carried_1, carried_2 = (Record(carried | {"n": eye_bits - 1, "e": slope_bits}) for _ in range(2))
    way_u, way_v, way_to_low_u, way_to_high_u, way_to_low_v, way_to_high_v = (signed(way_bits) for _ in range(6))
    way_u_2, way_v_2, way_to_low_u_2, way_to_high_u_2, way_to_low_v_2, way_to_high_v_2 = (
        signed(way_bits) for _ in range(6)
    )
    above_low_u, below_high_u, above_low_v, below_high_v = (bit() for _ in range(4))

    @always_comb
    def choose_axes():
        if rect.axis == 0:
            eye_a.next = eye.x
            e.next = slope.dx
            back.next = signs.dx
        elif rect.axis == 1:
            eye_a.next = eye.y
            e.next = slope.dy
            back.next = signs.dy
        else:
            eye_a.next = eye.z
            e.next = slope.dz
            back.next = signs.dz
        if rect.axis == 0:
            eye_u.next = eye.y
            slope_u.next = slope.dy
            back_u.next = signs.dy
        else:
            eye_u.next = eye.x
            slope_u.next = slope.dx
            back_u.next = signs.dx
        if rect.axis == 2:
            eye_v.next = eye.y
            slope_v.next = slope.dy
            back_v.next = signs.dy
        else:
            eye_v.next = eye.z
            slope_v.next = slope.dz
            back_v.next = signs.dz

    @always_comb
    def place_mirror():
        mirror_on_a.next = mirror.active and (mirror.axis == rect.axis)
        if rect.axis == 0:
            mirror_on_u.next = mirror.active and (mirror.axis == 1)
        else:
            mirror_on_u.next = mirror.active and (mirror.axis == 0)
        if rect.axis == 2:
            mirror_on_v.next = mirror.active and (mirror.axis == 1)
        else:
            mirror_on_v.next = mirror.active and (mirror.axis == 2)

    # On the same axis, the plane must lie on the side that the ray runs to.
    @always_comb
    def compare_planes():
        if back:
            beyond.next = (not mirror_on_a) or (rect.position < mirror.position)
        else:
            beyond.next = (not mirror_on_a) or (rect.position > mirror.position)

    # The mirror may take the place of the bound behind the ray, on u, and on v.
    @always_comb
    def clip_u():
        low_u.next = rect.u_low
        high_u.next = rect.u_high
        open_low_u.next = False
        open_high_u.next = False
        if mirror_on_u and (not back_u) and (rect.u_low <= mirror.position):
            low_u.next = mirror.position
            open_low_u.next = True
        if mirror_on_u and back_u and (rect.u_high >= mirror.position):
            high_u.next = mirror.position
            open_high_u.next = True

    @always_comb
    def clip_v():
        low_v.next = rect.v_low
        high_v.next = rect.v_high
        open_low_v.next = False
        open_high_v.next = False
        if mirror_on_v and (not back_v) and (rect.v_low <= mirror.position):
            low_v.next = mirror.position
            open_low_v.next = True
        if mirror_on_v and back_v and (rect.v_high >= mirror.position):
            high_v.next = mirror.position
            open_high_v.next = True

    @always_comb
    def extend_plane():
        plane.next = rect.position

    @always_comb
    def measure():
        distance.next = plane - eye_a
        to_low_u.next = low_u - eye_u
        to_high_u.next = high_u - eye_u
        to_low_v.next = low_v - eye_v
        to_high_v.next = high_v - eye_v

    @always_comb
    def negate():
        opposite_distance.next = -distance

    # n, and n with the sign of the slope on u and on v, whose magnitude is all that is left to multiply by.
    @always_comb
    def choose_signs():
        n.next = distance
        n_u.next = distance
        n_v.next = distance
        if back:
            n.next = opposite_distance
        if back != back_u:
            n_u.next = opposite_distance
        if back != back_v:
            n_v.next = opposite_distance

    # Otherwise the plane is nowhere, behind the eye, or not beyond the mirror.
    @always_comb
    def judge_plane():
        crosses.next = beyond and (n > 0) and (e != 0)

    @always(clk.posedge)
    def stage_1():
        if steps.find_intersection:
            n_u_1.next = n_u
            n_v_1.next = n_v
            slope_u_1.next = slope_u
            slope_v_1.next = slope_v
            to_low_u_1.next = to_low_u
            to_high_u_1.next = to_high_u
            to_low_v_1.next = to_low_v
            to_high_v_1.next = to_high_v
            carried_1.word.next = concat(
                crosses, open_low_u, open_high_u, open_low_v, open_high_v, n[eye_bits - 1 :], e
            )

    @always_comb
    def extend_slope():
        e_1.next = carried_1.e

    @always_comb
    def multiply():
        way_u.next = n_u_1 * slope_u_1
        way_v.next = n_v_1 * slope_v_1
        way_to_low_u.next = to_low_u_1 * e_1
        way_to_high_u.next = to_high_u_1 * e_1
        way_to_low_v.next = to_low_v_1 * e_1
        way_to_high_v.next = to_high_v_1 * e_1

    @always(clk.posedge)
    def stage_2():
        way_u_2.next = way_u
        way_v_2.next = way_v
        way_to_low_u_2.next = way_to_low_u
        way_to_high_u_2.next = way_to_high_u
        way_to_low_v_2.next = way_to_low_v
        way_to_high_v_2.next = way_to_high_v
        carried_2.word.next = carried_1.word

    # A bound that the mirror made is open.
    @always_comb
    def compare():
        above_low_u.next = (way_to_low_u_2 < way_u_2) or ((not carried_2.open_low_u) and (way_to_low_u_2 == way_u_2))
        below_high_u.next = (way_u_2 < way_to_high_u_2) or (
            (not carried_2.open_high_u) and (way_u_2 == way_to_high_u_2)
        )
        above_low_v.next = (way_to_low_v_2 < way_v_2) or ((not carried_2.open_low_v) and (way_to_low_v_2 == way_v_2))
        below_high_v.next = (way_v_2 < way_to_high_v_2) or (
            (not carried_2.open_high_v) and (way_v_2 == way_to_high_v_2)
        )

    @always(clk.posedge)
    def stage_3():
        hit.next = carried_2.crosses and above_low_u and below_high_u and above_low_v and below_high_v
        numerator.next = carried_2.n
        denominator.next = carried_2.e

    return instances()
