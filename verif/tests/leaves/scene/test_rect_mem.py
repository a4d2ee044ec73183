# SPDX-License-Identifier: MIT
"""`rect_mem`: readback, the usable rectangles, and the sorted rectangle that was fetched, after any writes."""

import numpy as np
import pytest
from scene_vectors import CYCLES, EVERY_BIT, label, random_bus, rectangle_words, sized

from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.rect_mem import rect_mem
from raycaster.sim.register_model import Table
from raycaster.verif.expected import sorted_rect


def almost_flat(random: np.random.Generator) -> tuple[int, ...]:
    """Return the words of an enabled rectangle whose corners differ by one bit or not at all on each axis."""
    first = int(random.integers(1 << WORD_BITS))
    second = first ^ int(random.integers(1 << WORD_BITS)) & ~register_map(1)["rectangle[0].corner_0"].implemented
    for field in register_map(1)["rectangle[0].corner_0"].fields.values():
        if random.random() < 0.75:
            second ^= 1 << field.lsb + int(random.integers(field.width))
    surface = int(random.integers(1 << 27)) | register_map(1)["rectangle[0].surface"].pack(enable=1)
    return first, second, surface, int(random.integers(1 << WORD_BITS))


def table_stimulus(random: np.random.Generator, table: Table, rectangles: int) -> list[dict[str, int]]:
    """Return a stimulus that writes rectangles in three ways.

    Some are written at random, in part and to neighbouring addresses; some whole, then read and shown; some whole and
    repeatedly, with commits and frames in between.
    """
    stimulus = [{**random_bus(random, [0]), "reset": 1}] * 2
    last = 1 << address_bits(rectangles)
    written = list(table.words)
    # With many rectangles, each cycle takes longer to simulate.
    while len(stimulus) < (CYCLES * 5 if rectangles <= 4 else CYCLES):
        _, words = rectangle_words(random)
        slot, size = int(random.integers(rectangles)), len(table.names)
        data = words[int(random.integers(len(words)))]
        addresses = written[size * slot : size * (slot + 1)]
        idle = {"bus_write": 0, "bus_commit": 0, "bus_go_live": 0, "bus_mask": EVERY_BIT, "reset": 0}
        if random.random() < 0.25:
            # The shadow, the pending and the live rectangle are each in one of three banks.
            for _, data in zip(range(8), words, strict=False):
                for address, word in zip(addresses, data, strict=False):
                    stimulus.append({**idle, "bus_write": 1, "bus_address": address, "bus_data": word})
                stimulus += [{**idle, "bus_address": addresses[0], "bus_data": 0}] * 2
                show = {name: int(random.random() < 0.5) for name in ("bus_commit", "bus_go_live")}
                stimulus.append({**stimulus[-1], **show, "reset": int(random.random() < 0.05)})
            continue
        if random.random() < 0.5:
            if random.random() < 0.8:
                data = almost_flat(random)
            for address, word in zip(addresses, data, strict=False):
                stimulus.append({**idle, "bus_write": 1, "bus_address": address, "bus_data": word})
            stimulus += [{**idle, "bus_address": address, "bus_data": 0} for address in addresses]
            stimulus[-2]["bus_commit"] = stimulus[-1]["bus_go_live"] = 1
            continue
        for address, word in zip(addresses, data, strict=False):
            bus = random_bus(random, [address] * 8 + [address ^ 1, int(random.integers(last))], word)
            stimulus.append({**bus, "reset": int(random.random() < 0.01)})
        stimulus.append({**random_bus(random, [int(random.integers(last))]), "reset": 0})
    return stimulus


def fill_places(random: np.random.Generator, table: Table) -> list[dict[str, int]]:
    """Return a reset and writes to all banks of all slots, which make an unknown memory known."""
    idle = random_bus(random, [0]) | {"bus_write": 0, "bus_commit": 0, "bus_go_live": 0, "reset": 0}
    writes = [
        {**idle, "bus_write": 1, "bus_address": address, "bus_data": int(random.integers(1 << WORD_BITS))}
        for address in table.words
    ]
    commit, go_live = {**idle, "bus_commit": 1}, {**idle, "bus_go_live": 1}
    return [{**idle, "reset": 1}, *writes, idle, commit, *writes, idle, commit, go_live, *writes, idle, idle, idle]


@pytest.mark.slow_sets("2", "3-", "32", "128", quick=["3-seed-materials-patterns"])
@pytest.mark.parametrize(
    ("rectangles", "options"),
    [
        *((rectangles, {"engine": engine}) for rectangles in (1, 2, 3, 12, 32) for engine in ("seed", "exact")),
        (128, {"engine": "span"}), (3, {"engine": "exact", "materials": True}),
        (2, {"engine": "exact", "patterns": True}),
        (3, {"engine": "seed", "materials": True, "patterns": True}),
    ],
    ids=lambda value: label(value) if isinstance(value, dict) else str(value),
)  # fmt: skip
def test_rect_mem(rectangles, options, leaf_of, random):
    config = sized(rectangles, **options)
    leaf, table = leaf_of(rect_mem, config), Table(config)
    filling = fill_places(random, table)
    leaf.stimulus = filling + table_stimulus(random, table, rectangles)
    for cycle, inputs in enumerate(leaf.stimulus):
        following = leaf.stimulus[min(cycle + 1, len(leaf.stimulus) - 1)]
        access = bool(following["bus_write"] or random.random() < 0.8)
        leaf.stimulus[cycle] = inputs | {
            "bus_access": int(access),
            "bus_next_address": following["bus_address"],
            "rects_fetch": int(cycle < len(filling) or random.random() < 0.6),
            "rects_index": int(random.integers(rectangles)),
        }
        if not access:
            following["bus_address"] = inputs["bus_address"]
        # The write that asks for a commit goes to another word, in the cycle before.
        if inputs["bus_commit"] and cycle:
            leaf.stimulus[cycle - 1]["bus_write"] = 0
    presented, bad, accessed = {}, False, False
    for cycle, inputs in enumerate(leaf.stimulus):
        live, shadow = table.rectangles("live"), table.rectangles("shadow")
        word = table.words.get(inputs["bus_address"])
        usable = sum(int(flag) << index for index, flag in enumerate(live.visible))
        wanted = {"bad_rectangle": bad, "rects_usable": usable}
        wanted |= {"readback": word.shadow if word else 0} if accessed else {}
        accessed = bool(inputs["bus_access"])
        leaf.expected[cycle] = wanted | presented
        if live.visible.any() and random.random() < 0.5:
            inputs["rects_index"] = int(random.choice(np.flatnonzero(live.visible)))
        if inputs["rects_fetch"]:
            index = inputs["rects_index"]
            presented = sorted_rect(live, index, "rects_rect", config) if live.visible[index] else {}
        # bad_rectangle follows the shadow by a cycle.
        bad = bool(np.any(shadow.enabled & (shadow.axes < 0))) and not inputs["reset"]
        table.clock(inputs)
    seen = [cycle for cycle, wanted in leaf.expected.items() if "rects_rect_axis" in wanted]
    assert sum(cycle >= len(filling) for cycle in seen) > 50
    leaf.check(settled=len(filling))
