# SPDX-License-Identifier: MIT
"""The ray from the light to the point that a ray hit."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus, register
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import AXIS_BITS
from raycaster.rtl.exact.hit_component import hit_component


@block
def shadow_ray(
    clk, steps, camera, eye, signs, slope, found_surface, found_distance, found_slope, shadow_signs, shadow_slope,
    facing,
):  # fmt: skip
    """Compute the slope S of the ray from the light L to the hit point P, and on which side of the rectangle L lies.

    With P = (E e + D n) / e the slope S = e (P - L) = (E - L) e + D n has integer components, and the ray meets P at t
    = 1 / e. The eye E may be a mirrored one: D is reversed with it, so P is the real point in the room.

    A component takes three cycles, and they follow each other: dx is stored in the second cycle of steps.aim, dy in the
    third, dz in the fourth. The outputs are valid from the cycle after the last cycle of steps.aim until the next
    steps.aim.

    Args:
        steps: `Steps`; only aim is read. All other inputs must be stable while it is not 0, and eye, signs, slope and
            camera also in the cycle before.
        camera: `Camera` with a light; only the light's position is read.
        eye: `Vector`, E.
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

    axis = unsigned(AXIS_BITS)
    eye_q, light = signed(eye_bits), signed(eye_bits)
    light_q, light_a = (unsigned(len(camera.light_x)) for _ in range(2))
    slope_q, back_q, back_a = unsigned(slope_bits), bit(), bit()
    difference, measure = minus(eye_q, light, Signed(eye_bits + 1))
    difference_1 = signed(eye_bits + 1)
    slope_1, back_1 = unsigned(slope_bits), bit()
    aimed, sum_2, inverse, negated = (unsigned(sum_bits) for _ in range(4))
    back_2 = bit()
    magnitude = unsigned(light_bits)
    dx, dy, dz = bit(), bit(), bit()

    # A number at the end of a name is the stage whose registers hold it.
    @always_comb
    def see_axis():
        axis.next = 0
        if steps.aim[0]:
            axis.next = 1
        elif steps.aim[1]:
            axis.next = 2

    of_light, of_signs = (camera.light_x, camera.light_y, camera.light_z), (signs.dx, signs.dy, signs.dz)
    choices = [
        by_axis(one, *values, chosen, width=len(chosen))
        for one, values, chosen in (
            (axis, (eye.x, eye.y, eye.z), eye_q), (axis, of_light, light_q), (axis, of_signs, back_q),
            (axis, (slope.dx, slope.dy, slope.dz), slope_q), (found_surface.axis, of_light, light_a),
            (found_surface.axis, of_signs, back_a),
        )
    ]  # fmt: skip

    extend = assign(light, lambda: light_q)

    stage_1 = register(clk, (difference_1, slope_1, back_1), lambda: (difference, slope_q, back_q))

    component = hit_component(
        eye=difference_1, back=back_1, slope=slope_1, distance=found_distance, e=found_slope, component=aimed
    )  # fmt: skip

    stage_2 = register(clk, sum_2, lambda: aimed)
    invert = assign((back_2, inverse), lambda: (sum_2[light_bits], ~sum_2))
    negate = assign(negated, lambda: (inverse + 1) % (1 << sum_bits))
    measure_slope = assign(magnitude, lambda: negated[light_bits:] if back_2 else sum_2[light_bits:])

    @always(clk.posedge)
    def keep():
        if steps.aim[1]:
            shadow_slope.dx.next, dx.next = magnitude, back_2
        if steps.aim[2]:
            shadow_slope.dy.next, dy.next = magnitude, back_2
        if steps.aim[3]:
            shadow_slope.dz.next, dz.next = magnitude, back_2

    judge_side = register(
        clk, facing, lambda: light_a > found_surface.position if back_a else light_a < found_surface.position
    )

    all_signs = shadow_signs.joined(dx=dx, dy=dy, dz=dz)
    join_signs = assign(shadow_signs.word, lambda: all_signs)

    return instances()
