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

    mirror: int = 2
    """In quarters, 0..4."""

    kind: int = 0
    cell: int = 2
    colour_2: int = 0
    """With the pattern's kind and its cell's size as registers have them."""


@dataclass(frozen=True)
class FixedScene:
    """A scene whose rectangles are constants of the hardware, and its camera and background too where they are given.

    Attributes:
        rectangles: those that the hardware has, in the scene's order, at least one.
        passes: for the primary ray and each reflection, which of them it may meet: bit i for rectangle i.
        camera: x, y, z, or None where it is live.
        background: 24 bits, or None where it is live; it goes with the camera.
        basis: forward, right and up of the fixed camera, times 256.
        shadows: for each pass, which rectangles may shade what it hits, as in passes; empty without a light.
        light: x, y, z of the fixed light and its shade in quarters, or None where there is none; it goes with the
            camera.
    """

    rectangles: tuple[FixedRectangle, ...]
    passes: tuple[int, ...]
    camera: tuple[int, int, int] | None = None
    background: int | None = None
    basis: tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]] = (
        (256, 0, 0), (0, 256, 0), (0, 0, 256),
    )  # fmt: skip
    shadows: tuple[int, ...] = ()
    light: tuple[int, int, int, int] | None = None

    @property
    def camera_fields(self) -> dict[str, int]:
        """The fixed camera's position and basis, as its record names them."""
        vectors = zip(("", "forward_", "right_", "up_"), (self._eye, *self.basis), strict=True)
        fields = {f"{name}{axis}": part for name, vector in vectors for axis, part in zip("xyz", vector, strict=True)}
        if self.light:
            fields |= dict(zip(("light_x", "light_y", "light_z", "light_shade"), self.light, strict=True))
            fields["light_on"] = 1
        return fields

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
        return tuple(rectangle.position - self._eye[rectangle.axis] for rectangle in self.rectangles)

    @property
    def _eye(self) -> tuple[int, int, int]:
        if self.camera is None:
            raise ValueError("the camera is live")
        return self.camera

    def column(self, name: str) -> tuple[int, ...]:
        """One attribute of every rectangle."""
        return tuple(getattr(rectangle, name) for rectangle in self.rectangles)


def varying_bits(values: Sequence[int]) -> int:
    """The bits, as a mask, that are not the same in all values."""
    mask = 0
    for value in values:
        mask |= value ^ values[0]
    return mask
