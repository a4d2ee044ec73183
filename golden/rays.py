# SPDX-License-Identifier: MIT
"""Primary rays: one per pixel, from the camera through the viewing rectangle."""

from __future__ import annotations

import numpy as np

from raycaster.scene import UNTURNED, Basis
from raycaster.screens import Screen


def primary_slopes(screen: Screen, basis: Basis = UNTURNED) -> np.ndarray:
    """Return the slopes of the ray through every pixel, as specified in the image contract.

    Args:
        screen: grid of rays.
        basis: forward, right and up of the camera, times 256. For an unturned camera the slopes are not times 256, as
            only ratios of their components count.

    Returns:
        int64 (rows, columns, 3): view distance * forward + (column - centre column) * right + (horizon row - row) * up,
        in world units times the screen's scale.
    """
    slopes = np.empty((screen.rows, screen.columns, 3), dtype=np.int64)
    slopes[..., 0] = screen.view_distance
    slopes[..., 1] = np.arange(screen.columns) - screen.centre_column
    slopes[..., 2] = screen.horizon_row - np.arange(screen.rows)[:, None]
    return slopes if basis == UNTURNED else slopes @ np.array(basis, dtype=np.int64)
