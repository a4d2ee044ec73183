# SPDX-License-Identifier: MIT
"""From what a ray met to the colour of its pixel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def blend(colours: np.ndarray, background: Sequence[int], winners: Sequence[np.ndarray]) -> np.ndarray:
    """Pixel colours by the image contract: c0, (c0 + c1) >> 1, (2 c0 + c1 + c2) >> 2 for 0, 1, 2 reflections.

    Each rectangle is a 50 % mirror but for the last, which shows its own colour alone; so it goes on for more.

    Args:
        colours: uint8 (rectangles, 3).
        background: red, green, blue; the colour of a ray that hits nothing, and of every ray after it.
        winners: for the primary ray and each reflection, int64 (rays,): the rectangle that was hit, -1 for none.

    Returns:
        uint8 (rays, 3).
    """
    reflections = len(winners) - 1
    # Index -1, a miss, finds the background at the end of the table.
    palette = np.vstack([colours, np.array(background, dtype=np.uint8)]).astype(np.int64)
    total = palette[winners[-1]]
    for depth, winner in enumerate(winners[:-1]):
        total += palette[winner] << (reflections - 1 - depth)
    return (total >> reflections).astype(np.uint8)
