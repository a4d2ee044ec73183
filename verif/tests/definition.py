# SPDX-License-Identifier: MIT
"""The image contract of `docs/pixel.md` written out ray by ray with fractions, to test code that computes it otherwise.

It is the only statement of the contract among the tests. `compare` compares a golden model's trace of a ray with it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from raycaster.golden.world import Rectangles
from raycaster.scene import Light

Vector = Sequence[int | Fraction]

Met = frozenset[int] | None
"""Axes of the mirrors that a ray met in its starting point; None for a ray from the camera."""

Hit = tuple[Fraction, list[Fraction]]
"""Way of a ray to a rectangle, and the point where it meets it."""


@dataclass(frozen=True)
class Stop:
    """A segment of a ray, which starts at the camera or at a mirror."""

    met: Met
    """Axes of the mirrors in its starting point."""

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


def within(table: Rectangles, index: int, point: Vector) -> bool:
    """True if a point in a rectangle's plane is on the rectangle."""
    axis, (first, second) = plane_of(table, index), table.corners[index].tolist()
    return all(min(first[u], second[u]) <= point[u] <= max(first[u], second[u]) for u in range(3) if u != axis)


def exact_hit(table: Rectangles, index: int, origin: Vector, slope: Vector, met: Met) -> Hit | None:
    """Return the hit of a ray, or None; the way is in units of the slope, and 0 in a corner."""
    axis = plane_of(table, index)
    if axis is None or slope[axis] == 0:
        return None
    t = Fraction(int(table.corners[index, 0, axis]) - origin[axis]) / slope[axis]
    in_a_corner = t == 0 and met is not None and axis not in met
    point = [origin[i] + slope[i] * t for i in range(3)]
    return (t, point) if (t > 0 or in_a_corner) and within(table, index, point) else None


def quotient(numerator: int | Fraction, denominator: int, fraction_bits: int, rounding: str) -> Fraction | None:
    """Return the seed engine's quotient, a whole number of 2^-F, or None if there is none or it does not fit."""
    if denominator == 0:
        return None
    steps = Fraction(numerator) / denominator * 2**fraction_bits
    rounded = Fraction(floor(steps + Fraction(1, 2) if rounding == "nearest" else steps), 2**fraction_bits)
    return rounded if rounded < 512 else None


def seed_hit(fraction_bits: int, rounding: str) -> Callable[..., Hit | None]:
    """Return the seed engine's counterpart of `exact_hit`; the way is the depth along x."""

    def hit(table: Rectangles, index: int, origin: Vector, slope: Vector, met: Met) -> Hit | None:
        axis = plane_of(table, index)
        n = 0 if axis is None else int(table.corners[index, 0, axis]) - origin[axis]
        if axis is None or n * slope[axis] <= 0:
            return None
        point = list(origin)
        for u in range(3):
            way = quotient(abs(slope[u] * n), abs(slope[axis]), fraction_bits, rounding) if u != axis else abs(n)
            if way is None:
                return None
            point[u] += way if slope[u] > 0 else -way
        return (abs(point[0] - origin[0]), point) if within(table, index, point) else None

    return hit


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
        t = Fraction(int(table.corners[other, 0, across]) - light[across]) / (point[across] - light[across])
        passed = [from_light + (to - from_light) * t for from_light, to in zip(light, point, strict=True)]
        if 0 < t < 1 and within(table, other, passed):
            return False
    return True


def follow(
    table: Rectangles,
    background: Sequence[int],
    camera: Vector,
    slope: Vector,
    reflections: int,
    light: Light | None = None,
    hit: Callable[..., Hit | None] = exact_hit,
) -> list[Stop]:
    """Return all stops of a ray, until its last reflection, a miss, or a rectangle that does not mirror."""
    origin, slope, met, path = [Fraction(c) for c in camera], [Fraction(d) for d in slope], None, []
    for _ in range(reflections + 1):
        hits = [hit(table, index, origin, slope, met) for index in range(len(table))]
        points = [one and one[1] for one in hits]
        nearest = min((one[0] for one in hits if one), default=None)
        if nearest is None:
            return [*path, Stop(met, points, -1, False, tuple(background), 0)]
        winner = next(index for index, one in enumerate(hits) if one and one[0] == nearest)
        point, quarters, colour = points[winner], int(table.mirrors[winner]), colour_at(table, winner, points[winner])
        if light and not is_lit(table, light.position, winner, point, slope):
            colour = tuple(floor(channel * Fraction(light.shade)) for channel in colour)
        path.append(Stop(met, points, winner, point == origin, colour, quarters))
        if quarters == 0:
            return path
        axis = plane_of(table, winner)
        met = frozenset({axis} | (met if point == origin else set()))
        origin = point
        slope[axis] = -slope[axis]
    return path


def pixel(path: Sequence[Stop]) -> list[int]:
    """Return the colour of a ray's pixel."""
    colour = [Fraction(channel) for channel in path[-1].colour]
    for stop in reversed(path[:-1]):
        pairs = zip(stop.colour, colour, strict=True)
        colour = [((4 - stop.quarters) * own + stop.quarters * after) / 4 for own, after in pairs]
    return [floor(channel) for channel in colour]


def compare(trace, ray: int, path: Sequence[Stop]) -> None:
    """Assert that a golden model's trace has a ray's rectangles, colours and, if it was kept, points."""
    winners = [int(winner[ray]) for winner in trace.winners]
    assert winners == [stop.winner for stop in path] + [-1] * (len(winners) - len(path))
    assert trace.colours[ray].tolist() == pixel(path)
    assert [seen[ray].tolist() for seen in trace.seen[: len(path)]] == [list(stop.colour) for stop in path]
    for bounce, stop in zip(trace.bounces, path, strict=False):
        assert bounce.hits[:, ray].tolist() == [point is not None for point in stop.points]
        for index, point in enumerate(stop.points):
            if point:
                scale = int(bounce.scales[index, ray])
                assert [Fraction(int(p), scale) for p in bounce.points[index, ray]] == point, f"rectangle {index}"
