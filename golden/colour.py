# SPDX-License-Identifier: MIT
"""Pixel colours from the hits of rays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raycaster.golden.world import OTHER_AXES, Rectangles


def hit_colours(
    rectangles: Rectangles,
    background: Sequence[int],
    winners: np.ndarray,
    points: np.ndarray,
    denominators: np.ndarray | int,
) -> np.ndarray:
    """Return the colours at the hit points of rays, patterns included.

    Args:
        rectangles: the table.
        background: red, green, blue; the colour of a ray that hits nothing.
        winners: int64 (rays,): the rectangle that was hit, -1 for none.
        points: int64 (rays, 3): the hit point, in world units times the denominator.
        denominators: int64 (rays,) or one for all: denominators of the points; don't care for a miss.

    Returns:
        uint8 (rays, 3).
    """
    # Index -1, a miss, finds the background at the end of the table.
    colours = np.vstack([rectangles.colours, np.array(background, dtype=np.uint8)])[winners]
    patterned = np.flatnonzero((winners >= 0) & (rectangles.kinds[winners] > 0))
    hit, point = winners[patterned], points[patterned]
    cell = (np.broadcast_to(denominators, winners.shape)[patterned] * rectangles.cells[hit])[:, None]
    extent = np.array(OTHER_AXES)[rectangles.axes[hit]]
    odd_u, odd_v = (np.take_along_axis(point, extent, axis=1) // cell % 2).astype(bool).T
    other = np.choose(rectangles.kinds[hit] - 1, [odd_u ^ odd_v, odd_v, odd_u])
    colours[patterned[other]] = rectangles.colours_2[hit[other]]
    return colours


def blend(seen: Sequence[np.ndarray], quarters: Sequence[np.ndarray]) -> np.ndarray:
    """Blend the colours that rays see into pixel colours.

    At a mirror, the reflected colour has the weight of the mirror's quarters, and the mirror's own colour that of the
    remaining ones. The last hit shows only its own colour. Nothing is rounded before the end.

    Args:
        seen: for the primary ray and each reflection, uint8 (rays, 3): the colour of what was hit, the background for a
            miss and from then on.
        quarters: for the primary ray and each reflection, int (rays,): reflectivity of the rectangle that was hit,
            0..4; don't care for the last and for a miss.

    Returns:
        uint8 (rays, 3).
    """
    total = seen[-1].astype(np.int64)
    for after, (mirror, colours) in enumerate(zip(quarters[-2::-1], seen[-2::-1], strict=True)):
        weight = np.asarray(mirror)[:, None]
        total = (4 - weight) * colours * 4**after + weight * total
    return (total >> 2 * (len(seen) - 1)).astype(np.uint8)
