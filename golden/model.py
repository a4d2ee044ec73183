# SPDX-License-Identifier: MIT
"""Base of the golden models: rays followed from mirror to mirror, and the pictures that they make."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from raycaster.configuration import FEATURES
from raycaster.golden.colour import blend, hit_colours
from raycaster.golden.rays import primary_slopes
from raycaster.golden.shadows import Shading, dim, shade
from raycaster.golden.world import Rectangles
from raycaster.scene import UNTURNED, Basis, Light, Scene
from raycaster.screens import Screen


@dataclass(frozen=True)
class Bounce:
    """All values of every ray between two mirrors.

    Lengths in the exact model are in world units, in the seed engine's model in units of 2^-F; slopes are in world
    units. Rows of rectangles that are disabled or have no plane are all 0.
    """

    origins: np.ndarray
    """int64 (rays, 3): where rays start. Exact: the eye, mirrored in all mirrors so far. Seed: the eye, or the
    last hit point as stored; a ray that has ended stays there."""

    slopes: np.ndarray
    """int64 (rays, 3): slopes of the rays, after the reflections so far."""

    met: np.ndarray
    """bool (rays, 3): axes on which a plane through the ray's start is not hit. Exact: the axes of the mirrors that it
    met there, and all axes for a ray from the eye. Seed: all."""

    alive: np.ndarray
    """bool (rays,): the ray has hit something that mirrors at every bounce before."""

    numerators: np.ndarray
    """int64 (rectangles, rays): n = plane - origin along the rectangle's axis. Exact: times the sign of the slope, so
    that positive is ahead."""

    denominators: np.ndarray
    """int64 (rectangles, rays): e, the slope along the rectangle's axis. Exact: its magnitude."""

    scales: np.ndarray
    """int64 (rectangles, rays): the denominator of quotients, points and depths in world units. Exact: |e|, 0 for a
    parallel ray. Seed: 2^F."""

    quotients: np.ndarray
    """int64 (rectangles, rays, 2): the distance from the origin along u and v. Seed: magnitudes |slope n / e|, rounded;
    0 where not valid. Exact: none, 0."""

    valid: np.ndarray
    """bool (rectangles, rays, 2): the coordinates on u and v exist: the plane is ahead, beyond the last mirror or in a
    corner with it. Seed: also, the quotient fits its bits."""

    points: np.ndarray
    """int64 (rectangles, rays, 3): the point on the rectangle's plane. Seed: 0 on u and v where not valid."""

    depths: np.ndarray
    """int64 (rectangles, rays): the distance along x. Exact: from the eye via all mirrors, with the sign of n. Seed:
    from the origin; don't care unless hit."""

    hits: np.ndarray
    """bool (rectangles, rays): the ray is alive, and both coordinates are valid and within the bounds."""

    @classmethod
    def empty(cls, count: int, origin: np.ndarray, slope: np.ndarray, met: np.ndarray, alive: np.ndarray) -> Bounce:
        """Return a bounce of rays, given as (3, rays), with all values of `count` rectangles 0."""
        shapes = {name: () for name in ("numerators", "denominators", "scales", "depths")}
        numbers = {**shapes, "quotients": (2,), "points": (3,)}
        return cls(
            origins=origin.T.copy(), slopes=slope.T.copy(), met=met.T.copy(), alive=alive.copy(),
            **{name: np.zeros((count, len(alive), *shape), dtype=np.int64) for name, shape in numbers.items()},
            valid=np.zeros((count, len(alive), 2), dtype=bool), hits=np.zeros((count, len(alive)), dtype=bool),
        )  # fmt: skip

    def note(self, rectangle: SupportsIndex, **values: ArrayLike) -> None:
        """Store the values of a rectangle, given by the names of the arrays."""
        for name, value in values.items():
            getattr(self, name)[rectangle] = value


class Meeting(NamedTuple):
    """Hits of rays between two mirrors; a later meeting changes none of these arrays."""

    winners: np.ndarray
    """As in `Trace`."""

    points: np.ndarray
    """As in `Trace`."""

    denominators: np.ndarray
    """As in `Trace`."""

    slopes: np.ndarray
    """(rays, 3): slopes of the rays that met these winners."""

    bounce: Bounce | None
    """All other values, if they are kept."""


