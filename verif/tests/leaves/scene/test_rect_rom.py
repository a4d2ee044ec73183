# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_rom`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from scene_vectors import fixed_config

from raycaster.fixed import FixedRectangle, varying_bits
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit
from raycaster.rtl.common.interfaces import Rects
from raycaster.rtl.common.widths import index_bits
from raycaster.rtl.scene.rect_rom import rect_rom
from raycaster.tools import run_yosys
from raycaster.verif.seeds import repeat, seed


@pytest.mark.slow_sets("2-", "7", "8")
@pytest.mark.parametrize(("engine", "latency"), [("seed", 1), ("beam", 2)])
@pytest.mark.parametrize(
    ("count", "alike", "options"),
    [
        *((count, count == 12, {}) for count in (1, 2, 7, 8, 12, 32)),
        (7, False, {"materials": True}),
        (3, False, {"patterns": True}),
        (8, True, {"materials": True, "patterns": True}),
    ],
    ids=["1", "2", "7", "8", "12-alike", "32", "7-materials", "3-patterns", "8-alike-materials-patterns"],
)  # fmt: skip
def test_rect_rom(count, alike, options, engine, latency, tmp_path):
    config = fixed_config(count, engine, False, alike, **options)
    leaf = Leaf(rect_rom, lambda: {"clk": bit(), "rects": Rects(config), "config": config}, tmp_path)
    random = np.random.default_rng(seed())
    stimulus = [
        {"rects_index": int(random.integers(count)), "rects_fetch": int(random.integers(2))} for _ in range(300)
    ]
    outputs = leaf.run_both(stimulus, settled=8)
    looks = {"materials": ("mirror",), "patterns": ("kind", "cell", "colour_2")}
    left_out = [name for option, names in looks.items() if option not in options for name in names]
    fields = [field.name for field in dataclasses.fields(FixedRectangle) if field.name not in left_out]
    assert set(outputs[-1]) == {f"rects_rect_{name}" for name in fields}
    held, late = None, None
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        shown = held if latency == 1 else late
        if cycle >= 8 and shown is not None:
            for name in fields:
                assert output[f"rects_rect_{name}"] == config.fixed.column(name)[shown], (cycle, name, repeat())
        late = held
        if inputs["rects_fetch"]:
            held = inputs["rects_index"]
    assert held is not None


@pytest.mark.parametrize("engine", ["seed", "beam"])
def test_rect_rom_needs_no_registers_for_equal_fields(engine, tmp_path):
    """With all rectangles on one axis, its two bits need no registers; a single rectangle needs none at all."""
    for count, alike in ((12, True), (1, False)):
        config = fixed_config(count, engine, False, alike)
        directory = tmp_path / str(count)
        directory.mkdir()
        Leaf(rect_rom, lambda config=config: {"clk": bit(), "rects": Rects(config), "config": config}, directory)
        run_yosys(directory, "alike", ["read_verilog rect_rom.v", "synth -top rect_rom", "tee -o stat.txt stat"])
        kinds = re.findall(r"^ +(\d+) .*_DFF\w*_|\$_DFF\w*_ +(\d+)", (directory / "stat.txt").read_text(), re.M)
        registers = sum(int(number) for pair in kinds for number in pair if number)
        columns = [config.fixed.column(field.name) for field in dataclasses.fields(FixedRectangle)]
        most = sum(varying_bits(column).bit_count() for column in columns)
        held = index_bits(config) if engine == "beam" and count > 1 else 0
        assert registers <= most + held, repeat()
        assert (registers > 0) == (count > 1)
