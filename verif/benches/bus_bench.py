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
from raycaster.configuration import Configuration
from raycaster.registers import Register, register_map
from raycaster.scene import load_scene
from raycaster.sim.buses import Axi4LiteBus, BridgedBus
from raycaster.sim.harness import Harness
from raycaster.sim.register_model import EVERY_LANE

ACCESSES = 400
"""Number of accesses per seed."""


def kept_registers(config: Configuration) -> list[Register]:
    """Return registers that keep what is written and whose fields exist in every design."""
    registers = register_map(config.table)
    corners = [f"rectangle[{index}].corner_{end}" for index in range(config.table) for end in (0, 1)]
    return [registers[name] for name in ("irq_enable", "background", "camera", *corners)]


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


@cocotb.test()
async def words_and_a_frame(bench: HierarchyObject) -> None:
    """For each of the job's seeds, randomly written bytes read back, in between and all at the end; then a scene is
    drawn without a wrong pixel."""
    harness = Harness(bench)
    bus, config = harness.bus, harness.configuration
    assert isinstance(bus, BridgedBus)
    accesses = 0
    for seed in harness.job.seeds:
        random = Random(seed)
        await harness.reset()
        kept = kept_registers(config)
        words = {register.address: 0 for register in kept}
        masks = {register.address: register.implemented for register in kept}
        unmapped = set(range(1 << bus.address_bits)) - {one.address for one in bus.registers.values()}
        bus.press_back(random)

        async def write(random=random, words=words, masks=masks) -> None:
            address, word, lanes = random.choice(list(words)), random.getrandbits(32), random.randint(0, EVERY_LANE)
            mask = sum(0xFF << 8 * lane for lane in range(4) if lanes >> lane & 1)
            words[address] = (words[address] & ~mask | word & mask) & masks[address]
            await bus.write_word(address, word, lanes)

        async def read(address: int, seed=seed, words=words) -> None:
            seen_word = await bus.read_word(address)
            expected = words.get(address, 0)
            assert seen_word == expected, f"seed {seed}: {address} reads {seen_word:#010x}, expected {expected:#010x}"

        for _ in range(ACCESSES):
            accesses += 1
            if random.random() < 0.5:
                await write()
            else:
                await read(random.choice((*words, *unmapped)))
        if isinstance(bus, Axi4LiteBus):
            await both_ways(bus, random, words, masks)
        for address in words:
            await read(address)
    await harness.reset()
    scene = load_scene(harness.job.scene, config.capacity)
    await bus.load_scene(scene)
    await bus.commit(reflections=scene.reflections)
    harness.expect_picture(await harness.monitor.frame(), harness.golden(scene, scene.reflections), "the frame")
    harness.monitor.check_pins()
    assert accesses == ACCESSES * len(harness.job.seeds) > 0


async def both_ways(bus: Axi4LiteBus, random: Random, words: dict[int, int], masks: dict[int, int]) -> None:
    """Read some registers while others are written."""
    addresses = random.sample(list(words), len(words))
    written, still = addresses[::2], addresses[1::2]
    expected = dict(words)

    async def writes() -> None:
        for _ in range(ACCESSES):
            address, word = random.choice(written), random.getrandbits(32)
            await bus.write_word(address, word)
            words[address] = word & masks[address]

    writing = cocotb.start_soon(writes())
    reads = 0
    while not writing.done():
        address = random.choice(still)
        assert await bus.read_word(address) == expected[address], f"{address} while others are written"
        reads += 1
    assert reads > ACCESSES // 10


@cocotb.test()
async def cycles(bench: HierarchyObject) -> None:
    """An unhindered access takes exactly the number of cycles in the contract of its bus."""
    harness = Harness(bench)
    bus = harness.bus
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
