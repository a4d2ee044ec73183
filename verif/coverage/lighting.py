# SPDX-License-Identifier: MIT
"""Functional coverage of shadows: the kinds of hit point in scenes with a light, counted in the golden model."""

from __future__ import annotations

from typing import SupportsIndex

import numpy as np

from raycaster.configuration import Configuration
from raycaster.golden.shadows import Shading
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import Scene
from raycaster.verif.coverage.functional import RAYS, Cross, traces

POINTS = {
    # The axis of the rectangle that was hit.
    "axis": ("x", "y", "z"),
    # The golden model's result.
    "light": ("in plane", "facing away", "shaded", "lit"),
    # In order of increasing precedence: where the line from the light to a point that faces it passes another
    # rectangle. The last two are strictly between light and point, exactly on a bound or inside.
    "passes": ("none", "behind light", "beyond point", "at light", "at point", "edge", "inside"),
    "ray": RAYS,
}
BETWEEN = "edge", "inside"
HIT_POINTS = Cross(
    "hit_points",
    POINTS,
    {
        "no shadow ray is sent to a point that does not face the light": tuple(
            (None, light, passes, None) for light in POINTS["light"][:2] for passes in POINTS["passes"][1:]
        ),
        "a point is in the shade of something between it and the light": tuple(
            (None, "shaded", passes, None) for passes in POINTS["passes"] if passes not in BETWEEN
        ),
        "nothing is between the light and a lit point": tuple((None, "lit", passes, None) for passes in BETWEEN),
    },
)
"""The points that rays hit in a scene with a light."""


def count_hit_points(scene: Scene, config: Configuration) -> np.ndarray:
    """Count the hit points of a scene's picture; int64, with one axis per point of `HIT_POINTS`."""
    if scene.light is None:
        return HIT_POINTS.counted([])
    light = np.array(scene.light.position, dtype=np.int64)
    return HIT_POINTS.counted(
        (*_kinds(rectangles, light, *values), ray)
        for rectangles, traced in traces(scene, config)
        for ray, values in enumerate(
            zip(traced.winners, traced.points, traced.denominators, traced.shadings, strict=True)
        )
    )


def _kinds(
    rectangles: Rectangles,
    light: np.ndarray,
    winners: np.ndarray,
    points: np.ndarray,
    denominators: np.ndarray,
    shading: Shading,
) -> tuple[np.ndarray, ...]:
    """Return the kinds of the hit points of rays, as in a `Trace`, without the last point."""
    hit = np.flatnonzero(winners >= 0)
    winner, facing = winners[hit], shading.facing[hit]
    axis = rectangles.axes[winner]
    in_plane = light[axis] == rectangles.low[winner, axis]
    result = np.select([in_plane, ~facing, ~shading.lit[hit]], [0, 1, 2], 3)
    passed = np.zeros_like(winner)
    for index in np.flatnonzero(rectangles.visible):
        others = facing & (winner != index)
        found = _passed(rectangles, index, light, points[hit], denominators[hit])
        passed = np.where(others, np.maximum(passed, found), passed)
    return axis, result, passed


def _passed(
    rectangles: Rectangles, index: SupportsIndex, light: np.ndarray, points: np.ndarray, denominators: np.ndarray
) -> np.ndarray:
    """Return where the lines from the light to the points, (rays, 3) over (rays,), pass a rectangle, as in `POINTS`."""
    eye = light[:, None]
    slope = points.T - denominators * eye
    n, magnitude, within = rectangles.crossed(index, eye, slope)
    extent = list(OTHER_AXES[rectangles.axes[index]])
    bounds = np.stack([rectangles.low[index], rectangles.high[index]])[:, extent, None] - eye[extent]
    on_bound = (bounds * magnitude == slope[extent] * n).any(axis=(0, 1))
    reached = n * denominators
    kinds = [
        (~within | (magnitude == 0), "none"),
        (n < 0, "behind light"),
        (reached > magnitude, "beyond point"),
        (n == 0, "at light"),
        (reached == magnitude, "at point"),
        (on_bound, "edge"),
    ]
    return np.select([which for which, _ in kinds], [POINTS["passes"].index(kind) for _, kind in kinds], 6)
