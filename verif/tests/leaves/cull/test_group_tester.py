# SPDX-License-Identifier: MIT
"""Leaf tests of `group_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from cull_vectors import designs, hit_mask, scenes, with_edges_on_rays
from fates import margin_of, may_hit_mask
from vectors import ports

from raycaster.configuration import Configuration
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.common.records import Facet, Walk
from raycaster.rtl.common.widths import WIDE_BITS, exact_slope_bits, walk_bits, wide_walk_bits
from raycaster.rtl.cull.group_tester import group_tester


def leaf_of_tester(config: Configuration, directory) -> Leaf:
    slope_bits = exact_slope_bits(config) + 1
    return Leaf(group_tester, lambda: ports(
        "clk", load=unsigned(config.rectangles), facet=Facet(walk_bits(config)), growth=Walk(WIDE_BITS),
        start=Walk(wide_walk_bits(config)), column_slope=signed(slope_bits), row_slope=signed(slope_bits),
        may_hit=unsigned(config.rectangles), config=config
    ), directory)  # fmt: skip


@pytest.mark.slow_sets("seed-vga240-u1-", "seed-vga240-u320")
@designs
def test_group_tester(config, tmp_path, random):
    """Products as `rect_setup` makes them, for groups at the screen's borders and middle, with edges on the rays."""
    slope_bits = exact_slope_bits(config) + 1
    leaf = leaf_of_tester(config, tmp_path)
    slopes = primary_slopes(config.screen_geometry)
    margin, rows = margin_of(config), config.screen_geometry.rows
    stimulus, expected = [], {}
    for (camera, drawn), _ in zip(scenes(random, config), range(3000 // config.rectangles), strict=False):
        row = int(random.choice([0, config.screen_geometry.horizon_row, rows - 1, random.integers(rows)]))
        offset = int(random.integers(config.groups))
        slope = [int(d) for d in slopes[row, offset * config.units]]
        table = with_edges_on_rays(random, config, drawn, camera, [(row, offset)])
        mask = may_hit_mask(config, table, camera, row, offset)
        held = {"column_slope": slope[1] % (1 << slope_bits), "row_slope": slope[2] % (1 << slope_bits)}
        for index in range(len(table)):
            axis = int(table.axes[index])
            p, q = (0, 2) if axis == 1 else (1, 2) if axis == 0 else (1, 0)
            low, high = (bound[index].astype(object) - camera for bound in (table.low - margin, table.high + margin))
            n, e = int(table.low[index, axis] - camera[axis]), slope[axis]
            start = {"way_p": n * slope[p], "low_p": low[p] * e, "high_p": high[p] * e}
            start |= {"low_q": low[q] * e, "high_q": high[q] * e}
            growth = dict.fromkeys(start, 0) | {"way_p": n}
            if axis == 1:
                growth = {"way_p": 0, "low_p": low[p], "high_p": high[p], "low_q": low[q], "high_q": high[q]}
            inputs = {"facet_axis": axis, "facet_distance": n, "facet_way_q": n * slope[q]}
            inputs |= {f"start_{name}": value for name, value in start.items()}
            inputs |= {f"growth_{name}": value for name, value in growth.items()}
            inputs = {name: int(value) % (1 << leaf.given[name].width) for name, value in inputs.items()}
            stimulus.append({**held, **inputs, "load": 1 << index})
        stimulus += [{"load": 0}] * 2
        expected[len(stimulus) - 1] = mask, row, offset, camera, table
    outputs = leaf.run_both(stimulus, settled=min(expected) + 1)
    seen = set()
    for cycle, (mask, row, offset, camera, table) in expected.items():
        case = row, offset, camera.tolist(), table.corners.tolist()
        assert outputs[cycle]["may_hit"] == mask, case
        assert hit_mask(config, table, camera, row, offset) & ~mask == 0, case
        seen |= {mask >> index & 1 for index in range(len(table))}
    assert seen == {0, 1}


@pytest.mark.slow_sets(quick=["exact-vga240-u64", "seed-tiny48"])
@designs
def test_group_tester_at_its_limits(config, tmp_path, random):
    """Any products, with each comparison decided by its last bit, another single bit, or the sign."""
    leaf = leaf_of_tester(config, tmp_path)
    units, far = config.units, 1 << wide_walk_bits(config) - 2
    slope_limit = 1 << exact_slope_bits(config) - 1
    # The first load makes all registers known.
    stimulus, expected = [{"load": (1 << config.rectangles) - 1}], {}

    def small() -> int:
        return int(random.choice([0, 1, 2, 1 << int(random.integers(far.bit_length() - 3))]) * random.choice([-1, 1]))

    for _ in range(6000):
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
        inputs |= {f"start_{name}": value for name, value in start.items()}
        inputs |= {f"growth_{name}": value for name, value in growth.items()}
        inputs = {name: value % (1 << leaf.given[name].width) for name, value in inputs.items()}
        index = len(stimulus) % config.rectangles
        expected[len(stimulus) + 2] = index, not impossible
        stimulus.append({**inputs, "load": 1 << index})
    stimulus += [{"load": 0}] * 2
    outputs = leaf.run_both(stimulus, settled=3)
    for cycle, (index, may_hit) in expected.items():
        assert outputs[cycle]["may_hit"] >> index & 1 == may_hit, stimulus[cycle - 2]
