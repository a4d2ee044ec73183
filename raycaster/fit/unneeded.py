# SPDX-License-Identifier: MIT
"""Find the rectangles of a scene that no picture needs, and why."""

from __future__ import annotations

import numpy as np

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.output import printable
from raycaster.scene import Scene


def covered(rectangles: Rectangles) -> dict[int, int]:
    """Find rectangles that lie within an earlier one of the same plane; of two at one depth, the earlier is seen.

    In every engine a ray meets both at the same point and depth, rounded or not.

    Returns:
        For the index of each such rectangle, the index of the first one that covers it.
    """
    found: dict[int, int] = {}
    for index in np.flatnonzero(rectangles.visible):
        axis, extent = rectangles.axes[index], list(OTHER_AXES[rectangles.axes[index]])
        over = (
            (rectangles.axes == axis)
            & (rectangles.low[:, axis] == rectangles.low[index, axis])
            & (rectangles.low[:, extent] <= rectangles.low[index, extent]).all(axis=1)
            & (rectangles.high[:, extent] >= rectangles.high[index, extent]).all(axis=1)
        )
        over[index:] = False
        if over.any():
            found[int(index)] = int(over.argmax())
    return found


def unreachable(rectangles: Rectangles, reflections: int) -> list[set[int]]:
    """Find rectangles that no ray from any camera can reach: those at x = 0, as rays start there or beyond.

    The camera does not turn. A ray runs along +x until a mirror on x reverses it, which takes a mirror that is not at
    x = 0 itself.

    Returns:
        Indices of the rectangles, for the primary ray and each reflection.
    """
    on_x = rectangles.visible & (rectangles.axes == 0)
    at_0 = on_x & (rectangles.low[:, 0] == 0)
    behind = set(np.flatnonzero(at_0).tolist())
    reversed_ = set() if (on_x & ~at_0 & (rectangles.mirrors > 0)).any() else behind
    return [behind] + reflections * [reversed_]


def without_mirrors(rectangles: Rectangles, reflections: int) -> list[set[int]]:
    """Find rectangles that no reflected ray meets: all of them if nothing mirrors.

    Returns:
        Indices of the rectangles, for the primary ray and each reflection.
    """
    mirrored = (rectangles.visible & (rectangles.mirrors > 0)).any()
    return [set()] + reflections * [set() if mirrored else set(range(len(rectangles)))]


def at_the_edge(rectangles: Rectangles) -> set[int]:
    """Find rectangles in a plane at the world's edge, which have no point strictly between two points of the world."""
    planes = rectangles.low[np.arange(len(rectangles)), rectangles.axes]
    return set(np.flatnonzero(rectangles.visible & ((planes == 0) | (planes == WORLD_SIZE - 1))).tolist())


def needed(config: Configuration, scene: Scene, reflections: int) -> tuple[list[set[int]], list[set[int]]]:
    """Find rectangles that decide a pixel of the picture, with the golden model of the configured engine.

    Without the others, every ray meets the same rectangle as before, as the nearest one is still there; and each point
    in shadow keeps one of the rectangles that shade it.

    Args:
        config: only the engine, its fraction and rounding, and the screen are used.
        scene: scene whose rectangles are all enabled.
        reflections: number of reflections that are shown.

    Returns:
        For the primary ray and each reflection, the indices of the rectangles that a ray meets first; and likewise of
        those that shade its hit points, which is empty without a light.
    """
    slopes = primary_slopes(config.screen_geometry, scene.camera.basis).reshape(-1, 3)
    traced = model_of(config).trace(
        Rectangles.of_scene(scene), scene.camera.position, scene.background, slopes, reflections, light=scene.light
    )
    met, shades = (
        [set(np.unique(indices).tolist()) - {-1} for indices in every]
        for every in (traced.winners, [shading.shades for shading in traced.shadings])
    )
    return met, shades


def label(scene: Scene, index: int) -> str:
    """Return a rectangle's name, or its place in the file."""
    return printable(scene.rect[index].name) or f"rect[{index}]"
