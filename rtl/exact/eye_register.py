# SPDX-License-Identifier: MIT
"""The mirrored eye."""

from myhdl import always, block, concat, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import AXIS_BITS, eye_distance_bits


class Mirror(Record):
    """The mirror that a ray left last, if `active`: the axis of its plane, and its distance from the eye.

    With more than one reflection, met_x, met_y, met_z: the axes of all mirrors that the ray met at that same point.
    """

    def __init__(self, config: Configuration, distance_bits: int | None = None):
        met = dict.fromkeys(("met_x", "met_y", "met_z"), int(config.most_reflections > 1))
        super().__init__({"active": 1, "axis": AXIS_BITS, "distance": distance_bits or eye_distance_bits(config)} | met)


@block
def eye_register(
    clk, steps, camera, initial_signs, found_surface, found_distance, found_at_mirror, eye, signs, mirror
):  # fmt: skip
    """Store the eye that a ray seems to come from: the camera at steps.screen_to_ray, its image at steps.store_ray.

    The image is the eye's reflection in the mirror. A ray reflected at plane k on axis a is the ray from E'[a] = 2k -
    E[a] with D'[a] = -D[a] and the same parameter t (Heckbert and Hanrahan 1984), so no hit point is computed. After
    the last mirror the image may not fit, and is don't care.

    Args:
        steps: `Steps`; only screen_to_ray and store_ray are read.
        camera: `Camera`; its position is read with steps.screen_to_ray.
        initial_signs: `Signs` of the primary ray; valid from the cycle after steps.screen_to_ray.
        found_surface: `Surface` of the mirror; read with steps.store_ray.
        found_distance: unsigned, as wide as mirror's distance; the distance from the eye to the plane of found_surface,
            and so from its image. Read with steps.store_ray.
        found_at_mirror: flag, read if the `Mirror` has corners; the hit is at the point where the ray left its last
            mirror. Read with steps.store_ray.
        eye: output `Vector`; valid from the cycle after steps.screen_to_ray or steps.store_ray.
        signs: output `Signs` of the current ray; the magnitudes of its slope do not change.
        mirror: output `Mirror` that the ray left last, not active for the primary ray; valid from the cycle after
            steps.screen_to_ray or steps.store_ray.
    """
    width = len(eye.x)
    flipped_x, flipped_y, flipped_z, dx, dy, dz, met_x, met_y, met_z = (bit() for _ in range(9))
    twice = unsigned(COORDINATE_BITS + 1)
    twice_signed = signed(COORDINATE_BITS + 2)
    mirrored, image = signed(width), signed(width)
    difference, reflect = minus(twice_signed, mirrored, Signed(width + 1))

    on_axis = by_axis(found_surface.axis, eye.x, eye.y, eye.z, mirrored, width=len(mirrored))

    double = assign(twice, lambda: concat(found_surface.position, False))
    extend = assign(twice_signed, lambda: twice)

    # The image fits after every mirror except the last, after which it is don't care.
    fit = assign(image, lambda: difference[width:].signed())

    # The eye, and the slope components that all mirrors together have reversed.
    @always(clk.posedge)
    def keep():
        if steps.screen_to_ray:
            eye.x.next, eye.y.next, eye.z.next = camera.x, camera.y, camera.z
            flipped_x.next = flipped_y.next = flipped_z.next = False
        elif steps.store_ray:
            if found_surface.axis == 0:
                eye.x.next = image
                flipped_x.next = not flipped_x
            elif found_surface.axis == 1:
                eye.y.next = image
                flipped_y.next = not flipped_y
            else:
                eye.z.next = image
                flipped_z.next = not flipped_z

    if mirror.has("met_x"):
        meet_x = assign(met_x, lambda: (found_surface.axis == 0) or (found_at_mirror and mirror.met_x))
        meet_y = assign(met_y, lambda: (found_surface.axis == 1) or (found_at_mirror and mirror.met_y))
        meet_z = assign(met_z, lambda: (found_surface.axis == 2) or (found_at_mirror and mirror.met_z))

    left = mirror.joined(
        active=True, axis=found_surface.axis, distance=found_distance, met_x=met_x, met_y=met_y, met_z=met_z
    )

    @always(clk.posedge)
    def leave():
        if steps.screen_to_ray:
            mirror.word.next = 0
        elif steps.store_ray:
            mirror.word.next = left

    flip_signs = assign(
        (dx, dy, dz),
        lambda: (initial_signs.dx != flipped_x, initial_signs.dy != flipped_y, initial_signs.dz != flipped_z),
    )

    all_signs = signs.joined(dx=dx, dy=dy, dz=dz)
    join_signs = assign(signs.word, lambda: all_signs)

    return instances()
