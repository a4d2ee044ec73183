# SPDX-License-Identifier: MIT
"""Leaf test of `cell_step`: one bit of a quotient, and the remainder."""

from vectors import by, named

from raycaster.rtl.beam.cell_step import cell_step
from raycaster.rtl.common.records import CellDivision


@by(power=[8, 5, 3])
def test_cell_step(power, leaf_of, random):
    bits = 7
    divisions = {"before": lambda: CellDivision(bits, power + 1), "after": lambda: CellDivision(bits, power)}
    leaf = leaf_of(cell_step, **divisions, power=power)
    for _ in range(800):
        divisor = int(random.integers(1, 1 << bits))
        edge = int(random.integers(3)) * (divisor << power) + int(random.integers(-1, 2))
        rest = edge if random.random() < 0.5 else int(random.integers(divisor << power + 1))
        rest = min(max(rest, 0), (divisor << power + 1) - 1)
        before = {"rest": rest, "divisor": divisor, "cell": random.integers(8), "odd": random.integers(2)}
        leaf.case(named("before", before))
        fits, left = divmod(rest, divisor << power)
        odd = {"odd": fits} if 8 << before["cell"] == 1 << power else {}
        leaf.expect(named("after", before | {"rest": left} | odd))
    leaf.check(latency=1)
