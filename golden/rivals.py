# SPDX-License-Identifier: MIT
"""Golden model of ray tracers that round as other projects do, with the number format as its parameter.

A ray meets a plane k on axis a at t = (k - O[a]) / D[a], in the point P = O + D t, and every operation rounds to the
format. The nearest hit is the least t, and reflected rays start at P. The other projects normalise slopes first, and
divide by reciprocals or tables; these further errors are left out. Only where a slope exceeds 9 bits, as those of
turned cameras do, it is divided by a power of two here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from raycaster.golden.model import Meeting, Model, Trace
from raycaster.golden.world import OTHER_AXES, Rectangles

POINT_BITS = 30
"""Fraction bits of the points in a trace: numbers of any format are rounded down to them."""

SLOPE_BITS = 9


@dataclass(frozen=True)
class Fixed:
    """Fixed point: int64 arrays in units of 2^-fraction_bits, that wrap around after `bits` bits. Truncates to 0."""

    bits: int
    fraction_bits: int

    def of(self, integers: np.ndarray, shift: np.ndarray | int = 0) -> np.ndarray:
        """Convert integers divided by 2^shift; the shift is at most the number of fraction bits."""
        return self._wrapped(np.asarray(integers, dtype=np.int64) << self.fraction_bits - shift)

    def units(self, numbers: np.ndarray) -> np.ndarray:
        """Return numbers in units of 2^-POINT_BITS, as int64."""
        return numbers << POINT_BITS - self.fraction_bits

    def plus(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Add."""
        return self._wrapped(a + b)

    def times(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Multiply."""
        return self._signed(np.abs(a) * np.abs(b) >> self.fraction_bits, a, b)

    def over(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Divide; 0 is divided by as if it were the smallest positive number."""
        return self._signed((np.abs(a) << self.fraction_bits) // np.maximum(np.abs(b), 1), a, b)

    def bound(self, origin: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Bound the error of origin + slope t, given as floats, if all operands are exact and nothing wraps."""
        return np.broadcast_to((np.abs(slope) + 1) * 2.0**-self.fraction_bits, way.shape)

    def _signed(self, magnitude: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return self._wrapped(np.where((a < 0) == (b < 0), magnitude, -magnitude))

    def _wrapped(self, numbers: np.ndarray) -> np.ndarray:
        half = 1 << self.bits - 1
        return (numbers + half & 2 * half - 1) - half


@dataclass(frozen=True)
class Float:
    """Floating point: float64 arrays of numbers with few digits. There are no subnormal numbers.

    Every operation is exact in float64, or rounded so little that rounding it again gives the right result: for
    significands of up to 25 bits, twice as many and two more suffice (Figueroa 1995).
    """

    digits: int
    """Bits of the significand, with the leading one."""

    exponent_bits: int

    nearest: bool
    """Round to nearest, ties to even, as IEEE 754 does. Otherwise truncate, and lose the digits of an addition's
    lesser operand that lie below the greater one's last digit."""

    def of(self, integers: np.ndarray, shift: np.ndarray | int = 0) -> np.ndarray:
        """Convert integers divided by 2^shift."""
        return self.rounded(np.ldexp(np.asarray(integers, dtype=float), -shift))

    def units(self, numbers: np.ndarray) -> np.ndarray:
        """Return numbers in units of 2^-POINT_BITS, rounded down to int64."""
        return np.floor(np.ldexp(numbers, POINT_BITS)).astype(np.int64)

    def plus(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Add."""
        if not self.nearest:
            last = np.frexp(np.maximum(np.abs(a), np.abs(b)))[1] - self.digits
            a, b = (np.ldexp(np.trunc(np.ldexp(one, -last)), last) for one in (a, b))
        return self.rounded(a + b)

    def times(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Multiply."""
        return self.rounded(a * b)

    def over(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Divide; the result is infinite or not a number if b is 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.rounded(a / b)

    def bound(self, origin: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Bound the error of origin + slope t, given as floats, where way = slope t and all operands are exact.

        Quotient and product are each off by a factor of at most 1 + u. A sum is off by at most 2 u times its greater
        operand: u for lost digits and u for rounding.
        """
        u = 2.0 ** -(self.digits if self.nearest else self.digits - 1)
        off = np.abs(way) * (2 * u + u * u)
        return off + 2 * u * np.maximum(np.abs(origin), np.abs(way) + off)

    def rounded(self, numbers: np.ndarray) -> np.ndarray:
        """Round float64 numbers to the format."""
        lost = 53 - self.digits
        words = np.asarray(numbers, dtype=float).view(np.int64)
        if self.nearest:
            words = words + ((1 << lost - 1) - 1 + (words >> lost & 1))
        found = (words & -1 << lost).view(float)
        least = 2.0 ** (2 - (1 << self.exponent_bits - 1))
        return np.where(np.abs(found) < least, 0, found)


@dataclass(frozen=True)
class RivalModel(Model):
    """Golden model with one number format for everything."""

    numbers: Fixed | Float

    epsilon: float = 0
    """Distance from a ray's origin, in world units, within which the ray hits nothing; 0 in fixed point."""

    def meetings(
        self, rectangles: Rectangles, origin: np.ndarray, slope: np.ndarray, *, keep: bool
    ) -> Iterator[Meeting]:
        """Follow rays from one rounded hit point to the next.

        Raises:
            ValueError: intermediate values are to be kept.
        """
        if keep:
            raise ValueError("this model keeps no intermediate values")
        number = self.numbers
        shift = np.maximum(np.frexp(np.abs(slope).max(axis=0))[1] - SLOPE_BITS, 0)
        start = self.epsilon / np.sqrt((np.ldexp(slope, -shift) ** 2).sum(axis=0))
        origin, slope = number.of(origin), number.of(slope, shift)
        alive = np.ones(slope.shape[1], dtype=bool)
        while True:
            winner, nearest = np.full(slope.shape[1], -1), np.zeros_like(origin[0])
            for index in np.flatnonzero(rectangles.visible):
                t, within = self.crossed(rectangles, index, origin, slope)
                hit = alive & within & (t > start) & ((winner < 0) | (t < nearest))
                winner[hit] = index
                np.copyto(nearest, t, where=hit)
            origin = np.where(winner >= 0, number.plus(origin, number.times(slope, nearest)), origin)
            points = number.units(origin).T
            yield Meeting(winner, points, np.full(len(points), 1 << POINT_BITS), slope.T.copy(), None)
            alive = (winner >= 0) & (rectangles.mirrors[winner] > 0)
            for axis in range(3):
                slope[axis, alive & (rectangles.axes[winner] == axis)] *= -1

    def bound(self, origin: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Bound the error of a primary ray's hit point origin + way, in world units; all arguments are floats."""
        return self.numbers.bound(origin, slope, way)

    def crossed(
        self, rectangles: Rectangles, index: np.intp, origin: np.ndarray, slope: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Find where rays cross a rectangle's plane.

        Args:
            rectangles: the table.
            index: the rectangle, which has a plane.
            origin: numbers (3, rays) or (3, 1).
            slope: numbers (3, rays).

        Returns:
            t, don't care for a parallel ray; bool (rays,): the ray is not parallel, and crosses within the bounds.
        """
        number, axis = self.numbers, rectangles.axes[index]
        low, high = (number.of(bound[index]) for bound in (rectangles.low, rectangles.high))
        t = number.over(number.plus(low[axis], -origin[axis]), slope[axis])
        within = slope[axis] != 0
        for u in OTHER_AXES[axis]:
            with np.errstate(invalid="ignore"):  # 0 times infinity, for a parallel ray
                place = number.plus(origin[u], number.times(slope[u], t))
            within &= (low[u] <= place) & (place <= high[u])
        return t, within

    def lit(
        self, rectangles: Rectangles, camera: Sequence[int], slopes: np.ndarray, light: Sequence[int], exact: Trace
    ) -> np.ndarray:
        """Decide which hit points of primary rays the light reaches.

        The rectangle that a ray hits and the side on which the light is are exact, so that only hit points and shadow
        rays are rounded.

        Args:
            rectangles: the table.
            camera: where the rays start, in world units.
            slopes: int (rays, 3).
            light: position, in world units.
            exact: exact trace of the rays, with the light.

        Returns:
            bool (rays,).
        """
        number, winner = self.numbers, exact.winners[0]
        slope, eye = number.of(slopes.T), number.of(np.array(camera))
        axis, rays = rectangles.axes[winner], np.arange(len(winner))
        with np.errstate(invalid="ignore"):  # rays that hit nothing
            t = number.over(number.plus(number.of(rectangles.low[winner, axis]), -eye[axis]), slope[axis, rays])
            points = number.plus(eye[:, None], number.times(slope, t))
            way = number.plus(number.of(np.array(light))[:, None], -points)
            start = self.epsilon / np.sqrt((way**2).sum(axis=0))
        lit = exact.shadings[0].facing.copy()
        for index in np.flatnonzero(rectangles.visible):
            t, within = self.crossed(rectangles, index, points, way)
            lit &= ~(within & (start < t) & (t < number.of(np.array(1))))
        return lit


SINGLE = Float(24, 8, nearest=True)
"""IEEE single precision."""

RIVALS = {
    "q18.14": RivalModel(Fixed(32, 14)),
    "float20": RivalModel(Float(14, 6, nearest=False)),
    "single": RivalModel(SINGLE),
    "single-epsilon": RivalModel(SINGLE, 1e-3),
}
"""Q18.14 is the format of HomebrewGPU. The float of Racing the Beam has a sign, 6 bits of exponent and 13 stored bits
of significand, and truncates."""
