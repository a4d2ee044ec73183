# SPDX-License-Identifier: MIT
"""Leaf tests of `delay_line`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.delay_line import delay_line


@pytest.mark.parametrize("cycles", [1, 2, 3, 13])
def test_delay_line(cycles, tmp_path, random):
    leaf = Leaf(delay_line, lambda: ports("clk", word=unsigned(5), late_word=unsigned(5), cycles=cycles), tmp_path)
    stimulus = [{"word": int(random.integers(32))} for _ in range(100)]
    outputs = leaf.run_both(stimulus, settled=cycles)
    for inputs, output in zip(stimulus, outputs[cycles:], strict=False):
        assert output == {"late_word": inputs["word"]}
