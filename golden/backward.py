# SPDX-License-Identifier: MIT
"""Backward errors: how far a ray's slope must be moved, in pixels, until what was drawn is right.

What a ray meets, mirror by mirror, is right for a set of slopes. A ray is straight as seen from the mirrored eye, so
this set is a union of convex cones, with integer planes: each bound of a rectangle, and each comparison of two depths,
is linear in the slope (Heckbert and Hanrahan 1984). The cones are clipped exactly, in integers; only the distance of a
pixel from the polygon that a cone cuts out of the screen is computed in floating point.

The backward error of a ray is the least distance of its pixel from the set, 0 if the ray is right or on the set's
border. Parts of the set that have less area than the rectangle as a whole, such as one edge of it, are left out, so the
distance is exact or too great, never too small.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from raycaster.golden.world import OTHER_AXES, Rectangles

MARGIN = 1 << 14
"""Pixels around the corner of the screen within which slopes are searched; the backward error beyond is infinite."""

Plane = list[int]
"""Half space of the slopes D whose scalar product with this is 0 or more."""

Cone = list[list[int]]
"""Convex cone by its edges, integer slopes in order."""


def _clipped(cone: Cone, plane: Plane) -> Cone:
    """Return the part of a cone in a closed half space."""
    sides = [sum(p * q for p, q in zip(edge, plane, strict=True)) for edge in cone]
    found: Cone = []
    for place, (edge, side) in enumerate(zip(cone, sides, strict=True)):
        before, side_before = cone[place - 1], sides[place - 1]
        if side * side_before < 0:
            between = [abs(side) * p + abs(side_before) * q for p, q in zip(before, edge, strict=True)]
            divisor = math.gcd(*between)
            found.append([part // divisor for part in between])
        if side >= 0:
            found.append(edge)
    return [edge for place, edge in enumerate(found) if len(found) == 1 or edge != found[place - 1]]


def _within(cone: Cone, planes: Sequence[Plane]) -> Cone:
    for plane in planes:
        cone = _clipped(cone, plane) if cone else cone
    return cone


def _outside(cones: Sequence[Cone], planes: Sequence[Plane]) -> list[Cone]:
    """Return convex cones that make up the part of the cones outside the intersection of half spaces."""
    found = []
    for cone in cones:
        size = min(len(cone), 3)
        if min(len(_within(cone, planes)), 3) < size:
            found.append(cone)
            continue
        rest = cone
        for plane in filter(any, planes):
            beyond = _clipped(rest, [-part for part in plane])
            found += [beyond] if min(len(beyond), 3) == size else []
            rest = _clipped(rest, plane)
    return found


@dataclass(frozen=True)
class _View:
    """A ray after mirrors, as a straight ray from the mirrored eye whose slope has these signs."""

    rectangles: Rectangles
    eye: Sequence[int]
    signs: Sequence[int]
    mirror: int | None

    def mirrored(self, mirror: int) -> _View:
        """Return the view after one more mirror."""
        axis = self.rectangles.axes[mirror]
        eye, signs = list(self.eye), list(self.signs)
        eye[axis] = 2 * int(self.rectangles.low[mirror, axis]) - eye[axis]
        signs[axis] *= -1
        return _View(self.rectangles, eye, signs, mirror)

    def depth(self, index: int) -> tuple[int, list[int]]:
        """Return n and e, both 0 or more ahead: a rectangle's plane is met at t = n / e; e is linear in the slope."""
        axis = int(self.rectangles.axes[index])
        n = int(self.rectangles.low[index, axis]) - self.eye[axis]
        e = [0, 0, 0]
        e[axis] = self.signs[axis] * (n > 0) - self.signs[axis] * (n < 0)
        return abs(n), e

    def met(self, index: int) -> list[Plane] | None:
        """Return the half spaces of slopes that meet a rectangle beyond the last mirror; None if none does."""
        n, e = self.depth(index)
        planes = [e]
        for u in OTHER_AXES[self.rectangles.axes[index]]:
            for sign, bound in ((1, self.rectangles.low[index, u]), (-1, self.rectangles.high[index, u])):
                plane = [sign * (self.eye[u] - int(bound)) * part for part in e]
                plane[u] += sign * self.signs[u] * n
                planes.append(plane)
        if self.mirror is not None:
            planes.append(self.nearer(self.mirror, index))
        return planes if any(e) and any(planes[-1]) else None

    def nearer(self, one: int, other: int) -> Plane:
        """Return the half space in which one plane is met first; all 0 if both are always met at once."""
        (n, e), (far, slope) = self.depth(one), self.depth(other)
        return [far * p - n * q for p, q in zip(e, slope, strict=True)]

    def hiding(self, index: int, winner: int) -> list[Plane]:
        """Return the half spaces in which a rectangle hides the winner, or is met at all if that is -1; or nothing."""
        planes = self.met(index) or []
        if planes and winner >= 0:
            planes.append(self.nearer(index, winner))
            if index > winner and not any(planes[-1]):
                return []
        return planes