@dataclass(frozen=True)
class Trace:
    """Ray-tracing results: the pixels, then a tuple with an entry for the primary ray and for each reflection."""

    colours: np.ndarray
    """uint8 (rays, 3)."""

    winners: tuple[np.ndarray, ...]
    """int64 (rays,): index of the rectangle hit, -1 for a miss and after a hit that does not mirror."""

    seen: tuple[np.ndarray, ...]
    """uint8 (rays, 3): the colour at the hit point, in the light or in the dark; the background for a miss."""

    shadings: tuple[Shading, ...]
    """The light at each hit point; empty without a light."""

    points: tuple[np.ndarray, ...]
    """int64 (rays, 3): the hit point, in world units times the denominator. Seed: for a miss, where the ray started."""

    denominators: tuple[np.ndarray, ...]
    """int64 (rays,): denominators of the points. Exact: |slope| along the axis of the rectangle hit, 0 for a miss.
    Seed: 2^F."""

    bounces: tuple[Bounce, ...]
    """All other values; empty unless they are kept."""


@dataclass(frozen=True)
class Model(ABC):
    """A golden model: the arithmetic of an engine, on whole arrays of rays."""

    features: Collection[str] = field(default=tuple(FEATURES), kw_only=True)
    """Options of `FEATURES` that scenes may need."""

    @abstractmethod
    def meetings(
        self, rectangles: Rectangles, origin: np.ndarray, slope: np.ndarray, *, keep: bool
    ) -> Iterator[Meeting]:
        """Follow rays from mirror to mirror without end; the arrays are (3, rays), and may be changed in place."""

    def trace(
        self,
        rectangles: Rectangles,
        eye: ArrayLike,
        background: Sequence[int],
        slopes: ArrayLike,
        reflections: int,
        *,
        light: Light | None = None,
        keep: bool = False,
    ) -> Trace:
        """Follow rays to their last reflection.

        Args:
            rectangles: the table.
            eye: (3,), or (rays, 3) for one per ray: where the rays start, in world units.
            background: red, green, blue.
            slopes: int (rays, 3); only their ratios count.
            reflections: 0 or more.
            light: light that casts shadows; None lights everything.
            keep: also return every intermediate value: some 100 bytes per ray, rectangle and bounce.
        """
        slope = np.array(np.asarray(slopes).T, dtype=np.int64, order="C")
        origin = np.array(np.broadcast_to(np.asarray(eye), slope.T.shape).T, dtype=np.int64, order="C")
        met, shadings, seen = [], [], []
        for meeting in islice(self.meetings(rectangles, origin, slope, keep=keep), reflections + 1):
            colours = hit_colours(rectangles, background, *meeting[:3])
            if light:
                shading = shade(rectangles, light, *meeting[:4])
                dim(colours, (meeting.winners >= 0) & ~shading.lit, light)
                shadings.append(shading)
            met.append(meeting)
            seen.append(colours)
        winners, points, denominators, _, bounces = zip(*met, strict=True)
        colours = blend(seen, [rectangles.mirrors[winner] for winner in winners])
        return Trace(colours, winners, tuple(seen), tuple(shadings), points, denominators, bounces if keep else ())

    def picture(
        self,
        screen: Screen,
        rectangles: Rectangles,
        eye: Sequence[int] | np.ndarray,
        background: Sequence[int],
        reflections: int,
        *,
        basis: Basis = UNTURNED,
        light: Light | None = None,
    ) -> np.ndarray:
        """Return the picture of a table of rectangles; for the arguments see `trace` and `primary_slopes`.

        Returns:
            uint8 (rows, columns, 3).
        """
        slopes = primary_slopes(screen, basis)
        traced = self.trace(rectangles, eye, background, slopes.reshape(-1, 3), reflections, light=light)
        return traced.colours.reshape(slopes.shape)

    def render(self, scene: Scene, screen: Screen, reflections: int | None = None) -> np.ndarray:
        """Return the picture of a scene.

        Args:
            scene: the scene; its `rows` are ignored.
            screen: the screen that shows it.
            reflections: number of reflections, instead of the scene's own.

        Returns:
            uint8 (rows, columns, 3).

        Raises:
            ValueError: the scene needs an option that is not among `features`.
        """
        if lacking := scene.lacks(self.features):
            raise ValueError(f"a design without {' and '.join(lacking)} does not draw this scene")
        reflections = scene.reflections if reflections is None else reflections
        camera, rectangles = scene.camera, Rectangles.of_scene(scene)
        return self.picture(
            screen, rectangles, camera.position, scene.background, reflections, basis=camera.basis, light=scene.light
        )
