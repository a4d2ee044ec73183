# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_sorter`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from scene_vectors import label, rectangle_words, sized
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.registers import register_map
from raycaster.rtl.common.records import rect_of
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.written_rect import written_of
from raycaster.sim.register_model import Table
from raycaster.verif.expected import sorted_rect

LOOKS = [
    {"engine": "exact"}, {"engine": "exact", "materials": True}, {"engine": "beam", "patterns": True},
    {"engine": "exact", "materials": True, "patterns": True},
]  # fmt: skip

looks = pytest.mark.parametrize("options", LOOKS, ids=label)


@looks
def test_rect_sorter(options, tmp_path, random):
    config = sized(1, **options)
    leaf = Leaf(rect_sorter, lambda: ports(
        "", written=written_of(config), rect=rect_of(config), config=config
    ), tmp_path)  # fmt: skip
    stimulus, expected = [], []
    for _ in range(150):
        table, words = rectangle_words(random)
        for index, written in enumerate(words):
            if table.axes[index] >= 0:
                names = Table(config).names
                stimulus.append({f"written_{name}": word for name, word in zip(names, written, strict=False)})
                expected.append(sorted_rect(table, index, "rect", config))
                if config.patterns and random.random() < 0.2:
                    # Cells as large as the world or larger have no pattern.
                    size = int(random.integers(6, 8))
                    cell = register_map(1)["rectangle[0].pattern"].fields["cell"]
                    others = written[-1] & ~((1 << cell.width) - 1 << cell.lsb)
                    stimulus[-1][f"written_{names[3]}"] = others | size << cell.lsb
                    expected[-1] |= {"rect_kind": 0, "rect_cell": size}
    outputs = leaf.run_both(stimulus)
    assert {rect["rect_axis"] for rect in expected} == {0, 1, 2}
    for inputs, output, rect in zip(stimulus, outputs, expected, strict=True):
        assert output == rect, inputs
