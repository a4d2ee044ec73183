# SPDX-License-Identifier: MIT
"""A picture of where nextpnr has placed the blocks of a design."""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

PLACE = re.compile(r"X(\d+)/?Y(\d+)")
"""Column and row of a tile in the name of a place."""

Block = tuple[str, ...]
"""A block's path, from the top down."""

BLOCKS = 10
"""Most blocks that have a colour of their own."""

LEAST = 0.04
"""Least share of all cells that a block of its own has."""


def draw_placement(netlist: Path, picture: Path) -> None:
    """Write a PNG of the chip's tiles, in the colours of their blocks; unused tiles are white. See `tiles_of`."""
    tiles, names = tiles_of(netlist)
    colours = np.array([mpl.colormaps["tab10"](number)[:3] for number in range(BLOCKS)] + [(1, 1, 1)])
    figure = Figure(figsize=(7, 7 * tiles.shape[0] / tiles.shape[1] + 1), layout="constrained")
    axes = figure.subplots()
    axes.imshow(colours[tiles], interpolation="nearest")
    axes.set_axis_off()
    for name, colour in zip(names, colours, strict=False):
        axes.plot([], [], "s", color=colour, label=name)
    figure.legend(loc="outside lower center", ncols=3, fontsize=8)
    figure.savefig(picture, dpi=150)


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
        if len(chosen) + len(large) <= BLOCKS:
            chosen += large
    return chosen
