# SPDX-License-Identifier: MIT
"""The ray to test: the unit's own, or the one from the light."""

from myhdl import block, instances

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

    choose_tested_eye_x = assign(tested_eye.x, lambda: camera.light_x if from_light else eye.x)
    choose_tested_eye_y = assign(tested_eye.y, lambda: camera.light_y if from_light else eye.y)
    choose_tested_eye_z = assign(tested_eye.z, lambda: camera.light_z if from_light else eye.z)
    choose_dx = assign(tested_slope.dx, lambda: shadow_slope.dx if from_light else slope.dx)
    choose_dy = assign(tested_slope.dy, lambda: shadow_slope.dy if from_light else slope.dy)
    choose_dz = assign(tested_slope.dz, lambda: shadow_slope.dz if from_light else slope.dz)
    choose_tested_signs = assign(tested_signs.word, lambda: shadow_signs.word if from_light else signs.word)
    judge_mirror = assign(active, lambda: mirror.active and not from_light)

    left = tested_mirror.joined(
        active=active, axis=mirror.axis, distance=mirror.distance, met_x=mirror.met_x, met_y=mirror.met_y,
        met_z=mirror.met_z,
    )  # fmt: skip

    choose_mirror = assign(tested_mirror.word, lambda: left)

    return instances()
