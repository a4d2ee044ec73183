# SPDX-License-Identifier: MIT
"""Leaf tests of `scene_word`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from myhdl import Signal, intbv
from scene_vectors import CYCLES, EVERY_BIT, random_bus
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.sim.register_model import Word


@pytest.mark.parametrize(
    ("implemented", "first"), [(EVERY_BIT, 0), (0x1FF7FDFF, 0), (0x3FFFFFFF, 256), (1, 0), (0, 0), ("any", 3 << 10)]
)
def test_scene_word(implemented, first, tmp_path, random):
    leaf = Leaf(scene_word, lambda: ports(
        "clk reset selected", bus=SceneBus(7), implemented=unsigned(WORD_BITS),
        shadow=Signal(intbv(first)[WORD_BITS:]), live=Signal(intbv(first)[WORD_BITS:]), first=first
    ), tmp_path)  # fmt: skip
    stimulus = []
    for cycle in range(CYCLES):
        inputs = random_bus(random, [0]) | {"reset": int(cycle == 0 or random.random() < 0.05)}
        del inputs["bus_address"]
        # In a separate module this input is no constant: its value at each write counts.
        bits = int(random.integers(1 << WORD_BITS)) if implemented == "any" else implemented
        stimulus.append(inputs | {"implemented": bits, "selected": int(random.random() < 0.8)})
    outputs = leaf.run_both(stimulus, settled=1)
    model = Word(0, first)
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            assert output == {"shadow": model.shadow, "live": model.live}, cycle
        model.implemented = inputs["implemented"]
        if inputs["reset"]:
            model.reset()
        else:
            model.clock(inputs, bool(inputs["selected"]))
