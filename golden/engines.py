# SPDX-License-Identifier: MIT
"""The golden model of whatever engine a design has."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raycaster.configuration import Configuration
from raycaster.golden import exact, seed_engine
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import UNTURNED, Basis, Scene


def render(config: Configuration, scene: Scene, reflections: int) -> np.ndarray:
    """The picture that a design must draw of a scene: uint8 (rows, columns, 3).

    Raises:
        ValueError: the scene needs what the design has not.
    """
    if lacking := scene.lacks(config.looks):
        raise ValueError(f"a design without {' and '.join(lacking)} does not draw this scene")
    camera = scene.camera
    return picture(
        config, Rectangles.of_scene(scene), camera.position, scene.background, reflections, basis=camera.basis
    )


def picture(
    config: Configuration,
    rectangles: Rectangles,
    camera: Sequence[int] | np.ndarray,
    background: Sequence[int],
    reflections: int,
    *,
    basis: Basis = UNTURNED,
) -> np.ndarray:
    """The same of what a scene comes down to; the arguments are those of `raycaster.golden.exact.picture`."""
    slopes = primary_slopes(config.screen_geometry, basis)
    traced = trace(config, rectangles, camera, background, slopes.reshape(-1, 3), reflections)
    return traced.colours.reshape(slopes.shape)


def trace(
    config: Configuration,
    rectangles: Rectangles,
    camera: Sequence[int] | np.ndarray,
    background: Sequence[int],
    slopes: np.ndarray,
    reflections: int,
) -> exact.Trace | seed_engine.Trace:
    """What becomes of rays; the arguments are those of `raycaster.golden.exact.trace`."""
    if not config.facts.divides:
        return exact.trace(rectangles, camera, background, slopes, reflections)
    return seed_engine.trace(
        rectangles, camera, background, slopes, reflections,
        fraction_bits=config.fraction_bits, rounding=config.rounding,
    )  # fmt: skip
