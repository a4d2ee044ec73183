# SPDX-License-Identifier: MIT
"""Comparison of two pictures."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from raycaster.configuration import CHANNEL_BITS, Configuration

WRONG = (255, 20, 120)
"""Pink, far from any dimmed grey."""


def shown(picture: np.ndarray, config: Configuration) -> np.ndarray:
    """Return what a monitor must show for a picture.

    Args:
        picture: uint8 (rows, columns, 3).
        config: the design that draws it.

    Returns:
        uint8 (visible lines, visible pixels, 3): pixels repeated as on the screen, with a channel's lost bits 0.
    """
    doubling = config.screen_geometry.doubling
    lost_bits = CHANNEL_BITS - config.colour_bits
    return picture.repeat(doubling, axis=0).repeat(doubling, axis=1) >> lost_bits << lost_bits


def wrong_pixels(picture: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Find the pixels that differ in any channel.

    Args:
        picture: uint8 (rows, columns, 3).
        reference: what the picture should be, in the same shape.

    Returns:
        bool (rows, columns).

    Raises:
        ValueError: the shapes differ.
    """
    if picture.shape != reference.shape:
        raise ValueError(f"pictures of different shapes: {picture.shape} and {reference.shape}")
    return (picture != reference).any(axis=-1)


def count_wrong(picture: np.ndarray, reference: np.ndarray) -> int:
    """Count the pixels that differ; see `wrong_pixels`."""
    return int(wrong_pixels(picture, reference).sum())


def colour_text(channels: Iterable[int]) -> str:
    """Write a colour, 8 bits per channel, as in scene files: #rrggbb."""
    return f"#{bytes(int(channel) for channel in channels).hex()}"


def describe_difference(picture: np.ndarray, reference: np.ndarray) -> str:
    """Say how many pixels differ, and which is the first one; empty if none does. See `wrong_pixels`."""
    place = first_wrong(picture, reference)
    if place is None:
        return ""
    column, row = place
    seen, expected = (colour_text(one[row, column]) for one in (picture, reference))
    return (
        f"{count_wrong(picture, reference):,} of {reference[..., 0].size:,} pixels are wrong; the first, at column "
        f"{column} of line {row}, is {seen}, expected {expected}"
    )


def first_wrong(picture: np.ndarray, reference: np.ndarray) -> tuple[int, int] | None:
    """Return column and row of the first pixel that differs, in the order in which a monitor shows them, or None."""
    places = np.argwhere(wrong_pixels(picture, reference))
    return (int(places[0][1]), int(places[0][0])) if len(places) else None


def diff_picture(picture: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Return the reference in dim grey with every wrong pixel in bright pink, for people to look at.

    Returns:
        uint8 (rows, columns, 3).
    """
    wrong = wrong_pixels(picture, reference)
    # A third of the mean of the channels: dark enough to show a single wrong pixel, light enough to find the place.
    grey = (reference.sum(axis=-1, dtype=np.int64) // 9).astype(np.uint8)
    return np.where(wrong[..., None], np.array(WRONG, dtype=np.uint8), grey[..., None])
