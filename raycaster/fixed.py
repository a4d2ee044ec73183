# SPDX-License-Identifier: MIT
"""Parts of a scene that are built into the hardware instead of being written to its registers."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class FixedRectangle:
    """A rectangle as the engines take it: its plane, and inclusive bounds on the other axes in the order x, y, z."""

    axis: int
    position: int
    u_low: int
    u_high: int
    v_low: int
    v_high: int
    colour: int
    """24 bits, red above green above blue."""

    mirror: int = 2
    """Reflectivity in quarters, 0..4."""

    kind: int = 0
    cell: int = 2
    colour_2: int = 0
    """Second colour, like `colour`; `kind` and `cell` are the pattern and its cell size as coded in the registers."""


@dataclass(frozen=True)
class FixedScene:
    """A scene whose rectangles, and optionally camera, background and light, are constants of the hardware.

    Attributes:
        rectangles: rectangles in the hardware, in the scene's order; at least one.
        passes: for the primary ray and each reflection, a mask of the rectangles it may meet: bit i for rectangle i.
        camera: x, y, z, or None if it is live.
        background: 24 bits, or None if it is live; fixed together with the camera.
        basis: forward, right and up of the fixed camera, times 256.
        shadows: for each pass, a mask of the rectangles that may shade its hit points; empty without a light.
        light: x, y, z of the fixed light and its shade in quarters, or None without one; fixed together with the
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
        """Fields of the fixed camera's record: position, basis and, if there is one, the light."""
        assert self.camera is not None
        vectors = zip(("", "forward_", "right_", "up_"), (self.camera, *self.basis), strict=True)
        fields = {f"{name}{axis}": part for name, vector in vectors for axis, part in zip("xyz", vector, strict=True)}
        if self.light:
            fields |= dict(zip(("light_x", "light_y", "light_z", "light_shade"), self.light, strict=True))
            fields["light_on"] = 1
        return fields

    @property
    def scope(self) -> str:
        """Scope of the fixed scene, as in the option: rects, or all."""
        return "rects" if self.camera is None else "all"

    @property
    def name(self) -> str:
        """Short file name, different for scenes that differ in anything fixed."""
        return f"{self.scope}-{hashlib.sha256(repr(self).encode()).hexdigest()[:8]}"


def varying_bits(values: Sequence[int]) -> int:
    """Return a mask of the bits that are not the same in all values."""
    mask = 0
    for value in values:
        mask |= value ^ values[0]
    return mask
