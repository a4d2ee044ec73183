# SPDX-License-Identifier: MIT
"""Primary rays: one a pixel, from the camera through the viewing rectangle."""

from __future__ import annotations

import numpy as np

from raycaster.screens import Screen


def primary_slopes(screen: Screen) -> np.ndarray:
    """Slopes of the ray through every pixel, as the image contract has them.

    Returns:
        int64 (rows, columns, 3): (view distance, column - centre column, horizon row - row), in world units
        times the screen's scale.
    """
    slopes = np.empty((screen.rows, screen.columns, 3), dtype=np.int64)
    slopes[..., 0] = screen.view_distance
    slopes[..., 1] = np.arange(screen.columns) - screen.centre_column
    slopes[..., 2] = screen.horizon_row - np.arange(screen.rows)[:, None]
    return slopes
