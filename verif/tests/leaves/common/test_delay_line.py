# SPDX-License-Identifier: MIT
"""Leaf test of `delay_line`."""

from vectors import by

from raycaster.rtl.common.delay_line import delay_line


@by(cycles=[1, 2, 3, 13])
def test_delay_line(cycles, leaf_of, random):
    leaf = leaf_of(delay_line, word=5, late_word=5, cycles=cycles)
    for word in random.integers(32, size=100):
        leaf.case({"word": word}, {"late_word": word})
    leaf.check(latency=cycles)
