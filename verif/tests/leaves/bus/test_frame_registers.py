# SPDX-License-Identifier: MIT
"""Leaf test of `frame_registers`: events and writes in any cycle, often in the same one; bytes that are not written."""

from vectors import named

from raycaster.registers import address_bits, register_map
from raycaster.rtl.bus.frame_registers import frame_registers
from raycaster.rtl.common.interfaces import FrameEvents, SceneBus
from raycaster.rtl.common.widths import WORD_BITS

RECTANGLES = 2
EVENTS = {"drawn": 0.3, "shown": 0.2, "again": 0.3, "late": 0.03, "list_full": 0.1}
NONE = 0xFFFFFFFF


def test_frame_registers(leaf_of, random):
    registers = register_map(RECTANGLES, lists=True)
    words = {name: registers[f"frames.{name}"] for name in ("cycles", "left", "counts", "status")}
    made = {"bus": lambda: SceneBus(address_bits(RECTANGLES, lists=True)), "events": FrameEvents}
    leaf = leaf_of(frame_registers, rectangles=RECTANGLES, rect_readback=WORD_BITS, readback=WORD_BITS, **made)
    initial = {"cycles": 0, "least": NONE, "drawn": 0, "again": 0, "late": 0, "list_full": 0}
    kept, both = dict(initial), set()
    leaf.case({"reset": 1})
    for _ in range(6000):
        reset, write = int(random.random() < 0.002), int(random.random() < 0.3)
        name = str(random.choice(["left", "status", "cycles", "counts", "other"], p=[0.3, 0.3, 0.15, 0.15, 0.1]))
        address = words[name].address if name in words else int(random.choice([0, 1, 0x301 ^ 0x40, 0x304]))
        data, mask = int(random.integers(1 << 32)), int(random.choice([0, NONE, 0xFF, 0xFF00]))
        events = {event: int(random.random() < chance) for event, chance in EVENTS.items()}
        # The times of 32 bits are near each other, or at their limits.
        time = int(random.choice([0, 1, NONE - 1, NONE, random.integers(100, 110)], p=[0.05, 0.05, 0.1, 0.1, 0.7]))
        traffic = named("bus", {"write": write, "address": address, "data": data, "mask": mask})
        other = int(random.integers(1 << 32))
        leaf.case({"reset": reset, **traffic, **named("events", events), "events_time": time, "rect_readback": other})
        read = {"cycles": kept["cycles"], "left": kept["least"]}
        read["counts"] = words["counts"].pack(drawn=kept["drawn"], again=kept["again"])
        read["status"] = words["status"].pack(late=kept["late"], list_full=kept["list_full"])
        leaf.expect({"readback": read.get(name, other)})
        clears = write and name == "left" and mask
        ones = data & mask if write and name == "status" else 0
        both |= {flag for number, flag in enumerate(("late", "list_full")) if ones >> number & 1 and events[flag]}
        if clears and events["shown"]:
            both.add("left")
        if events["drawn"]:
            kept["cycles"] = time
        times = [NONE if clears else kept["least"], *[time] * events["shown"], *[0] * events["late"]]
        kept["least"] = min(times)
        for count in ("drawn", "again"):
            kept[count] = (kept[count] + events[count]) % (1 << 16)
        for number, flag in enumerate(("late", "list_full")):
            kept[flag] = events[flag] or (kept[flag] and not ones >> number & 1)
        if reset:
            kept = dict(initial)
    leaf.check(settled=1, spare=True)
    assert both == {"late", "list_full", "left"}
