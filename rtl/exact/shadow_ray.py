# SPDX-License-Identifier: MIT
"""The ray from the light to the point that a ray hit."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.by_axis import along_a, by_axis
from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def shadow_ray(
    clk, steps, camera, eye, signs, slope, found_surface, found_distance, found_slope, shadow_signs, shadow_slope,
    facing,
):  # fmt: skip
    """Compute the slope S of the ray from the light L to the hit point P, and on which side of the rectangle L lies.

    With P = (E e + D n) / e the slope S = e (P - L) = (E - L) e + D n has whole components, and the ray meets P at
    t = 1 / e. The eye E may be a mirrored one: D is turned around as often, so P is the point in the room.

    A component takes three cycles, and one begins in each cycle of steps.aim: x in the first, y, z. The outputs are
    valid from the cycle after the last cycle of steps.aim, until the next steps.aim.

    Args:
        clk: the clock.
        steps: `Steps`; only aim is read. All other inputs hold still while it is not 0, and eye and camera in the cycle
            before it too.
        camera: `Camera` with a light; only the light's position is read.
        eye: `Eye`, E.
        signs: `Signs` of the slope D.
        slope: `Slope`, the magnitudes of D.
        found_surface: `Surface` of the rectangle that was hit; only axis and position are read.
        found_distance: unsigned; n, the distance from the eye to the plane of found_surface.
        found_slope: unsigned; e, the magnitude of the slope on that plane's axis.
        shadow_signs: output `Signs` of S.
        shadow_slope: output `Slope`, the magnitudes of S.
        facing: output flag; the light is strictly on the side of the plane from which the ray came.
    """
    eye_bits, slope_bits, light_bits = len(eye.x), len(found_slope), len(shadow_slope.dx)
    sum_bits = light_bits + 1
    way_bits = max(eye_bits - 1 + slope_bits, sum_bits)

    at_y, at_z, x_ends, y_ends, z_ends = (bit() for _ in range(5))
    eye_q, light_q = signed(eye_bits), signed(eye_bits)
    slope_q, back_q = unsigned(slope_bits), bit()
    difference, difference_1 = signed(eye_bits + 1), signed(eye_bits + 1)
    slope_1, back_1 = unsigned(slope_bits), bit()
    e = signed(slope_bits + 1)
    position = signed(eye_bits + slope_bits + 2)
    way, turned_way = unsigned(way_bits), unsigned(way_bits)
    from_eye, along, aimed = (unsigned(sum_bits + 1) for _ in range(3))
    sum_2, inverse, negated = (unsigned(sum_bits) for _ in range(3))
    back_2 = bit()
    magnitude = unsigned(light_bits)
    dx, dy, dz = bit(), bit(), bit()
    back_a = bit()
    light_a = unsigned(len(camera.light_x))

    # The number at a name's end is that of the stage whose registers have it.
    @always_comb
    def see_axis():
        at_y.next = steps.aim[0]
        at_z.next = steps.aim[1]
        x_ends.next = steps.aim[1]
        y_ends.next = steps.aim[2]
        z_ends.next = steps.aim[3]

    @always_comb
    def choose_axis():
        if at_y:
            eye_q.next = eye.y
            light_q.next = camera.light_y
            slope_q.next = slope.dy
            back_q.next = signs.dy
        elif at_z:
            eye_q.next = eye.z
            light_q.next = camera.light_z
            slope_q.next = slope.dz
            back_q.next = signs.dz
        else:
            eye_q.next = eye.x
            light_q.next = camera.light_x
            slope_q.next = slope.dx
            back_q.next = signs.dx

    @always_comb
    def measure():
        difference.next = eye_q - light_q

    @always(clk.posedge)
    def stage_1():
        difference_1.next = difference
        slope_1.next = slope_q
        back_1.next = back_q

    @always_comb
    def extend():
        e.next = found_slope

    @always_comb
    def multiply():
        position.next = difference_1 * e
        way.next = found_distance * slope_1

    @always_comb
    def turn_way():
        turned_way.next = way
        if back_1:
            turned_way.next = ~way

    # A bit below the units carries the one that a complement lacks.
    @always_comb
    def add_carry():
        from_eye.next = concat(position[sum_bits:], True)
        along.next = concat(turned_way[sum_bits:], back_1)

    @always_comb
    def add():
        aimed.next = (from_eye + along) % (1 << (sum_bits + 1))

    @always(clk.posedge)
    def stage_2():
        sum_2.next = aimed[sum_bits + 1 : 1]

    @always_comb
    def invert():
        back_2.next = sum_2[light_bits]
        inverse.next = ~sum_2

    @always_comb
    def negate():
        negated.next = (inverse + 1) % (1 << sum_bits)

    @always_comb
    def measure_slope():
        magnitude.next = sum_2[light_bits:]
        if back_2:
            magnitude.next = negated[light_bits:]

    @always(clk.posedge)
    def keep():
        if x_ends:
            shadow_slope.dx.next = magnitude
            dx.next = back_2
        if y_ends:
            shadow_slope.dy.next = magnitude
            dy.next = back_2
        if z_ends:
            shadow_slope.dz.next = magnitude
            dz.next = back_2

    choices = [
        by_axis(found_surface.axis, *along_a(*values), chosen, width=len(chosen))
        for values, chosen in (
            ((camera.light_x, camera.light_y, camera.light_z), light_a), ((signs.dx, signs.dy, signs.dz), back_a),
        )
    ]  # fmt: skip

    @always(clk.posedge)
    def judge_side():
        if back_a:
            facing.next = light_a > found_surface.position
        else:
            facing.next = light_a < found_surface.position

    all_signs = shadow_signs.joined(dx=dx, dy=dy, dz=dz)

    @always_comb
    def join_signs():
        shadow_signs.word.next = all_signs

    return instances()
