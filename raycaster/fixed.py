# SPDX-License-Identifier: MIT
"""What of a scene is built into the hardware instead of being written to its registers."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class FixedRectangle:
    """A rectangle as the engines want it: its plane, and inclusive bounds on the other axes in the order x, y, z."""

    axis: int
    position: int
    u_low: int
    u_high: int
    v_low: int
    v_high: int
    colour: int
    """24 bits, red above green above blue."""


@dataclass(frozen=True)
class FixedScene:
    """A scene whose rectangles are constants of the hardware, and its camera and background too where they are given.

    Attributes:
        rectangles: those that the hardware has, in the scene's order, at least one.
        passes: for the primary ray and each reflection, which of them it may meet: bit i for rectangle i.
        camera: x, y, z, or None where it is live.
        background: 24 bits, or None where it is live; it goes with the camera.
    """

    rectangles: tuple[FixedRectangle, ...]
    passes: tuple[int, ...]
    camera: tuple[int, int, int] | None = None
    background: int | None = None

    @property
    def scope(self) -> str:
        """What is fixed, by the option's name for it: rects, or all."""
        return "rects" if self.camera is None else "all"

    @property
    def name(self) -> str:
        """A short file name that differs where anything fixed does."""
        return f"{self.scope}-{hashlib.sha256(repr(self).encode()).hexdigest()[:8]}"

    @property
    def distances(self) -> tuple[int, ...]:
        """From the fixed camera to each rectangle's plane, with the sign."""
        return tuple(rectangle.position - self.camera[rectangle.axis] for rectangle in self.rectangles)

    def column(self, name: str) -> tuple[int, ...]:
        """One attribute of every rectangle."""
        return tuple(getattr(rectangle, name) for rectangle in self.rectangles)


def varying_bits(values: Sequence[int]) -> int:
    """The bits, as a mask, that are not the same in all values."""
    mask = 0
    for value in values:
        mask |= value ^ values[0]
    return mask
