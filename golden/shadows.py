# SPDX-License-Identifier: MIT
"""Exact shadows of a point light: no point is rounded, so nothing leaks and no epsilon is needed.

A hit point P = N / e is lit if the light L lies strictly on the side that the ray came from, and no rectangle has a
point strictly between the two. The ray from the light has the integer slope S = N - e L, and meets P at t = 1 / e: a
shadow ray is a primary ray whose eye is the light. It meets a plane m on axis b at t = n / |S[b]|, n the distance
m - L[b] turned to S[b]'s sign, and before P where n e < |S[b]|.

Widths: |S| is at most 511 e, as P and L are within the world.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from raycaster.golden.world import Rectangles
from raycaster.scene import Light


@dataclass(frozen=True)
class Shading:
    """The light at the points that rays hit. For a ray that hit nothing, facing is False and shades is -1."""

    facing: np.ndarray
    """bool (rays,): the light is strictly on the side of the rectangle that the ray came from."""

    shades: np.ndarray
    """int64 (rays,): the first rectangle of the table between the point and the light, -1 for none and where the light
    is not on that side."""

    @property
    def lit(self) -> np.ndarray:
        """bool (rays,): the light reaches the point."""
        return self.facing & (self.shades < 0)


def dim(colours: np.ndarray, dark: np.ndarray, light: Light) -> None:
    """Leave the light's shade of the colours, uint8 (rays, 3), of dark points, in place; rounded down."""
    colours[dark] = light.quarters * colours[dark].astype(np.int64) >> 2


def shade(
    rectangles: Rectangles,
    light: Light,
    winners: np.ndarray,
    points: np.ndarray,
    denominators: np.ndarray,
    slopes: np.ndarray,
) -> Shading:
    """Find which hit points the light reaches.

    Args:
        rectangles: the table.
        light: the light.
        winners: int64 (rays,): the rectangle that was hit, -1 for none.
        points: int64 (rays, 3): the hit point, in world units times the denominator.
        denominators: int64 (rays,): denominators of the points, more than 0 where anything was hit.
        slopes: int64 (rays, 3): slopes of the rays; only the signs count.
    """
    position = np.array(light.position, dtype=np.int64)
    axes = rectangles.axes[winners]
    rays = np.arange(len(winners))
    beyond = position[axes] - rectangles.low[winners, axes]
    facing = (winners >= 0) & (np.sign(beyond) == -np.sign(slopes[rays, axes])) & (beyond != 0)
    shades = np.full(len(winners), -1, dtype=np.int64)
    asked = np.flatnonzero(facing)
    e, eye = denominators[asked], position[:, None]
    slope = points[asked].T - e * eye
    for index in np.flatnonzero(rectangles.visible)[::-1]:
        n, magnitude, within = rectangles.crossed(index, eye, slope)
        shades[asked[within & (n > 0) & (n * e < magnitude)]] = index
    return Shading(facing, shades)
