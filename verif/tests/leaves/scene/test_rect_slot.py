# SPDX-License-Identifier: MIT
"""`rect_slot`: the bank of each copy, and whether it is usable, after writes, commits and frames in any order."""

from scene_vectors import CYCLES, EVERY_BIT
from vectors import by

from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.written_rect import BANK_BITS, BANKS, Copies
from raycaster.sim.register_model import Word


@by(number=[0, 3])
def test_rect_slot(number, leaf_of, random):
    ports = {"bus": lambda: SceneBus(7), "copies": Copies, "index": 2, "number": 2, "bank": BANK_BITS}
    leaf = leaf_of(rect_slot, **ports)
    # Each copy is its bank, with a bit above that says whether it is usable.
    usable_bit = 1 << BANK_BITS
    model, bad = Word(EVERY_BIT), False
    for cycle in range(2 * CYCLES):
        inputs = {"reset": int(cycle == 0 or random.random() < 0.05)}
        inputs |= {name: int(random.random() < 0.3) for name in ("bus_commit", "bus_go_live")}
        inputs |= {"storing": int(random.random() < 0.4), "index": int(random.choice([number, random.integers(4)]))}
        inputs |= {"number": number, "bank": int(random.integers(BANKS))}
        inputs |= {name: int(random.integers(2)) for name in ("enable", "flat")}
        copies = {f"copies_{stage}": getattr(model, stage) % usable_bit for stage in ("shadow", "pending", "live")}
        leaf.case(inputs, copies | {"usable": model.live >= usable_bit, "bad": bad})
        storing = bool(inputs["storing"] and inputs["index"] == number)
        good = usable_bit if inputs["enable"] and inputs["flat"] else 0
        if inputs["reset"]:
            model.reset()
            bad = False
        else:
            model.clock({**inputs, "bus_write": 1, "bus_data": inputs["bank"] | good, "bus_mask": EVERY_BIT}, storing)
            bad = bool(inputs["enable"] and not inputs["flat"]) if storing else bad
    leaf.check(settled=1)
