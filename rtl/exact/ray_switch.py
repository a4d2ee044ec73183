# SPDX-License-Identifier: MIT
"""The ray to test: the unit's own, or the one from the light."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign


@block
def ray_switch(
    from_light, camera, eye, signs, slope, mirror, shadow_signs, shadow_slope, tested_eye, tested_signs, tested_slope,
    tested_mirror,
):  # fmt: skip
    """Choose between a unit's own ray and its shadow ray, which is a primary ray whose eye is the light. Combinational.

    Args:
        from_light: flag; chooses the shadow ray.
        camera: `Camera` with a light; only the light's position is read.
        eye: `Vector` of the unit's ray.
        signs: `Signs` of that ray's slope.
        slope: `Slope` of that ray, the magnitudes.
        mirror: `Mirror` that the unit's ray left last.
        shadow_signs: `Signs` of the shadow ray's slope.
        shadow_slope: `Slope` of the shadow ray, the magnitudes; at least as wide as slope.
        tested_eye: output `Vector`, as wide as eye.
        tested_signs: output `Signs`.
        tested_slope: output `Slope`, as wide as shadow_slope.
        tested_mirror: output `Mirror`, laid out like mirror; not active for the shadow ray.
    """
    active = bit()

    @always_comb
    def choose_ray():
        if from_light:
            tested_eye.x.next = camera.light_x
            tested_eye.y.next = camera.light_y
            tested_eye.z.next = camera.light_z
            tested_slope.dx.next = shadow_slope.dx
            tested_slope.dy.next = shadow_slope.dy
            tested_slope.dz.next = shadow_slope.dz
            tested_signs.word.next = shadow_signs.word
        else:
            tested_eye.x.next = eye.x
            tested_eye.y.next = eye.y
            tested_eye.z.next = eye.z
            tested_slope.dx.next = slope.dx
            tested_slope.dy.next = slope.dy
            tested_slope.dz.next = slope.dz
            tested_signs.word.next = signs.word

    judge_mirror = assign(active, lambda: mirror.active and not from_light)

    left = tested_mirror.joined(
        active=active, axis=mirror.axis, distance=mirror.distance, met_x=mirror.met_x, met_y=mirror.met_y,
        met_z=mirror.met_z,
    )  # fmt: skip

    choose_mirror = assign(tested_mirror.word, lambda: left)

    return instances()
