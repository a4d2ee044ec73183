# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_rom`."""

import dataclasses
import re

import pytest
from scene_vectors import fixed_config
from vectors import Bench, by

from raycaster.fixed import FixedRectangle, varying_bits
from raycaster.rtl.scene.rect_rom import rect_rom
from raycaster.runs.tools import run_yosys
from raycaster.verif.seeds import repeat

FIELDS = [field.name for field in dataclasses.fields(FixedRectangle)]

LOOKS = {"materials": ("mirror",), "patterns": ("kind", "cell", "colour_2")}
"""Fields of each option."""


@pytest.mark.slow_sets("2-", "7", "8")
@pytest.mark.parametrize("engine", ["seed", "exact"])
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
def test_rect_rom(count, alike, options, engine, leaf_of, random):
    """Each fetched rectangle in the next cycle; the port keeps the last one."""
    config = fixed_config(count, engine, False, alike, **options)
    leaf = leaf_of(rect_rom, config)
    left_out = [name for option, names in LOOKS.items() if option not in options for name in names]
    fields = [name for name in FIELDS if name not in left_out]
    assert set(leaf.seen) == {f"rects_rect_{name}" for name in fields}
    shown = {}
    for _ in range(300):
        index, fetch = int(random.integers(count)), int(random.integers(2))
        leaf.case({"rects_index": index, "rects_fetch": fetch}, shown)
        now = {f"rects_rect_{name}": config.fixed.column(name)[index] for name in fields}
        shown = now if fetch else shown
    leaf.check(settled=8)


@by(engine=["seed", "exact"])
def test_rect_rom_needs_no_registers_for_equal_fields(engine, tmp_path):
    """With all rectangles on one axis, its two bits need no registers; a single rectangle needs none at all."""
    for count, alike in ((12, True), (1, False)):
        config = fixed_config(count, engine, False, alike)
        directory = tmp_path / str(count)
        directory.mkdir()
        Bench(rect_rom, directory, config)
        run_yosys(directory, "alike", ["read_verilog rect_rom.v", "synth -top rect_rom", "tee -o stat.txt stat"])
        kinds = re.findall(r"^ +(\d+) .*_DFF\w*_|\$_DFF\w*_ +(\d+)", (directory / "stat.txt").read_text(), re.M)
        registers = sum(int(number) for pair in kinds for number in pair if number)
        most = sum(varying_bits(config.fixed.column(name)).bit_count() for name in FIELDS)
        assert registers <= most, repeat()
        assert (registers > 0) == (count > 1)
