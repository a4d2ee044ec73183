# SPDX-License-Identifier: MIT
"""Leaf tests of `delay_line`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import check, leaf_of

from raycaster.rtl.common.delay_line import delay_line


@pytest.mark.parametrize("cycles", [1, 2, 3, 13])
def test_delay_line(cycles, tmp_path, random):
    leaf = leaf_of(delay_line, tmp_path, word=5, late_word=5, cycles=cycles)
    words = random.integers(32, size=100)
    check(leaf, [{"word": word} for word in words], [{"late_word": word} for word in words], latency=cycles)
