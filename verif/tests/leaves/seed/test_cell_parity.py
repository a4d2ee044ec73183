# SPDX-License-Identifier: MIT
"""Leaf tests of `cell_parity`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from unit_vectors import unit_config
from vectors import check, leaf_of

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import CELL_BITS, position_bits
from raycaster.rtl.seed.cell_parity import cell_parity


@pytest.mark.parametrize("fraction_bits", [0, 1, 8])
def test_cell_parity(fraction_bits, tmp_path):
    """All coordinates at the borders of cells and next to them."""
    config = unit_config(fraction_bits=fraction_bits, patterns=True)
    leaf = leaf_of(cell_parity, tmp_path, config, value=Signed(position_bits(config) + 2), size=CELL_BITS)
    one = 1 << fraction_bits
    values = {border * one + beside for border in range(0, WORLD_SIZE, 8) for beside in (-1, 0, 1, one // 2, 7 * one)}
    cases = [(value, size) for value in sorted(values) if value >= 0 for size in range(8)]
    expected = [{"odd": value // (one * (8 << size)) % 2} for value, size in cases]
    check(leaf, [{"value": value, "size": size} for value, size in cases], expected)
