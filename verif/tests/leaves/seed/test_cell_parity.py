# SPDX-License-Identifier: MIT
"""Leaf test of `cell_parity`: all coordinates at the borders of cells and next to them."""

from vectors import by, unit_config

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import CELL_BITS, position_bits
from raycaster.rtl.seed.cell_parity import cell_parity


@by(fraction_bits=[0, 1, 8])
def test_cell_parity(fraction_bits, leaf_of):
    config = unit_config(fraction_bits=fraction_bits, patterns=True)
    leaf = leaf_of(cell_parity, config, value=Signed(position_bits(config) + 2), size=CELL_BITS)
    one = 1 << fraction_bits
    values = {border * one + beside for border in range(0, WORLD_SIZE, 8) for beside in (-1, 0, 1, one // 2, 7 * one)}
    for value in sorted(value for value in values if value >= 0):
        for size in range(8):
            leaf.case({"value": value, "size": size}, {"odd": value // (one * (8 << size)) % 2})
    leaf.check()
