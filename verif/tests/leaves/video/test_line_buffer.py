# SPDX-License-Identifier: MIT
"""Leaf tests of `line_buffer`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.configuration import configure
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bits_for, unsigned
from raycaster.rtl.common.widths import offset_bits, pixel_bits
from raycaster.rtl.video.line_buffer import line_buffer


@pytest.mark.slow_sets("160", "5")
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
@pytest.mark.parametrize("units", [1, 5, 32, 64, 160, 320])
def test_line_buffer(units, colour_bits, tmp_path, random):
    config = configure(units=units, colour_bits=colour_bits, rectangles=1, allow_underrun=True)
    groups, width = config.groups, pixel_bits(config)
    leaf = Leaf(line_buffer, lambda: ports(
        "clk write line_buf_sel", write_offset=unsigned(offset_bits(config)), pixel_in=unsigned(width),
        read_offset=unsigned(bits_for(groups)), pixel_out=unsigned(width), config=config
    ), tmp_path)  # fmt: skip

    def pixel() -> int:
        return int(random.choice([0, 1, (1 << width) - 1, random.integers(1 << width)]))

    halves = [{}, {}]
    filling = [(half, offset) for half in (0, 1) for offset in range(groups)]
    stimulus = [
        {"write": 1, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()} for half, offset in filling
    ]
    for _ in range(600):
        written = int(random.choice([0, groups - 1, random.integers(groups)]))
        # The renderer's counter stops at its maximum and does not write there.
        write = int(random.random() < 0.5)
        stimulus.append(
            {
                "write": write,
                "line_buf_sel": int(random.integers(2)),
                "write_offset": written if write or random.random() < 0.5 else groups,
                "pixel_in": pixel(),
                "read_offset": int(random.choice([written, random.integers(groups)])),
            }
        )
    outputs = leaf.run_both(stimulus, settled=len(filling) + 1)
    expected = None
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle > len(filling):
            assert output["pixel_out"] == expected, (cycle, inputs)
        shown = halves[1 - inputs["line_buf_sel"]]
        expected = shown.get(inputs.get("read_offset", 0))
        if inputs["write"]:
            halves[inputs["line_buf_sel"]][inputs["write_offset"]] = inputs["pixel_in"]
