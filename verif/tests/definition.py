# SPDX-License-Identifier: MIT
"""The image contract written out ray by ray with fractions, to test code that computes it in other ways."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from raycaster.golden.world import Rectangles
from raycaster.scene import Light

Vector = Sequence[int | Fraction]


@dataclass(frozen=True)
class Stop:
    """A segment of a ray, which starts at the camera or at a mirror."""

    met: frozenset[int] | None
    """Axes of the mirrors that the ray met in its starting point; None for a ray from the camera."""

    points: list[list[Fraction] | None]
    """Point where the ray meets each rectangle, or None."""

    winner: int
    """Index of the nearest rectangle, -1 for none."""

    corner: bool
    """True if the nearest rectangle is met in the starting point."""

    colour: tuple[int, ...]
    """Colour that is seen there, lit or in shadow."""

    quarters: int
    """Quarters that are mirrored; 0 if nothing is hit."""


def plane_of(table: Rectangles, index: int) -> int | None:
    """Return the axis of an enabled rectangle's plane, or None."""
    first, second = table.corners[index].tolist()
    return next((axis for axis in range(3) if first[axis] == second[axis] and table.enabled[index]), None)


def distance(table: Rectangles, index: int, origin: Vector, slope: Vector, met: frozenset[int] | None):
    """Return how far along the slope a ray meets a rectangle, None if it does not; 0 in a corner."""
    axis = plane_of(table, index)
    if axis is None or slope[axis] == 0:
        return None
    first, second = table.corners[index].tolist()
    t = Fraction(first[axis] - origin[axis]) / slope[axis]
    in_a_corner = t == 0 and met is not None and axis not in met
    point = [origin[i] + slope[i] * t for i in range(3)]
    within = all(min(first[i], second[i]) <= point[i] <= max(first[i], second[i]) for i in range(3) if i != axis)
    return t if within and (t > 0 or in_a_corner) else None


def colour_at(table: Rectangles, index: int, point: Vector) -> tuple[int, ...]:
    """Return the colour of a rectangle at a point."""
    u, v = (axis for axis in range(3) if axis != plane_of(table, index))
    number_u, number_v = (floor(point[axis] / Fraction(int(table.cells[index]))) for axis in (u, v))
    odd = {0: 0, 1: number_u + number_v, 2: number_v, 3: number_u}[int(table.kinds[index])] % 2
    return tuple((table.colours_2 if odd else table.colours)[index].tolist())


def is_lit(table: Rectangles, light: Vector, index: int, point: Vector, slope: Vector) -> bool:
    """True if the light reaches the point where a ray of this slope hit a rectangle."""
    axis = plane_of(table, index)
    if not (light[axis] - point[axis]) * -slope[axis] > 0:
        return False
    for other in range(len(table)):
        across = plane_of(table, other)
        if across is None or point[across] == light[across]:
            continue
        first, second = table.corners[other].tolist()
        t = Fraction(first[across] - light[across]) / (point[across] - light[across])
        passed = [from_light + (to - from_light) * t for from_light, to in zip(light, point, strict=True)]
        sides = zip(first, passed, second, strict=True)
        if 0 < t < 1 and all(min(a, b) <= at <= max(a, b) for i, (a, at, b) in enumerate(sides) if i != across):
            return False
    return True


def follow(
    table: Rectangles,
    background: Sequence[int],
    camera: Vector,
    slope: Vector,
    reflections: int,
    light: Light | None = None,
) -> list[Stop]:
    """Return all stops of a ray, until its last reflection, a miss, or a rectangle that does not mirror."""
    origin, slope, met, path = [Fraction(c) for c in camera], [Fraction(d) for d in slope], None, []
    for _ in range(reflections + 1):
        distances = [distance(table, index, origin, slope, met) for index in range(len(table))]
        points = [None if t is None else [o + d * t for o, d in zip(origin, slope, strict=True)] for t in distances]
        nearest = min((t for t in distances if t is not None), default=None)
        if nearest is None:
            return [*path, Stop(met, points, -1, False, tuple(background), 0)]
        winner = distances.index(nearest)
        quarters = int(table.mirrors[winner])
        colour = colour_at(table, winner, points[winner])
        if light and not is_lit(table, light.position, winner, points[winner], slope):
            colour = tuple(floor(channel * Fraction(light.shade)) for channel in colour)
        path.append(Stop(met, points, winner, nearest == 0, colour, quarters))
        if quarters == 0:
            return path
        axis = plane_of(table, winner)
        met = frozenset({axis} | (met if nearest == 0 else set()))
        origin = points[winner]
        slope[axis] = -slope[axis]
    return path


def pixel(path: Sequence[Stop]) -> list[int]:
    """Return the colour of a ray's pixel."""
    colour = [Fraction(channel) for channel in path[-1].colour]
    for stop in reversed(path[:-1]):
        pairs = zip(stop.colour, colour, strict=True)
        colour = [((4 - stop.quarters) * own + stop.quarters * after) / 4 for own, after in pairs]
    return [floor(channel) for channel in colour]
