# SPDX-License-Identifier: MIT
"""Leaf test of `line_buffer`: writes to one half while the other one is read, often at the same place."""

from itertools import product

import pytest
from vectors import by

from raycaster.design.decide import configure
from raycaster.hdl.signals import bits_for
from raycaster.rtl.common.widths import offset_bits, pixel_bits
from raycaster.rtl.video.line_buffer import line_buffer


@pytest.mark.slow_sets("160", "5")
@by(units=[1, 5, 32, 64, 160, 320], colour_bits=[1, 4, 8])
def test_line_buffer(units, colour_bits, leaf_of, random):
    config = configure(units=units, colour_bits=colour_bits, rectangles=1, allow_underrun=True)
    groups, width = config.groups, pixel_bits(config)
    widths = {"write_offset": offset_bits(config), "read_offset": bits_for(groups)}
    leaf = leaf_of(line_buffer, config, **widths, pixel_in=width, pixel_out=width)

    def pixel() -> int:
        return int(random.choice([0, 1, (1 << width) - 1, random.integers(1 << width)]))

    for half, offset in product((0, 1), range(groups)):
        leaf.case({"write": 1, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()})
    for _ in range(600):
        written = int(random.choice([0, groups - 1, random.integers(groups)]))
        # The renderer's counter stops at its maximum and does not write there.
        write, half = int(random.random() < 0.5), int(random.integers(2))
        offset = written if write or random.random() < 0.5 else groups
        leaf.case({"write": write, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()})
        leaf.stimulus[-1]["read_offset"] = int(random.choice([written, random.integers(groups)]))
    halves = [{}, {}]
    for cycle, inputs in enumerate(leaf.stimulus[:-1]):
        shown = halves[1 - inputs["line_buf_sel"]]
        leaf.expected[cycle + 1]["pixel_out"] = shown.get(inputs.get("read_offset", 0))
        if inputs["write"]:
            halves[inputs["line_buf_sel"]][inputs["write_offset"]] = inputs["pixel_in"]
    leaf.check(settled=2 * groups + 1)
