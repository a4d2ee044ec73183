# SPDX-License-Identifier: MIT
"""cocotb: the registers as software sees them, and their effect on the picture."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject
from cocotb.simtime import get_sim_time
from cocotb.triggers import ClockCycles

from raycaster.registers import Register
from raycaster.scene import Scene, load_scene
from raycaster.sim.avalon import AvalonBus
from raycaster.sim.harness import Harness
from raycaster.verif.seeds import seed

ALL_ONES = 0xFFFF_FFFF
BASIS = ("forward", "right", "up")


def _writable(harness: Harness) -> list[Register]:
    """Return the registers that keep what is written, each with the fields that the design implements."""
    names = ("irq_enable", "background", "camera", *BASIS, "light", "rectangle[")
    config = harness.configuration
    found = []
    for name, register in harness.bus.registers.items():
        missing = set()
        lacking = {"light": not config.light, **dict.fromkeys(BASIS, not config.turn)}
        if lacking.get(name) or (name.endswith("pattern") and not config.patterns):
            missing = set(register.fields)
        elif name.endswith("surface") and not config.materials:
            missing = {"mirror"}
        if name.startswith(names):
            fields = {field: place for field, place in register.fields.items() if field not in missing}
            found.append(replace(register, fields=fields))
    return found


def _mask(register: Register) -> int:
    return sum(field.mask for field in register.fields.values())


@cocotb.test()
async def says_what_it_is(bench: HierarchyObject) -> None:
    """Registers report the identification, the version and the configuration, and ignore writes."""
    harness = Harness(bench)
    configuration, bus = harness.configuration, harness.bus
    await harness.reset()
    expected = {
        "id": {"magic": int.from_bytes(b"RAYC", "big")},
        "version": {name: field.reset for name, field in bus.registers["version"].fields.items()},
        "engine": {
            "engine": configuration.facts.code,
            "fraction_bits": configuration.fraction_bits,
            "nearest": int(configuration.rounding == "nearest"),
            "divider_bits": configuration.divider_bits,
            "reflections": configuration.reflections,
            "scale": configuration.scale,
            "colour_bits": configuration.colour_bits,
            "fixed": 0,
            "culling": int(configuration.culling),
            "turn": int(configuration.turn),
            "materials": int(configuration.materials),
            "patterns": int(configuration.patterns),
            "light": int(configuration.light),
        },
        "size": {
            "units": configuration.units,
            "rectangles": configuration.rectangles,
            "rows": configuration.rows,
        },
    }
    for _ in range(2):
        for name, fields in expected.items():
            assert await bus.read(name) == fields, name
            await bus.write_word(bus.registers[name].address, ALL_ONES)  # changes nothing


@cocotb.test()
async def reset_values(bench: HierarchyObject) -> None:
    """Every writable field is 0 after reset, whatever it was before, except that a camera that turns looks along x."""
    harness = Harness(bench)
    await harness.reset()
    await harness.bus.write("control", run=1, reflections=3)
    for register in _writable(harness):
        await harness.bus.write_word(register.address, ALL_ONES)
    await harness.reset()
    for name in ("control", "cycles", "irq_pending"):
        assert await harness.bus.read_word(harness.bus.registers[name].address) == 0, name
    assert (await harness.bus.read("status"))["underrun"] == 0
    first = {"forward": 1 << 8, "right": 1 << 18, "up": 1 << 28} if harness.configuration.turn else {}
    for register in _writable(harness):
        assert await harness.bus.read_word(register.address) == first.get(register.name, 0), register.name


@cocotb.test()
async def reads_back_what_was_written(bench: HierarchyObject) -> None:
    """Every writable field reads back, byte by byte; bits outside all fields read 0."""
    harness = Harness(bench)
    bus = harness.bus
    random = Random(seed())
    await harness.reset()
    expected = {}
    for register in _writable(harness):
        word = random.getrandbits(32)
        await bus.write_word(register.address, word)
        expected[register.address] = word & _mask(register)
    for _ in range(2):
        for address, word in expected.items():
            assert await bus.read_word(address) == word, f"address {address}"
        for register in _writable(harness):
            word, byteenable = random.getrandbits(32), random.getrandbits(4)
            await bus.write_word(register.address, word, byteenable)
            lanes = sum(0xFF << 8 * lane for lane in range(4) if byteenable >> lane & 1)
            kept = expected[register.address] & ~lanes
            expected[register.address] = kept | word & lanes & _mask(register)
    for run, reflections in ((1, 2), (0, 1)):
        await bus.write("control", run=run, reflections=reflections)
        assert await bus.read("control") == {"run": run, "commit": 0, "reflections": reflections}
    await bus.write_word(bus.registers["control"].address, 0x303, 0b0010)
    assert await bus.read("control") == {"run": 0, "commit": 0, "reflections": 3}


@cocotb.test()
async def unmapped_addresses(bench: HierarchyObject) -> None:
    """Unmapped addresses read 0, and writes to them change nothing."""
    harness = Harness(bench)
    bus = harness.bus
    random = Random(seed())
    await harness.reset()
    expected = {register.address: random.getrandbits(32) & _mask(register) for register in _writable(harness)}
    for address, word in expected.items():
        await bus.write_word(address, word)
    mapped = {register.address for register in bus.registers.values()}
    unmapped = [address for address in range(1 << bus.address_bits) if address not in mapped]
    for address in unmapped:
        await bus.write_word(address, ALL_ONES)
        assert await bus.read_word(address) == 0, f"address {address}"
    for address, word in expected.items():
        assert await bus.read_word(address) == word, f"address {address}"


@cocotb.test()
async def pipelined_reads(bench: HierarchyObject) -> None:
    """Back-to-back reads are each answered once, in order."""
    harness = Harness(bench)
    bus = harness.bus
    random = Random(seed())
    await harness.reset()
    expected = {register.address: random.getrandbits(32) & _mask(register) for register in _writable(harness)}
    for address, word in expected.items():
        await bus.write_word(address, word)
    addresses = random.choices(list(expected), k=64)
    assert isinstance(bus, AvalonBus)
    assert await bus.read_pipelined(addresses) == [expected[address] for address in addresses]


@cocotb.test()
async def disabled_rectangles_cost_nothing(bench: HierarchyObject) -> None:
    """Each disabled rectangle, wherever it is in the table, saves a group the cycles of one rectangle; with culling,
    those that were not already saved."""
    harness = Harness(bench)
    bus, configuration = harness.bus, harness.configuration
    scene = _scene(harness)
    kept = range(1, len(scene.rect), 3)
    few = scene.model_copy(update={"rect": tuple(scene.rect[index] for index in kept)})
    reflections = configuration.reflections

    await harness.reset()
    await bus.load_scene(scene)
    await bus.commit(reflections=reflections)
    harness.expect_picture(await harness.monitor.frame(), harness.golden(scene, reflections), "all rectangles")
    all_cycles = await bus.read("cycles")
    if len(scene.rect) == configuration.rectangles:
        assert all_cycles["group"] <= configuration.group_cycles
    await bus.write("cycles")
    assert await bus.read("cycles") == {"row": 0, "group": 0}, "a write clears the cycle counters"

    for index in range(len(scene.rect)):
        if index not in kept:
            await bus.write(f"rectangle[{index}].surface", enable=0, red=255)
    await bus.commit(reflections=reflections)
    harness.expect_picture(await harness.monitor.frame(), harness.golden(few, reflections), "every third rectangle")
    few_cycles = await bus.read("cycles")
    saved = (len(scene.rect) - len(few.rect)) * (reflections + 1) * configuration.slot_cycles
    fallen = all_cycles["group"] - few_cycles["group"]
    assert 0 <= fallen <= saved if configuration.culling else fallen == saved, (all_cycles, few_cycles)
    assert (few_cycles["row"] < all_cycles["row"]) == (saved > 0)


@cocotb.test()
async def bad_rectangle(bench: HierarchyObject) -> None:
    """An enabled rectangle without a plane is reported when it is committed, and is not drawn."""
    harness = Harness(bench)
    bus = harness.bus
    scene = _scene(harness)
    scene = scene.model_copy(update={"rect": scene.rect[: harness.configuration.rectangles - 1]})
    bad = len(scene.rect)
    await harness.reset()
    await bus.load_scene(scene)
    await bus.write(f"rectangle[{bad}].corner_0", x=30, y=0, z=0)
    await bus.write(f"rectangle[{bad}].corner_1", x=60, y=511, z=511)
    await bus.commit(reflections=scene.reflections)
    assert (await bus.read("status"))["bad_rectangle"] == 0, "it is disabled"
    await bus.write(f"rectangle[{bad}].surface", enable=1, red=255, green=255, blue=255)
    assert (await bus.read("status"))["bad_rectangle"] == 0, "it is not committed yet"
    await bus.commit(reflections=scene.reflections)
    await ClockCycles(harness.bench.clk, 4)
    assert (await bus.read("status"))["bad_rectangle"] == 1
    harness.expect_picture(
        await harness.monitor.frame(), harness.golden(scene, scene.reflections), "without the bad one"
    )
    await bus.write("status", bad_rectangle=0)
    assert (await bus.read("status"))["bad_rectangle"] == 1, "writing 0 must not clear it"
    await bus.write("status", bad_rectangle=1)
    assert (await bus.read("status"))["bad_rectangle"] == 0, "writing 1 clears it"


@cocotb.test()
async def black_until_told_to_run(bench: HierarchyObject) -> None:
    """The picture is black before the first commit and while run is 0."""
    harness = Harness(bench)
    bus = harness.bus
    scene = _scene(harness).model_copy(update={"background": (255, 255, 255)})
    golden = harness.golden(scene, scene.reflections)
    await harness.reset()
    await bus.load_scene(scene)
    harness.expect_picture(await harness.monitor.frame(), np.zeros_like(golden), "nothing committed")
    await bus.commit(reflections=scene.reflections)
    harness.expect_picture(await harness.monitor.frame(), golden, "run = 1")
    await bus.commit(run=0, reflections=scene.reflections)
    harness.expect_picture(await harness.monitor.frame(), np.zeros_like(golden), "run = 0")
    await bus.commit(reflections=scene.reflections)
    harness.expect_picture(await harness.monitor.frame(), golden, "run = 1 again")


@cocotb.test()
async def reflections_at_run_time(bench: HierarchyObject) -> None:
    """A picture has as many reflections as asked for, up to the limit of the hardware."""
    harness = Harness(bench)
    maximum = harness.configuration.reflections
    scene = _scene(harness)
    await harness.reset()
    await harness.bus.load_scene(scene)
    for asked in range(4):
        await harness.bus.commit(reflections=asked)
        golden = harness.golden(scene, min(asked, maximum))
        harness.expect_picture(await harness.monitor.frame(), golden, f"{asked} reflections")


@cocotb.test()
async def reset_in_mid_frame(bench: HierarchyObject) -> None:
    """Reset restarts the video at the first pixel of the vertical front porch, and the next frame is whole."""
    harness = Harness(bench)
    bus, monitor, screen = harness.bus, harness.monitor, harness.screen
    scene = _scene(harness)
    await harness.reset()
    await bus.load_scene(scene)
    await bus.commit(reflections=scene.reflections)
    lines_to_middle = screen.vertical.blank + screen.vertical.visible // 2
    for _ in range(lines_to_middle):
        await monitor.line()
    await ClockCycles(harness.bench.clk, 37)

    await harness.reset()
    released_ns = get_sim_time("ns")
    await bus.load_scene(scene)
    await bus.commit(reflections=scene.reflections)
    frame = await harness.frame_after_reset(released_ns)
    harness.expect_picture(frame, harness.golden(scene, scene.reflections), "the frame after reset")
    monitor.check_pins()


def _scene(harness: Harness) -> Scene:
    return load_scene(harness.job.scene, harness.configuration.rectangles)
