# SPDX-License-Identifier: MIT
"""A picture of where nextpnr has placed the blocks of a design."""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

PLACE = re.compile(r"X(\d+)/?Y(\d+)")
"""Column and row of a tile in the name of a place."""

Block = tuple[str, ...]
"""A block's path, from the top down."""

COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22", "#17becf")
"""A colour for each block; there are no more blocks than these."""

SCALE = 8
"""Pixels of a tile, across and down."""

LEAST = 0.04
"""Least share of all cells that a block of its own has."""


def draw_placement(netlist: Path, picture: Path) -> None:
    """Write a PNG of the chip's tiles, in the colours of their blocks; unused tiles are white. See `tiles_of`."""
    tiles, names = tiles_of(netlist)
    font = ImageFont.load_default(2 * SCALE)
    rows, columns = (SCALE * count for count in tiles.shape)
    sheet = Image.new("RGB", (max(columns, 60 * SCALE), rows + SCALE + 3 * SCALE * len(names)), "white")
    draw = ImageDraw.Draw(sheet)
    for y, x in np.argwhere(tiles >= 0).tolist():
        draw.rectangle((SCALE * x, SCALE * y, SCALE * x + SCALE - 1, SCALE * y + SCALE - 1), COLOURS[tiles[y, x]])
    for number, name in enumerate(names):
        top = rows + SCALE + 3 * SCALE * number
        draw.rectangle((SCALE, top, 3 * SCALE, top + 2 * SCALE), COLOURS[number])
        draw.text((4 * SCALE, top), name, "black", font)
    sheet.save(picture)


def tiles_of(netlist: Path) -> tuple[np.ndarray, list[str]]:
    """Find which block has most of the cells in each tile.

    Args:
        netlist: netlist that nextpnr has written, with the place of each cell.

    Returns:
        The number of each tile's block, or -1 (rows, columns), and the blocks' names.
    """
    cells = max((module["cells"] for module in json.loads(netlist.read_text())["modules"].values()), key=len)
    places: dict[Block, list[tuple[int, int]]] = defaultdict(list)
    for name, cell in cells.items():
        if found := PLACE.match(cell["attributes"].get("NEXTPNR_BEL", "")):
            places[tuple(name.split(".")[:-1])].append((int(found[2]), int(found[1])))
    blocks = choose_blocks({block: len(found) for block, found in places.items()})
    inside: dict[tuple[int, int], Counter[int]] = defaultdict(Counter)
    for block, found in places.items():
        number = max(range(len(blocks)), key=lambda at: len(blocks[at]) * (blocks[at] == block[: len(blocks[at])]))
        for place in found:
            inside[place][number] += 1
    tiles = np.full([max(ends) + 1 for ends in zip(*inside, strict=True)], -1)
    for place, numbers in inside.items():
        tiles[place] = numbers.most_common(1)[0][0]
    return tiles, [".".join(part.removesuffix("_i") for part in block[-2:]) or "all else" for block in blocks]


def choose_blocks(cells: Mapping[Block, int]) -> list[Block]:
    """Choose the blocks to distinguish: the whole design, then the large blocks in each chosen one, as long as all fit.

    Args:
        cells: number of cells in each block, without those of the blocks in it.
    """

    def size(block: Block) -> int:
        return sum(count for one, count in cells.items() if one[: len(block)] == block)

    chosen: list[Block] = [()]
    for block in chosen:
        below = {one[: len(block) + 1] for one in cells if len(one) > len(block) and one[: len(block)] == block}
        large = sorted((one for one in below if size(one) > LEAST * size(())), key=size, reverse=True)
        if len(chosen) + len(large) <= len(COLOURS):
            chosen += large
    return chosen
