# SPDX-License-Identifier: MIT
"""Combine many frames into one picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PIL import Image

WIDTH = 320
"""Width of each frame in pixels."""

GAP = 8
"""Gap between frames in pixels."""


def write_contact_sheet(frames: Sequence[Path], path: Path, columns: int) -> None:
    """Write frames side by side, each `WIDTH` pixels wide, as a PNG; a shorter frame leaves white below it.

    Args:
        frames: one or more pictures.
        path: the sheet's file.
        columns: frames per row.
    """
    pictures = [Image.open(frame).convert("RGB") for frame in frames]
    reduced = [
        picture.resize((WIDTH, picture.height * WIDTH // picture.width), Image.Resampling.NEAREST)
        for picture in pictures
    ]
    height = max(picture.height for picture in reduced)
    columns = min(columns, len(reduced))
    rows = -(-len(reduced) // columns)
    sheet = Image.new("RGB", (columns * (WIDTH + GAP) - GAP, rows * (height + GAP) - GAP), "white")
    for index, picture in enumerate(reduced):
        sheet.paste(picture, (index % columns * (WIDTH + GAP), index // columns * (height + GAP)))
    sheet.save(path, optimize=True)
