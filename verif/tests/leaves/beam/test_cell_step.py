# SPDX-License-Identifier: MIT
"""Leaf tests of `cell_step`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.cell_step import cell_step
from raycaster.rtl.common.records import CellDivision


@pytest.mark.parametrize("place", [8, 5, 3])
def test_cell_step(place, tmp_path, random):
    """One bit of a quotient, and the remainder."""
    bits = 7
    leaf = Leaf(cell_step, lambda: ports(
        "clk", before=CellDivision(bits, place + 1), after=CellDivision(bits, place), place=place
    ), tmp_path)  # fmt: skip
    stimulus = []
    for _ in range(800):
        divisor = int(random.integers(1, 1 << bits))
        edge = int(random.integers(3)) * (divisor << place) + int(random.integers(-1, 2))
        rest = edge if random.random() < 0.5 else int(random.integers(divisor << place + 1))
        fields = {"rest": min(max(rest, 0), (divisor << place + 1) - 1), "divisor": divisor}
        fields |= {"cell": int(random.integers(8)), "odd": int(random.integers(2))}
        stimulus.append({f"before_{name}": value for name, value in fields.items()})
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, output in zip(stimulus, outputs[1:], strict=True):
        rest, divisor, cell, odd = (inputs[f"before_{name}"] for name in ("rest", "divisor", "cell", "odd"))
        fits = rest // (divisor << place)
        expected = rest % (divisor << place), divisor, cell, fits if 8 << cell == 1 << place else odd
        assert tuple(output[f"after_{name}"] for name in ("rest", "divisor", "cell", "odd")) == expected
