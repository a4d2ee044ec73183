# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_sorter`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from scene_vectors import label, rectangle_words, sized
from vectors import check, leaf_of

from raycaster.registers import register_map
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.written_rect import written_of
from raycaster.sim.register_model import Table
from raycaster.verif.expected import sorted_rect

LOOKS = [
    {"engine": "exact"}, {"engine": "exact", "materials": True}, {"engine": "beam", "patterns": True},
    {"engine": "exact", "materials": True, "patterns": True},
]  # fmt: skip


@pytest.mark.parametrize("options", LOOKS, ids=label)
def test_rect_sorter(options, tmp_path, random):
    """Rectangles on each axis with corners in any order, and every look."""
    config = sized(1, **options)
    leaf = leaf_of(rect_sorter, tmp_path, config, written=lambda: written_of(config))
    names, cell = Table(config).names, register_map(1)["rectangle[0].pattern"].fields["cell"]
    stimulus, expected = [], []
    for _ in range(150):
        table, words = rectangle_words(random)
        for index, written in enumerate(words):
            if table.axes[index] >= 0:
                stimulus.append({f"written_{name}": word for name, word in zip(names, written, strict=False)})
                expected.append(sorted_rect(table, index, "rect", config))
                if config.patterns and random.random() < 0.2:
                    # Cells as large as the world or larger have no pattern.
                    size = int(random.integers(6, 8))
                    others = written[-1] & ~((1 << cell.width) - 1 << cell.lsb)
                    stimulus[-1][f"written_{names[3]}"] = others | size << cell.lsb
                    expected[-1] |= {"rect_kind": 0, "rect_cell": size}
    assert {rect["rect_axis"] for rect in expected} == {0, 1, 2}
    check(leaf, stimulus, expected)
