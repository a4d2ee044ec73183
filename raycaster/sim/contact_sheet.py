# SPDX-License-Identifier: MIT
"""Combine many frames into one picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from raycaster.output import printable

WIDTH = 320
"""Width of each frame in pixels."""

GAP = 8
"""Gap between frames in pixels."""

CAPTION = 20
"""Height of a frame's name in pixels."""


def write_contact_sheet(frames: Sequence[Path], path: Path, columns: int, names: Sequence[str] = ()) -> None:
    """Write frames side by side, each `WIDTH` pixels wide, as a PNG; a shorter frame leaves white below its name.

    Args:
        frames: one or more pictures.
        path: the sheet's file.
        columns: frames per row.
        names: names to write below the frames, if any.
    """
    caption = CAPTION if names else 0
    pictures = [Image.open(frame).convert("RGB") for frame in frames]
    reduced = [
        picture.resize((WIDTH, picture.height * WIDTH // picture.width), Image.Resampling.NEAREST)
        for picture in pictures
    ]
    height = max(picture.height for picture in reduced) + caption
    columns = min(columns, len(reduced))
    rows = -(-len(reduced) // columns)
    sheet = Image.new("RGB", (columns * (WIDTH + GAP) - GAP, rows * (height + GAP) - GAP), "white")
    draw = ImageDraw.Draw(sheet)
    for index, picture in enumerate(reduced):
        left, top = index % columns * (WIDTH + GAP), index // columns * (height + GAP)
        sheet.paste(picture, (left, top))
        if names:
            text = printable(names[index]).encode("latin-1", "backslashreplace").decode("latin-1")
            draw.text((left, top + picture.height + 2), text, "black", ImageFont.load_default(14))
    sheet.save(path, optimize=True)
