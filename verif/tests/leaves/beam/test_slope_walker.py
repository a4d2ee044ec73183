# SPDX-License-Identifier: MIT
"""Leaf tests of `slope_walker`: MyHDL and converted Verilog match the expected values on the same vectors."""

from beam_vectors import by_screen, direction_ports, row_slopes
from vectors import AXES, ports

from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.widths import exact_slope_bits


@by_screen
def test_slope_walker(config, tmp_path, random):
    slope_bits = exact_slope_bits(config) + 1
    leaf = Leaf(slope_walker, lambda: ports(
        "clk start_line step", aim=Direction(slope_bits), slope=Direction(slope_bits), config=config
    ), tmp_path)  # fmt: skip
    lane, walked = config.screen_geometry.columns // config.pixels, AXES if config.turn else "y"
    stimulus, expected = [], []
    for line in range(100):
        # Short lines, to test many aims.
        columns = lane if line < 3 else 8
        first, more = row_slopes(random, config, columns)
        aim = direction_ports("aim", config, more if config.turn else first)
        aim = {name: value for name, value in aim.items() if name[-1] in walked}
        steps = [int(step % 3 != 2) for step in range(columns)]
        stimulus += [{"start_line": 1, "step": 1, **aim}, *({"start_line": 0, "step": step} for step in steps)]
        # A turned camera's first step goes from 0 to the row's start, which another test covers.
        base = 0 * first if config.turn else first
        expected += [base + more * sum(steps[:column]) for column in range(columns + 1)]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for slope, output in zip(expected, outputs[1:], strict=True):
        given = direction_ports("slope", config, slope)
        assert output == {name: given[name] for name in output} and len(output) == len(walked)
