# SPDX-License-Identifier: MIT
"""The mirrored eye."""

from myhdl import always, always_comb, block

from raycaster.configuration import COORDINATE_BITS
from raycaster.rtl.common.legacy import Signs
from raycaster.rtl.common.widths import signed, unsigned


@block
def eye_register(clk, steps, camera, initial_signs, found_surface, eye, signs, mirror):
    """Where a ray seems to come from: the camera at steps.screen_to_ray, and its image in the mirror at store_ray.

    A ray reflected at plane k on axis a is the ray from E'[a] = 2k - E[a] with D'[a] = -D[a] and the same parameter
    (Heckbert and Hanrahan 1984), so no hit point is computed. initial_signs: the primary ray's, from the cycle after
    steps.screen_to_ray; signs: the ray's at hand, whose slope's magnitudes do not change; mirror: what it left last.
    """
    eye_bits = len(eye.x)
    flipped = Signs()
    twice = unsigned(COORDINATE_BITS + 1)
    twice_signed = signed(COORDINATE_BITS + 2)
    mirrored, image = signed(eye_bits), signed(eye_bits)
    difference = signed(eye_bits + 1)

    # The coordinate that the mirror changes.
    @always_comb
    def choose_axis():
        if found_surface.axis == 0:
            mirrored.next = eye.x
        elif found_surface.axis == 1:
            mirrored.next = eye.y
        else:
            mirrored.next = eye.z

    # Twice the plane.
    @always_comb
    def double():
        twice.next = 0
        twice.next[COORDINATE_BITS + 1 : 1] = found_surface.position

    # With a sign.
    @always_comb
    def extend():
        twice_signed.next = twice

    # From the eye to its image.
    @always_comb
    def reflect():
        difference.next = twice_signed - mirrored

    # What is kept of it fits; after the last mirror that there may be it might not, and nobody looks.
    @always_comb
    def fit():
        image.next = difference[eye_bits:].signed()

    # The eye, the mirror that it was last seen in, and which slopes all mirrors together have turned around.
    @always(clk.posedge)
    def keep():
        if steps.screen_to_ray:
            eye.x.next = camera.x
            eye.y.next = camera.y
            eye.z.next = camera.z
            flipped.dx.next = False
            flipped.dy.next = False
            flipped.dz.next = False
            mirror.active.next = False
        elif steps.store_ray:
            mirror.active.next = True
            mirror.axis.next = found_surface.axis
            mirror.position.next = found_surface.position
            if found_surface.axis == 0:
                eye.x.next = image
                flipped.dx.next = not flipped.dx
            elif found_surface.axis == 1:
                eye.y.next = image
                flipped.dy.next = not flipped.dy
            else:
                eye.z.next = image
                flipped.dz.next = not flipped.dz

    # The primary ray's signs, turned around.
    @always_comb
    def turn():
        signs.dx.next = initial_signs.dx != flipped.dx
        signs.dy.next = initial_signs.dy != flipped.dy
        signs.dz.next = initial_signs.dz != flipped.dz

    return choose_axis, double, extend, reflect, fit, keep, turn
