# SPDX-License-Identifier: MIT
"""Leaf test of `scene_word`: writes to some byte lanes, commits and frames; the shadow and the live word after each."""

import pytest
from myhdl import Signal, intbv
from scene_vectors import CYCLES, EVERY_BIT, random_bus

from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.sim.register_model import Word


@pytest.mark.parametrize(
    ("implemented", "first"), [(EVERY_BIT, 0), (0x1FF7FDFF, 0), (0x3FFFFFFF, 256), (1, 0), (0, 0), ("any", 3 << 10)]
)
def test_scene_word(implemented, first, leaf_of, random):
    words = dict.fromkeys(("shadow", "live"), lambda: Signal(intbv(first)[WORD_BITS:]))
    leaf = leaf_of(scene_word, bus=lambda: SceneBus(7), implemented=WORD_BITS, **words, first=first)
    model = Word(0, first)
    for cycle in range(CYCLES):
        inputs = random_bus(random, [0]) | {"reset": int(cycle == 0 or random.random() < 0.05)}
        del inputs["bus_address"]
        # In a separate module this input is no constant: its value at each write counts.
        bits = int(random.integers(1 << WORD_BITS)) if implemented == "any" else implemented
        inputs |= {"implemented": bits, "selected": int(random.random() < 0.8)}
        leaf.case(inputs, {"shadow": model.shadow, "live": model.live})
        model.implemented = bits
        if inputs["reset"]:
            model.reset()
        else:
            model.clock(inputs, bool(inputs["selected"]))
    leaf.check(settled=1)
