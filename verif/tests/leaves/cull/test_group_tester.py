# SPDX-License-Identifier: MIT
"""`group_tester`: any products, with each comparison decided by its last bit, another single bit, or the sign."""

import numpy as np
import pytest
from cull_vectors import culling_designs
from vectors import named

from raycaster.hdl.signals import Signed
from raycaster.rtl.common.records import Facet, Walk
from raycaster.rtl.common.widths import WIDE_BITS, exact_slope_bits, wide_walk_bits
from raycaster.rtl.cull.group_tester import group_tester


@pytest.mark.slow_sets(quick=["exact-vga240-u64", "seed-tiny48"])
@culling_designs
def test_group_tester_at_its_limits(config, leaf_of, random):
    slopes_of = dict.fromkeys(("column_slope", "row_slope"), Signed(exact_slope_bits(config) + 1))
    ports = {"facet": lambda: Facet(config), "growth": lambda: Walk(WIDE_BITS)}
    ports |= {"start": lambda: Walk(wide_walk_bits(config)), "load": config.rectangles}
    leaf = leaf_of(group_tester, config, **ports, **slopes_of)
    units, far = config.units, 1 << wide_walk_bits(config) - 2
    slope_limit = 1 << exact_slope_bits(config) - 1
    # The first load makes all registers known.
    leaf.case({"load": (1 << config.rectangles) - 1})
    expected = {}

    def small() -> int:
        return int(random.choice([0, 1, 2, 1 << int(random.integers(far.bit_length() - 3))]) * random.choice([-1, 1]))

    for _ in range(leaf.some(6000)):
        axis = int(random.integers(3))
        distance = int(random.choice([0, 1, -1, 1 << int(random.integers(9)), *random.integers(-511, 512, size=4)]))
        turning = [0, -1, -units, 1 - units, -units - 1]
        column_slope, row_slope = (
            int(np.clip(random.choice([*turning, *random.integers(-slope_limit, slope_limit, size=15)]), -far, far))
            for _ in range(2)
        )
        column_slope, row_slope = max(-slope_limit, column_slope), max(-slope_limit, row_slope)
        slopes = {0: (1, 1), 1: (column_slope, column_slope + units), 2: (row_slope, row_slope)}[axis]
        backs = [slope < 0 for slope in slopes]
        if random.random() < 0.9:
            # Put the plane ahead, so that the bounds decide.
            distance = (-1 if backs[0] else 1) * max(1, abs(distance))
        start = {"way_p": int(random.integers(-far // 4, far // 4)), "way_q": int(random.integers(-far // 4, far // 4))}
        growth = {"way_p": int(random.integers(-far // 8, far // 8)) // units % 512 - 256}
        growth["way_p"] = growth["way_p"] if abs(growth["way_p"]) * units < far // 8 else 0
        # All bounds are far away on their side, except the deciding one, which is near at one end or both.
        low, high = ("high", "low") if backs[0] else ("low", "high")
        for p in "pq":
            start |= {f"{low}_{p}": -far // 2, f"{high}_{p}": far // 2}
            growth |= {f"{low}_{p}": 0, f"{high}_{p}": 0}
        side, p = str(random.choice(["low", "high"])), str(random.choice(["p", "q"]))
        more = int(random.choice([0, 0, 1, -1, small() % 64 - 32]))
        apart = small() - int(random.integers(2)) * more * units
        start[f"{side}_{p}"] = start[f"way_{p}"] + apart
        growth[f"{side}_{p}"] = growth.get(f"way_{p}", 0) + more
        end = {name: value + growth.get(name, 0) * units for name, value in start.items()}
        impossible = distance == 0 or all((distance < 0) != back for back in backs)
        if backs[0] == backs[1]:
            for p in "pq":
                impossible |= all(at[f"way_{p}"] < at[f"{low}_{p}"] for at in (start, end))
                impossible |= all(at[f"way_{p}"] > at[f"{high}_{p}"] for at in (start, end))
        inputs = {"facet_axis": axis, "facet_distance": distance, "facet_way_q": start.pop("way_q")}
        inputs |= {"column_slope": column_slope, "row_slope": row_slope}
        inputs |= named("start", start) | named("growth", growth)
        index = leaf.cycle % config.rectangles
        expected[leaf.cycle + 2] = index, not impossible
        leaf.case({**inputs, "load": 1 << index})
    leaf.stimulus += [{"load": 0}] * 2
    outputs = leaf.check(settled=3)
    for cycle, (index, may_hit) in expected.items():
        assert outputs[cycle]["may_hit"] >> index & 1 == may_hit, leaf.stimulus[cycle - 2]
