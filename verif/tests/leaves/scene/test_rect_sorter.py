# SPDX-License-Identifier: MIT
"""Leaf test of `rect_sorter`: rectangles on each axis with corners in any order, and every look."""

import pytest
from scene_vectors import label, rectangle_words, sized

from raycaster.registers import register_map
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.written_rect import written_of
from raycaster.sim.register_model import Table
from raycaster.verif.expected import sorted_rect

LOOKS = [
    {"engine": "exact"}, {"engine": "exact", "materials": True}, {"engine": "span", "patterns": True},
    {"engine": "exact", "materials": True, "patterns": True},
]  # fmt: skip


@pytest.mark.parametrize("options", LOOKS, ids=label)
def test_rect_sorter(options, leaf_of, random):
    config = sized(1, **options)
    leaf = leaf_of(rect_sorter, config, written=lambda: written_of(config))
    names, cell = Table(config).names, register_map(1)["rectangle[0].pattern"].fields["cell"]
    for _ in range(150):
        table, words = rectangle_words(random)
        for index, written in enumerate(words):
            if table.axes[index] >= 0:
                leaf.case({f"written_{name}": word for name, word in zip(names, written, strict=False)})
                leaf.expect(sorted_rect(table, index, "rect", config))
                if config.patterns and random.random() < 0.2:
                    # Cells as large as the world or larger have no pattern.
                    size = int(random.integers(6, 8))
                    others = written[-1] & ~((1 << cell.width) - 1 << cell.lsb)
                    leaf.stimulus[-1][f"written_{names[3]}"] = others | size << cell.lsb
                    leaf.expect({"rect_kind": 0, "rect_cell": size})
    assert {rect["rect_axis"] for rect in leaf.expected.values()} == {0, 1, 2}
    leaf.check()
