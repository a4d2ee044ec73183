# SPDX-License-Identifier: MIT
"""Whether a ray hits a rectangle, by cross-multiplication: no quotient, no rounding."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.records import Record
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def rect_tester(clk, steps, rect, eye, signs, slope, mirror, hit, at_mirror, numerator, denominator):
    """Test a ray against a rectangle per clock, by cross-multiplication: no quotient, no rounding.

    steps.find_intersection takes a rectangle and a ray; hit, at_mirror, numerator and denominator follow three cycles
    later.

    The ray runs from the eye E with the slope D. Where D is negative the axis is turned around: coordinates are
    complemented, which negates each difference of two, and the bounds change places. So with D its magnitude the plane
    k on axis a is at t = n / e, where n = k - E[a] and e = D[a], and where both are positive, near <= E[u] + D[u] n / e
    <= far becomes (near - E[u]) e <= D[u] n <= (far - E[u]) e (Kensler and Shirley 2006 test triangles so).

    A reflected ray must hit beyond its last mirror: on another axis the mirror's distance from the eye replaces the
    distance of a bound that is nearer; on the mirror's axis distances are compared. In the mirror's plane itself the
    ray hits a rectangle on another axis, for it reflects off all planes of a corner. With corners in the `Mirror`,
    at_mirror marks such a hit, and there is no hit where a mirror on the rectangle's axis was met in that very point.

    Widths are taken from the ports: those of coordinates from rect, of slopes from slope, and of the eye from eye,
    whose width fits any distance in the world.

    Args:
        clk: the clock.
        steps: `Steps`; only find_intersection is read.
        rect: `Rect`; read with steps.find_intersection.
        eye: `Eye`, E; read with steps.find_intersection.
        signs: `Signs` of the slope; read with steps.find_intersection.
        slope: `Slope`, the magnitudes; read with steps.find_intersection.
        mirror: `Mirror` that the ray left last; read with steps.find_intersection, except distance, which is read a
            cycle later.
        hit: output flag; the ray hits the rectangle. Valid in the third cycle after steps.find_intersection.
        at_mirror: output flag, where the `Mirror` has corners; the hit is in the plane of the mirror that the ray left
            last. Valid with hit, don't care unless hit is high. None without corners, where a ray has left one mirror.
        numerator: unsigned output; n. Valid with hit, don't care unless hit is high.
        denominator: unsigned output; e. Valid with hit, don't care unless hit is high.
    """
    coordinate_bits, slope_bits, eye_bits = len(rect.position), len(slope.dx), len(eye.x)
    distance_bits = eye_bits - 1
    way_bits = distance_bits + slope_bits
    corners = "met_x" in mirror.layout

    eye_a, eye_u, eye_v, turned_eye_a, turned_eye_u, turned_eye_v = (signed(eye_bits) for _ in range(6))
    e, slope_u, slope_v = (unsigned(slope_bits) for _ in range(3))
    back, back_u, back_v, mirror_on_a, mirror_on_u, mirror_on_v = (bit() for _ in range(6))
    position, low_u, high_u, low_v, high_v = (signed(coordinate_bits + 1) for _ in range(5))
    plane, near_u, far_u, near_v, far_v = (signed(coordinate_bits + 1) for _ in range(5))
    # One bit more than a distance and its sign take is for operands of two rays, while signals settle.
    n, to_near_u, to_far_u, to_near_v, to_far_v = (signed(eye_bits + 1) for _ in range(5))
    crosses, passed_u, passed_v = bit(), bit(), bit()

    # The number at a name's end is that of the stage whose registers have it.
    slope_u_1, slope_v_1 = unsigned(slope_bits), unsigned(slope_bits)
    to_near_u_1, to_far_u_1, to_near_v_1, to_far_v_1 = (unsigned(distance_bits) for _ in range(4))
    seen_1 = Record(
        dict.fromkeys(("crosses", "passed_u", "passed_v", "mirror_on_a", "mirror_on_u", "mirror_on_v"), 1)
        | {"n": distance_bits, "e": slope_bits}
    )
    beyond, clips_u, clips_v, behind_u, behind_v = (bit() for _ in range(5))
    first_u, first_v = unsigned(distance_bits), unsigned(distance_bits)
    way_u, way_v, way_to_near_u, way_to_far_u, way_to_near_v, way_to_far_v = (unsigned(way_bits) for _ in range(6))
    way_u_2, way_v_2, way_to_near_u_2, way_to_far_u_2, way_to_near_v_2, way_to_far_v_2 = (
        unsigned(way_bits) for _ in range(6)
    )
    seen_2 = Record({"crosses": 1, "behind_u": 1, "behind_v": 1, "n": distance_bits, "e": slope_bits})
    inside_u, inside_v = bit(), bit()
    again = bit() if corners else tied(0, 1)

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

    @always_comb
    def extend():
        position.next = rect.position
        low_u.next = rect.u_low
        high_u.next = rect.u_high
        low_v.next = rect.v_low
        high_v.next = rect.v_high

    @always_comb
    def turn():
        plane.next = position
        turned_eye_a.next = eye_a
        near_u.next = low_u
        far_u.next = high_u
        turned_eye_u.next = eye_u
        near_v.next = low_v
        far_v.next = high_v
        turned_eye_v.next = eye_v
        if back:
            plane.next = ~position
            turned_eye_a.next = ~eye_a
        if back_u:
            near_u.next = ~high_u
            far_u.next = ~low_u
            turned_eye_u.next = ~eye_u
        if back_v:
            near_v.next = ~high_v
            far_v.next = ~low_v
            turned_eye_v.next = ~eye_v

    @always_comb
    def measure():
        n.next = plane - turned_eye_a
        to_near_u.next = near_u - turned_eye_u
        to_far_u.next = far_u - turned_eye_u
        to_near_v.next = near_v - turned_eye_v
        to_far_v.next = far_v - turned_eye_v

    # Otherwise the plane is nowhere or behind the eye, or the far bound is. A near bound behind it is passed.
    @always_comb
    def judge_plane():
        crosses.next = (
            (not n[distance_bits]) and (n[distance_bits:] != 0) and (e != 0)
            and (not to_far_u[distance_bits]) and (not to_far_v[distance_bits])
        )  # fmt: skip
        passed_u.next = to_near_u[distance_bits]
        passed_v.next = to_near_v[distance_bits]

    @always(clk.posedge)
    def stage_1():
        if steps.find_intersection:
            slope_u_1.next = slope_u
            slope_v_1.next = slope_v
            to_near_u_1.next = to_near_u[distance_bits:]
            to_far_u_1.next = to_far_u[distance_bits:]
            to_near_v_1.next = to_near_v[distance_bits:]
            to_far_v_1.next = to_far_v[distance_bits:]
            seen_1.word.next = concat(
                crosses, passed_u, passed_v, mirror_on_a, mirror_on_u, mirror_on_v, n[distance_bits:], e
            )

    @always_comb
    def clip():
        beyond.next = seen_1.crosses and ((not seen_1.mirror_on_a) or (seen_1.n > mirror.distance))
        clips_u.next = seen_1.mirror_on_u and (seen_1.passed_u or (to_near_u_1 <= mirror.distance))
        clips_v.next = seen_1.mirror_on_v and (seen_1.passed_v or (to_near_v_1 <= mirror.distance))

    @always_comb
    def choose_first():
        first_u.next = to_near_u_1
        first_v.next = to_near_v_1
        behind_u.next = seen_1.passed_u and not clips_u
        behind_v.next = seen_1.passed_v and not clips_v
        if clips_u:
            first_u.next = mirror.distance
        if clips_v:
            first_v.next = mirror.distance

    @always_comb
    def multiply():
        way_u.next = seen_1.n * slope_u_1
        way_v.next = seen_1.n * slope_v_1
        way_to_near_u.next = first_u * seen_1.e
        way_to_far_u.next = to_far_u_1 * seen_1.e
        way_to_near_v.next = first_v * seen_1.e
        way_to_far_v.next = to_far_v_1 * seen_1.e

    @always(clk.posedge)
    def stage_2():
        way_u_2.next = way_u
        way_v_2.next = way_v
        way_to_near_u_2.next = way_to_near_u
        way_to_far_u_2.next = way_to_far_u
        way_to_near_v_2.next = way_to_near_v
        way_to_far_v_2.next = way_to_far_v
        seen_2.word.next = concat(beyond, behind_u, behind_v, seen_1.n, seen_1.e)

    @always_comb
    def compare():
        inside_u.next = (seen_2.behind_u or (way_to_near_u_2 <= way_u_2)) and (way_u_2 <= way_to_far_u_2)
        inside_v.next = (seen_2.behind_v or (way_to_near_v_2 <= way_v_2)) and (way_v_2 <= way_to_far_v_2)

    @always(clk.posedge)
    def stage_3():
        hit.next = seen_2.crosses and inside_u and inside_v and not again
        numerator.next = seen_2.n
        denominator.next = seen_2.e

    if corners:
        met, met_1, met_2 = bit(), bit(), bit()
        clipped_u_2, clipped_v_2, in_mirror = bit(), bit(), bit()

        @always_comb
        def see_met():
            if rect.axis == 0:
                met.next = mirror.met_x
            elif rect.axis == 1:
                met.next = mirror.met_y
            else:
                met.next = mirror.met_z

        @always(clk.posedge)
        def carry_corner():
            if steps.find_intersection:
                met_1.next = met
            met_2.next = met_1
            clipped_u_2.next = clips_u
            clipped_v_2.next = clips_v

        @always_comb
        def compare_with_mirror():
            in_mirror.next = (clipped_u_2 and (way_to_near_u_2 == way_u_2)) or (
                clipped_v_2 and (way_to_near_v_2 == way_v_2)
            )

        @always_comb
        def see_again():
            again.next = met_2 and in_mirror

        @always(clk.posedge)
        def tell_corner():
            at_mirror.next = in_mirror

    return instances()
