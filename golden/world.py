# SPDX-License-Identifier: MIT
"""The rectangle table that the golden models read, laid out like that of the hardware."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import SupportsIndex

import numpy as np

from raycaster.fixed import FixedRectangle
from raycaster.scene import CELLS, Scene

OTHER_AXES = ((1, 2), (0, 2), (0, 1))
"""u and v, the two axes along which a rectangle extends, by the axis of its plane (0, 1, 2 for x, y, z)."""


@dataclass(frozen=True)
class Rectangles:
    """Rectangles by index; of two at equal depth, the one with the lower index is seen."""

    corners: np.ndarray
    """int64 (rectangles, 2, 3): two opposite corners in any order, in world units 0..511."""

    colours: np.ndarray
    """uint8 (rectangles, 3): red, green, blue."""

    enabled: np.ndarray
    """bool (rectangles,)."""

    mirrors: np.ndarray = field(default_factory=lambda: np.array(2))
    """int64 (rectangles,): how much each mirrors, in quarters 0..4; 2 by default."""

    kinds: np.ndarray = field(default_factory=lambda: np.array(0))
    """int64 (rectangles,): the patterns, 0 plain, 1 checker, 2 rows, 3 columns; plain by default."""

    cells: np.ndarray = field(default_factory=lambda: np.array(32))
    """int64 (rectangles,): sizes of the patterns' cells, in world units, powers of two; 32 by default."""

    colours_2: np.ndarray = field(default_factory=lambda: np.zeros(3, dtype=np.uint8))
    """uint8 (rectangles, 3): colours of every other cell; black by default."""

    def __post_init__(self):
        for name, shape in (("mirrors", ()), ("kinds", ()), ("cells", ()), ("colours_2", (3,))):
            if (value := getattr(self, name)).shape == shape:  # a default, which applies to every rectangle
                object.__setattr__(self, name, np.full((len(self), *shape), value))

    @classmethod
    def of_scene(cls, scene: Scene) -> Rectangles:
        """Return the scene's rectangles in the file's order, all enabled."""
        return cls(
            corners=np.array([rectangle.corners for rectangle in scene.rect], dtype=np.int64),
            colours=np.array([rectangle.colour for rectangle in scene.rect], dtype=np.uint8),
            enabled=np.ones(len(scene.rect), dtype=bool),
            mirrors=np.array([rectangle.quarters for rectangle in scene.rect], dtype=np.int64),
            kinds=np.array([rectangle.kind for rectangle in scene.rect], dtype=np.int64),
            cells=np.array([rectangle.cell for rectangle in scene.rect], dtype=np.int64),
            colours_2=np.array([rectangle.colour2 or (0, 0, 0) for rectangle in scene.rect], dtype=np.uint8),
        )

    @classmethod
    def of_fixed(cls, rectangles: Sequence[FixedRectangle]) -> Rectangles:
        """Return the rectangles that are built into a design, all enabled."""
        corners = []
        for one in rectangles:
            low, high = [one.u_low, one.v_low], [one.u_high, one.v_high]
            for corner in (low, high):
                corner.insert(one.axis, one.position)
            corners.append([low, high])
        return cls(
            corners=np.array(corners, dtype=np.int64),
            colours=np.array([list(one.colour.to_bytes(3)) for one in rectangles], dtype=np.uint8),
            enabled=np.ones(len(rectangles), dtype=bool),
            mirrors=np.array([one.mirror for one in rectangles], dtype=np.int64),
            kinds=np.array([one.kind for one in rectangles], dtype=np.int64),
            cells=np.array([CELLS[one.cell] for one in rectangles], dtype=np.int64),
            colours_2=np.array([list(one.colour_2.to_bytes(3)) for one in rectangles], dtype=np.uint8),
        )

    def __len__(self) -> int:
        return len(self.enabled)

    @cached_property
    def low(self) -> np.ndarray:
        """int64 (rectangles, 3): the lesser coordinate of the two corners, axis by axis; inclusive."""
        return self.corners.min(axis=1)

    @cached_property
    def high(self) -> np.ndarray:
        """int64 (rectangles, 3): the greater coordinate of the two corners, axis by axis; inclusive."""
        return self.corners.max(axis=1)

    @cached_property
    def axes(self) -> np.ndarray:
        """int64 (rectangles,): the first of x, y, z (0, 1, 2) that is equal in both corners; -1 for no plane."""
        equal = self.low == self.high
        return np.where(equal.any(axis=1), equal.argmax(axis=1), -1)

    @cached_property
    def visible(self) -> np.ndarray:
        """bool (rectangles,): enabled and with a plane; rays pass through the others."""
        return self.enabled & (self.axes >= 0)

    def crossed(
        self, index: SupportsIndex, eye: np.ndarray, slope: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Find where straight lines cross a rectangle's plane, by cross-multiplication: nothing is divided.

        Args:
            index: the rectangle, which has a plane.
            eye: int64 (3, lines), or (3, 1) for one eye: a point of each line.
            slope: int64 (3, lines).

        Returns:
            n and e, int64 (lines,): a line crosses the plane at t = n / e; e is 0 or more, and 0 for a parallel line.
            bool (lines,): the crossing is within the bounds. Don't care where e is 0.
        """
        axis, low, high = self.axes[index], self.low[index], self.high[index]
        n = (low[axis] - eye[axis]) * np.sign(slope[axis])
        e = np.abs(slope[axis])
        within = np.ones(n.shape, dtype=bool)
        for u in OTHER_AXES[axis]:
            way = slope[u] * n
            within &= ((low[u] - eye[u]) * e <= way) & (way <= (high[u] - eye[u]) * e)
        return n, e, within
