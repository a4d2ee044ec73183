# SPDX-License-Identifier: MIT
"""Comparing pictures."""

from __future__ import annotations

import numpy as np
import pytest

from raycaster.golden.picture import WRONG, count_wrong, diff_picture, first_wrong, wrong_pixels

REFERENCE = np.array([[(0, 0, 0), (255, 255, 255)], [(200, 100, 0), (9, 9, 9)]], dtype=np.uint8)


def with_pixel(row, column, colour):
    picture = REFERENCE.copy()
    picture[row, column] = colour
    return picture


def test_a_wrong_pixel_counts_once():
    """One channel is enough, and a pixel with three wrong channels is one pixel."""
    assert count_wrong(REFERENCE.copy(), REFERENCE) == 0
    for channel in range(3):
        colour = REFERENCE[1, 0].copy()
        colour[channel] ^= 1
        assert wrong_pixels(with_pixel(1, 0, colour), REFERENCE).tolist() == [[False, False], [True, False]]
    assert count_wrong(with_pixel(0, 0, (255, 255, 255)), REFERENCE) == 1
    assert count_wrong(255 - REFERENCE, REFERENCE) == 4


def test_diff_is_dim_grey_except_for_wrong_pixels():
    diff = diff_picture(with_pixel(1, 1, (9, 9, 8)), REFERENCE)
    assert diff.dtype == np.uint8
    assert diff.tolist() == [[[0, 0, 0], [85, 85, 85]], [[33, 33, 33], list(WRONG)]]


def test_shapes_must_agree():
    with pytest.raises(ValueError, match=r"different shapes: \(1, 2, 3\) and \(2, 2, 3\)"):
        count_wrong(REFERENCE[:1], REFERENCE)


def test_first_wrong():
    """The first wrong pixel in scan order is returned as column and row."""
    picture = np.zeros((4, 6, 3), dtype=np.uint8)
    assert first_wrong(picture, picture) is None
    other = picture.copy()
    other[2, 1, 0] = other[1, 4, 2] = 9
    assert first_wrong(picture, other) == (4, 1)
