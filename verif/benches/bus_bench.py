# SPDX-License-Identifier: MIT
"""cocotb: the registers over any bus, with back-pressure at random: every word that was written, and a frame.

Words and how fast they come are held against what the register map and the buses' contracts say, and not against the
registers themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.triggers import ClockCycles, RisingEdge

from raycaster.configuration import Configuration
from raycaster.registers import Register, register_map
from raycaster.scene import load_scene
from raycaster.sim.buses import ApbRegisterBus, Axi4LiteBus, WishboneBus
from raycaster.sim.harness import Harness
from raycaster.sim.register_model import EVERY_LANE

ACCESSES = 400
"""By each seed."""

CYCLES = {"axi4lite": {"write": 3, "read": 3}, "wishbone": {"write": 1, "read": 3}, "apb": {"write": 2, "read": 3}}
"""Of an access, from the first in which all of it is on the bus to the one with its response, on a bus that is free."""

BEGINS = {
    "axi4lite": {"write": ("s_axi_awvalid", "s_axi_wvalid"), "read": ("s_axi_arvalid",)},
    "wishbone": {"write": ("wb_cyc", "wb_stb", "wb_we"), "read": ("wb_cyc", "wb_stb", "!wb_we")},
    "apb": {"write": ("s_apb_psel", "s_apb_pwrite"), "read": ("s_apb_psel", "!s_apb_pwrite")},
}
ENDS = {
    "axi4lite": {"write": ("s_axi_bvalid", "s_axi_bready"), "read": ("s_axi_rvalid", "s_axi_rready")},
    "wishbone": dict.fromkeys(("write", "read"), ("wb_ack",)),
    "apb": dict.fromkeys(("write", "read"), ("s_apb_penable", "s_apb_pready")),
}
"""Signals that are high, or with a mark low, in the first and in the last cycle of an access."""


def kept_registers(config: Configuration) -> list[Register]:
    """Some that hold what is written, with the fields that every design has."""
    registers = register_map(config.table)
    corners = [f"rectangle[{index}].corner_{end}" for index in range(config.table) for end in (0, 1)]
    return [registers[name] for name in ("irq_enable", "background", "camera", *corners)]


def odds(random: Random, chance: float) -> Iterator[bool]:
    """True as often as that, in each clock anew."""
    while True:
        yield random.random() < chance


def press_back(harness: Harness, random: Random) -> None:
    """Have the master make wait, by chances of its own for each channel."""
    match harness.bus:
        case Axi4LiteBus():
            harness.bus.pause(*(odds(random, random.choice((0.0, 0.3, 0.8))) for _ in range(5)))
        case ApbRegisterBus():
            harness.bus.pause(odds(random, random.choice((0.0, 0.5))))
        case WishboneBus():
            most = random.choice((0, 3))
            harness.bus.idle = iter(lambda: random.randint(0, most), None)


async def measure(bench: HierarchyObject, bus: str, found: dict[str, set[int]]) -> None:
    """Count the cycles of each access that the bus has."""
    ages = dict.fromkeys(found, 0)

    def all_high(names: tuple[str, ...]) -> bool:
        return all(str(getattr(bench, name.lstrip("!")).value) == ("0" if "!" in name else "1") for name in names)

    while True:
        await RisingEdge(bench.bus_clk)
        for kind, age in ages.items():
            if age or all_high(seen(BEGINS[bus][kind])):
                ages[kind] = age + 1
            if ages[kind] and all_high(seen(ENDS[bus][kind])):
                found[kind].add(ages[kind])
                ages[kind] = 0


def seen(names: tuple[str, ...]) -> tuple[str, ...]:
    """These signals of a bench as the design has them in the present cycle."""
    driven = ("ack", "bvalid", "rvalid", "pready")
    return tuple(name if name.endswith(driven) else f"{'!' * ('!' in name)}seen_{name.lstrip('!')}" for name in names)


@cocotb.test()
async def words_and_a_frame(bench: HierarchyObject) -> None:
    """For each of the job's seeds: bytes written at random, reads of them between, and all of them at the end; then a
    scene that is drawn without a wrong pixel."""
    harness = Harness(bench)
    bus, config = harness.bus, harness.configuration
    accesses = 0
    for seed in harness.job.seeds:
        random = Random(seed)
        await harness.reset()
        kept = kept_registers(config)
        words = {register.address: 0 for register in kept}
        masks = {register.address: register.implemented for register in kept}
        unmapped = set(range(1 << bus.address_bits)) - {one.address for one in bus.registers.values()}
        press_back(harness, random)

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
    """Reads and writes at the same time, of registers that are not the same."""
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
    """An access that nothing hinders takes as many as it should, and never fewer."""
    harness = Harness(bench)
    bus = harness.bus
    await harness.reset()
    await ClockCycles(bench.clk, 4)
    found: dict[str, set[int]] = {"write": set(), "read": set()}
    cocotb.start_soon(measure(bench, harness.configuration.bus, found))
    address = bus.registers["background"].address
    for number in range(20):
        await bus.write_word(address, number)
        assert await bus.read_word(address) == number
    expected = CYCLES[harness.configuration.bus]
    assert found == {kind: {count} for kind, count in expected.items()}, found
