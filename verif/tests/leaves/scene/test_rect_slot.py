# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_slot`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from scene_vectors import CYCLES, EVERY_BIT
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.written_rect import PLACE_BITS, PLACES, Copies
from raycaster.sim.register_model import Word


@pytest.mark.parametrize("number", [0, 3])
def test_rect_slot(number, tmp_path, random):
    leaf = Leaf(rect_slot, lambda: ports(
        "clk reset storing enable flat usable bad", bus=SceneBus(7), index=unsigned(2), number=unsigned(2),
        place=unsigned(PLACE_BITS), copies=Copies()
    ), tmp_path)  # fmt: skip
    stimulus = [
        {
            "reset": int(cycle == 0 or random.random() < 0.05),
            "bus_commit": int(random.random() < 0.3),
            "bus_go_live": int(random.random() < 0.3),
            "storing": int(random.random() < 0.4),
            "index": int(random.choice([number, random.integers(4)])),
            "number": number,
            "place": int(random.integers(PLACES)),
            "enable": int(random.integers(2)),
            "flat": int(random.integers(2)),
        }
        for cycle in range(2 * CYCLES)
    ]
    outputs = leaf.run_both(stimulus, settled=1)
    # Each copy is its place, with a bit above that says whether it is usable.
    usable_bit = 1 << PLACE_BITS
    model, bad = Word(EVERY_BIT), False
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            expected = {
                f"copies_{stage}": getattr(model, stage) % usable_bit for stage in ("shadow", "pending", "live")
            }
            expected |= {"usable": model.live >= usable_bit, "bad": bad}
            assert output == expected, cycle
        if inputs["reset"]:
            model.reset()
            bad = False
            continue
        storing = bool(inputs["storing"] and inputs["index"] == number)
        good = usable_bit if inputs["enable"] and inputs["flat"] else 0
        model.clock({**inputs, "bus_write": 1, "bus_data": inputs["place"] | good, "bus_mask": EVERY_BIT}, storing)
        if storing:
            bad = bool(inputs["enable"] and not inputs["flat"])
