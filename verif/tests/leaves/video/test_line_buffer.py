# SPDX-License-Identifier: MIT
"""Leaf tests of `line_buffer`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import check, leaf_of

from raycaster.configuration import configure
from raycaster.hdl.signals import bits_for
from raycaster.rtl.common.widths import offset_bits, pixel_bits
from raycaster.rtl.video.line_buffer import line_buffer


@pytest.mark.slow_sets("160", "5")
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
@pytest.mark.parametrize("units", [1, 5, 32, 64, 160, 320])
def test_line_buffer(units, colour_bits, tmp_path, random):
    """Writes to one half while the other one is read, often at the same place."""
    config = configure(units=units, colour_bits=colour_bits, rectangles=1, allow_underrun=True)
    groups, width = config.groups, pixel_bits(config)
    widths = {"write_offset": offset_bits(config), "read_offset": bits_for(groups)}
    leaf = leaf_of(line_buffer, tmp_path, config, **widths, pixel_in=width, pixel_out=width)

    def pixel() -> int:
        return int(random.choice([0, 1, (1 << width) - 1, random.integers(1 << width)]))

    filling = [(half, offset) for half in (0, 1) for offset in range(groups)]
    stimulus = [
        {"write": 1, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()} for half, offset in filling
    ]
    for _ in range(600):
        written = int(random.choice([0, groups - 1, random.integers(groups)]))
        # The renderer's counter stops at its maximum and does not write there.
        write, half = int(random.random() < 0.5), int(random.integers(2))
        offset = written if write or random.random() < 0.5 else groups
        stimulus.append({"write": write, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()})
        stimulus[-1]["read_offset"] = int(random.choice([written, random.integers(groups)]))
    halves, expected = [{}, {}], [None]
    for inputs in stimulus:
        shown = halves[1 - inputs["line_buf_sel"]]
        expected.append({"pixel_out": shown.get(inputs.get("read_offset", 0))})
        if inputs["write"]:
            halves[inputs["line_buf_sel"]][inputs["write_offset"]] = inputs["pixel_in"]
    check(leaf, stimulus, expected[:-1], settled=len(filling) + 1)