@dataclass(frozen=True, eq=False)
class Outcomes:
    """Sets of slopes by what their rays meet.

    Attributes:
        rectangles: the table.
        camera: where the rays start, in world units.
        slopes: int (rows, columns, 3), linear in row and column, at least two of each: slopes of the primary rays.
    """

    rectangles: Rectangles
    camera: Sequence[int]
    slopes: np.ndarray
    _known: dict[tuple[int, ...], list[Cone]] = field(default_factory=dict)

    @property
    def _screen(self) -> np.ndarray:
        """Slopes per column and per row, and the first pixel's slope: the columns of a matrix of Python's integers."""
        first = self.slopes[0, 0]
        return np.array([self.slopes[0, 1] - first, self.slopes[1, 0] - first, first], dtype=object).T

    def cones(self, met: tuple[int, ...]) -> list[Cone]:
        """Return the slopes whose rays meet these rectangles, mirror by mirror; -1 for none and after the end."""
        if met not in self._known:
            self._known[met] = self._found(met)
        return self._known[met]

    def _found(self, met: tuple[int, ...]) -> list[Cone]:
        if not met:
            around = [(-MARGIN, -MARGIN, 1), (MARGIN, -MARGIN, 1), (MARGIN, MARGIN, 1), (-MARGIN, MARGIN, 1)]
            return [[list(self._screen @ corner) for corner in np.array(around, dtype=object)]]
        *before, winner = met
        cones = self.cones(tuple(before))
        if before and (before[-1] < 0 or not self.rectangles.mirrors[before[-1]]):
            return cones if winner < 0 else []
        view = _View(self.rectangles, [int(place) for place in self.camera], (1, 1, 1), None)
        for mirror in before:
            view = view.mirrored(mirror)
        if winner >= 0:
            planes = view.met(winner)
            cones = [part for cone in cones if planes and (part := _within(cone, planes))]
        for index in np.flatnonzero(self.rectangles.visible).tolist():
            if index != winner and cones and (planes := view.hiding(index, winner)):
                cones = _outside(cones, planes)
        return cones

    def distances(self, met: tuple[int, ...], pixels: np.ndarray) -> np.ndarray:
        """Return the distances of pixels, (pixels, 2), outside the set of `cones` from it; infinite if it is empty.

        A pixel is given by column and row.
        """
        least = np.full(len(pixels), np.inf)
        adjugate = _adjugate(self._screen)
        for cone in self.cones(met):
            corners = [adjugate @ np.array(edge, dtype=object) for edge in cone]
            polygon = np.array([[column / scale, row / scale] for column, row, scale in corners])
            np.minimum(least, _distances(polygon, pixels), out=least)
        return least


def backward_errors(
    rectangles: Rectangles,
    camera: Sequence[int],
    slopes: np.ndarray,
    drawn: Sequence[np.ndarray],
    right: Sequence[np.ndarray],
) -> np.ndarray:
    """Return the backward errors of a picture's rays.

    Args:
        rectangles: the table.
        camera: where the rays start, in world units.
        slopes: int (rows, columns, 3): slopes of the primary rays.
        drawn: for each depth of reflection, int64 (rays,): the rectangles that the rays met, -1 for none.
        right: those that exact rays meet.

    Returns:
        float (rays,): in pixels; infinite if no slope within `MARGIN` pixels has what was drawn.
    """
    outcomes = Outcomes(rectangles, camera, slopes)
    every, errors = np.array(drawn), np.zeros(slopes.shape[0] * slopes.shape[1])
    wrong = np.flatnonzero((every != np.array(right)).any(axis=0))
    pixels = np.stack([wrong % slopes.shape[1], wrong // slopes.shape[1]], axis=1)
    met, which = np.unique(every[:, wrong], axis=1, return_inverse=True)
    for place, one in enumerate(met.T.tolist()):
        errors[wrong[which == place]] = outcomes.distances(tuple(one), pixels[which == place])
    return errors


def _adjugate(matrix: np.ndarray) -> np.ndarray:
    """Return a 3 x 3 matrix of integers whose product with this one is a positive multiple of the identity."""
    a, b, c = matrix.T
    rows = np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    return rows if rows[0] @ a > 0 else -rows


def _distances(polygon: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Return the distances of points, (points, 2), from a polygon's outline by its corners, (corners, 2), in order.

    A pixel that is drawn wrong is not inside.
    """
    side = np.roll(polygon, -1, axis=0) - polygon
    off = pixels[:, None] - polygon
    length = (side**2).sum(axis=1)
    along = np.clip((off * side).sum(axis=2) / np.where(length, length, 1), 0, 1)
    return np.sqrt(((off - along[..., None] * side) ** 2).sum(axis=2).min(axis=1))
