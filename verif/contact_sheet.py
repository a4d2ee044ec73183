# SPDX-License-Identifier: MIT
"""`python -m raycaster.verif.contact_sheet`: one picture of all the frames that `make sim` captured."""

from __future__ import annotations

import argparse
from pathlib import Path

from PIL import Image

from raycaster.errors import UserError
from raycaster.options import run_command

COLUMNS = 5
GAP = 8
"""Pixels between pictures."""


def contact_sheet(frames: list[Path], width: int) -> Image.Image:
    """Frames side by side, each `width` pixels wide, in rows of five; a shorter frame leaves white below it."""
    pictures = [Image.open(path).convert("RGB") for path in frames]
    reduced = [
        picture.resize((width, picture.height * width // picture.width), Image.Resampling.NEAREST)
        for picture in pictures
    ]
    height = max(picture.height for picture in reduced)
    columns, rows = min(COLUMNS, len(reduced)), -(-len(reduced) // COLUMNS)
    sheet = Image.new("RGB", (columns * (width + GAP) - GAP, rows * (height + GAP) - GAP), "white")
    for index, picture in enumerate(reduced):
        sheet.paste(picture, (index % COLUMNS * (width + GAP), index // COLUMNS * (height + GAP)))
    return sheet


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.verif.contact_sheet", description=__doc__)
    parser.add_argument("--frames", type=Path, default=Path("build/sim"), help="(default: %(default)s)")
    parser.add_argument("--output", type=Path, default=Path("docs/scenes.png"), help="(default: %(default)s)")
    parser.add_argument("--width", type=int, default=320, help="of each picture (default: %(default)s)")
    arguments = parser.parse_args()
    frames = sorted(arguments.frames.glob("*/frame.png"))
    if not frames:
        raise UserError(f"{arguments.frames}: holds no frames; run make sim first")
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    contact_sheet(frames, arguments.width).save(arguments.output, optimize=True)
    print(f"{len(frames)} frames in {arguments.output}")


if __name__ == "__main__":
    run_command(main)
