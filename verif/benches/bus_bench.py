# SPDX-License-Identifier: MIT
"""cocotb: register access over any bus, with random back-pressure: every word that was written, and a frame.

Expected words and latencies come from the register map and the buses' contracts, not from the registers themselves.
"""

from __future__ import annotations

from random import Random
from typing import Any

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.triggers import ClockCycles, RisingEdge

from raycaster.buses import BUSES
from raycaster.sim.buses import Axi4LiteBus, BridgedBus
from raycaster.sim.harness import Harness
from raycaster.sim.register_model import EVERY_LANE, SceneFollower

ACCESSES = 400
"""Number of accesses per seed; a tenth on a serial line, on which each takes some thousands of cycles."""


async def measure(bench: Any, bus: BridgedBus, found: dict[str, set[int]]) -> None:
    """Count the cycles of each access on the bus."""
    ages = dict.fromkeys(found, 0)

    def is_as_marked(name: str) -> bool:
        signal = name.lstrip("!")
        # An input has a copy with the value that the design sees in this cycle.
        present = f"seen_{signal}" if hasattr(bench, f"seen_{signal}") else signal
        return str(getattr(bench, present).value) == ("0" if "!" in name else "1")

    while True:
        await RisingEdge(bench.bus_clk)
        for kind, age in ages.items():
            if age or all(map(is_as_marked, bus.begins[kind])):
                ages[kind] = age + 1
            if ages[kind] and all(map(is_as_marked, bus.ends[kind])):
                found[kind].add(ages[kind])
                ages[kind] = 0


async def check_words(harness: Harness, bus: BridgedBus, seed: int) -> None:
    """Read randomly written bytes back, in between and all at the end."""
    random, written = Random(seed), SceneFollower(harness.configuration)
    words = sorted(written.shadow.keys() - {bus.registers["control"].address})
    unmapped = sorted(set(range(1 << bus.address_bits)) - {one.address for one in bus.registers.values()})
    accesses = ACCESSES // 10 if BUSES[harness.configuration.bus].serial else ACCESSES
    bus.press_back(random)

    async def write(address: int) -> None:
        word, lanes = random.getrandbits(32), random.randint(0, EVERY_LANE)
        written.write(0, address, word, lanes)
        await bus.write_word(address, word, lanes)

    async def read(address: int) -> None:
        word, expected = await bus.read_word(address), written.shadow.get(address, 0)
        assert word == expected, f"seed {seed}: {address} reads {word:#010x}, expected {expected:#010x}"

    async def write_some(addresses: list[int]) -> None:
        for _ in range(ACCESSES):
            await write(random.choice(addresses))

    for _ in range(accesses):
        if random.random() < 0.5:
            await write(random.choice(words))
        else:
            await read(random.choice((*words, *unmapped)))
    if isinstance(bus, Axi4LiteBus):
        # Some words are read while others are written.
        addresses = random.sample(words, len(words))
        writing, reads = cocotb.start_soon(write_some(addresses[::2])), 0
        while not writing.done():
            await read(random.choice(addresses[1::2]))
            reads += 1
        assert reads > ACCESSES // 10
    for address in words:
        await read(address)


@cocotb.test()
async def words_and_a_frame(bench: HierarchyObject) -> None:
    """For each of the job's seeds, words read back; then a scene is drawn without a wrong pixel."""
    harness = Harness(bench)
    assert isinstance(harness.bus, BridgedBus)
    assert harness.job.seeds
    for seed in harness.job.seeds:
        await harness.reset()
        await check_words(harness, harness.bus, seed)
    await harness.reset()
    await harness.load(harness.scene, harness.reflections)
    await harness.expect(harness.scene, harness.reflections, "the frame")
    harness.monitor.check_pins()


@cocotb.test()
async def cycles(bench: HierarchyObject) -> None:
    """An unhindered access takes exactly the number of cycles in the contract of its bus, if there is one."""
    harness = Harness(bench)
    bus = harness.bus
    if BUSES[harness.configuration.bus].serial:
        return
    assert isinstance(bus, BridgedBus)
    await harness.reset()
    await ClockCycles(harness.bench.clk, 4)
    found: dict[str, set[int]] = {"write": set(), "read": set()}
    cocotb.start_soon(measure(harness.bench, bus, found))
    address = bus.registers["background"].address
    for number in range(20):
        await bus.write_word(address, number)
        assert await bus.read_word(address) == number
    expected = BUSES[harness.configuration.bus]
    assert found == {"write": {expected.write}, "read": {expected.read}}, found
