# SPDX-License-Identifier: MIT
"""The exact picture: no division and no rounding, at any depth of reflection.

Two ideas replace the divisions. Bounds and depths are compared by cross-multiplication (Kensler and Shirley 2006). And
a ray that was reflected at plane k on axis a is treated as the straight ray from the eye mirrored in that plane,
E'[a] = 2 k - E[a] and D'[a] = -D[a], with the parameter t = n / e continuing (Heckbert and Hanrahan 1984). So no hit
point is ever formed. Anything between the mirrored eye and the mirror is excluded by requiring that t is greater than
at the mirror, or not less if the ray may meet a second plane at the same point, as it does in a corner.

Widths: after r reflections |E| and |n| are at most 511 (r + 1), and |e| and |D| at most the greatest slope: 190 for
primary rays of an unturned camera, below 2^19 for a turned one. Every product is one of these lengths times a slope.
Arrays are int64, so nothing overflows before slopes of 2^50.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from raycaster.golden.model import Bounce, Meeting, Model
from raycaster.golden.world import Rectangles


@dataclass(frozen=True)
class ExactModel(Model):
    """Golden model of every engine that does not divide, and source of the true picture for those that do."""

    def meetings(
        self, rectangles: Rectangles, origin: np.ndarray, slope: np.ndarray, *, keep: bool
    ) -> Iterator[Meeting]:
        """Follow rays from mirror to mirror, each as a straight ray from the mirrored eye."""
        eye = origin
        mirror_t = np.zeros_like(eye[0]), np.ones_like(eye[0])
        met = np.ones(slope.shape, dtype=bool)
        alive = met[0].copy()
        while True:
            bounce = Bounce.empty(len(rectangles), eye, slope, met, alive) if keep else None
            winner, (numerator, denominator) = _nearest(rectangles, eye, slope, mirror_t, met, bounce=bounce)
            points = (eye * denominator + slope * numerator).T
            yield Meeting(winner, points, denominator, slope.T.copy(), bounce)
            alive = (winner >= 0) & (rectangles.mirrors[winner] > 0)
            met &= numerator * mirror_t[1] == mirror_t[0] * denominator
            for axis in range(3):
                mirrored = alive & (rectangles.axes[winner] == axis)
                eye[axis, mirrored] = 2 * rectangles.low[winner[mirrored], axis] - eye[axis, mirrored]
                slope[axis, mirrored] *= -1
                met[axis, mirrored] = True
            # Nothing lies beyond 1 / 0.
            mirror_t = np.where(alive, numerator, 1), np.where(alive, denominator, 0)


def _nearest(
    rectangles: Rectangles,
    eye: np.ndarray,
    slope: np.ndarray,
    mirror_t: tuple[np.ndarray, np.ndarray],
    met: np.ndarray,
    *,
    bounce: Bounce | None,
) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Find the nearest rectangle from the last mirror on, and its t as numerator and denominator.

    Arrays are ([3,] rays).
    """
    mirror_n, mirror_e = mirror_t
    winner = np.full(eye.shape[1], -1, dtype=np.int64)
    # 1 / 0 lies beyond every t.
    best_n, best_e = np.ones_like(winner), np.zeros_like(winner)
    for index in np.flatnonzero(rectangles.visible):
        axis = rectangles.axes[index]
        n, e, within = rectangles.crossed(index, eye, slope)
        # False for n <= 0, as the first "mirror" is at t = 0 / 1 and all its axes are met; and for a ray that has
        # ended, as its last mirror is at 1 / 0.
        along, along_mirror = n * mirror_e, mirror_n * e
        ahead = (e > 0) & ((along > along_mirror) | ((along == along_mirror) & ~met[axis]))
        hit = ahead & within
        # Strict, so the lower index wins a tie.
        nearer = hit & (n * best_e < best_n * e)
        winner[nearer] = index
        np.copyto(best_n, n, where=nearer)
        np.copyto(best_e, e, where=nearer)
        if bounce:
            bounce.note(
                index, numerators=n, denominators=e, scales=e, valid=ahead[:, None], points=(eye * e + slope * n).T,
                depths=np.abs(slope[0]) * n, hits=hit,
            )  # fmt: skip
    return winner, (best_n, best_e)
