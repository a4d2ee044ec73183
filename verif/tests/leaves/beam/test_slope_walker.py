# SPDX-License-Identifier: MIT
"""`slope_walker`: the slope of each column, from the row's aim on; only y is walked by a camera that does not turn."""

from beam_vectors import by_screen, row_slopes
from vectors import by_axis

from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.widths import exact_slope_bits


@by_screen
def test_slope_walker(config, leaf_of, random):
    leaf = leaf_of(slope_walker, config, slope=lambda: Vector(exact_slope_bits(config) + 1))
    lane = config.screen_geometry.columns // config.pixels
    for line in range(100):
        # Short lines, to test many aims.
        columns = lane if line < 3 else 8
        first, more = row_slopes(random, config, columns)
        aim = by_axis("aim_", more if config.turn else first)
        steps = [int(step % 3 != 2) for step in range(columns)]
        leaf.stimulus += [{"start_line": 1, "step": 1, **aim}, *({"start_line": 0, "step": step} for step in steps)]
        # A turned camera's first step goes from 0 to the row's start, which another test covers.
        base = 0 * first if config.turn else first
        for column in range(columns + 1):
            slope = by_axis("slope_", base + more * sum(steps[:column]))
            leaf.expected[leaf.cycle - columns - 1 + column] = {name: slope[name] for name in leaf.seen}
    assert list(leaf.seen) == [f"slope_{axis}" for axis in ("xyz" if config.turn else "y")]
    leaf.check(latency=1, spare=True)
