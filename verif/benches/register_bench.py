# SPDX-License-Identifier: MIT
"""cocotb: effects of the registers on the picture and on the interrupt; the traffic bench checks every answer."""

from __future__ import annotations

from random import Random

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject
from cocotb.triggers import ClockCycles

from raycaster.golden.frames import scene_cycles
from raycaster.rtl.engines import buffered_engine_of
from raycaster.scene import Scene
from raycaster.sim.harness import Harness
from raycaster.sim.register_model import EVERY_LANE, SceneFollower
from raycaster.verif.expected import check_cycles
from raycaster.verif.seeds import seed

NOT_OF_THE_SCENE = (
    "id", "version", "engine", "size", "table", "control", "status", "cycles", "irq_enable", "irq_pending",
)  # fmt: skip


@cocotb.test()
async def every_byte_of_every_word(bench: HierarchyObject) -> None:
    """Randomly written bytes of the scene's words read back; other bits and unmapped addresses ignore writes."""
    harness = Harness(bench)
    bus, random, written = harness.bus, Random(seed()), SceneFollower(harness.configuration)
    others = {
        register.address
        for name, register in bus.registers.items()
        if name in NOT_OF_THE_SCENE or name.startswith("frames.")
    }
    addresses = sorted(set(range(1 << bus.address_bits)) - others)
    await harness.reset()
    for _ in range(3):
        for address in addresses:
            assert await bus.read_word(address) == written.shadow.get(address, 0), f"address {address}"
        for address in addresses:
            word, lanes = random.getrandbits(32), random.randint(0, EVERY_LANE)
            await bus.write_word(address, word, lanes)
            written.write(0, address, word, lanes)


@cocotb.test()
async def disabled_rectangles_cost_nothing(bench: HierarchyObject) -> None:
    """Each disabled rectangle, wherever it is in the table, saves a group the cycles of one rectangle; with culling,
    those that were not already saved. With lists, frames take the time of the model."""
    harness = Harness(bench)
    bus, configuration, scene = harness.bus, harness.configuration, harness.scene
    kept = range(1, len(scene.rect), 3)
    few = scene.model_copy(update={"rect": tuple(scene.rect[index] for index in kept)})
    reflections = configuration.most_reflections

    await harness.reset()
    await harness.load(scene, reflections)
    await harness.expect(scene, reflections, "all rectangles")
    all_frame = await frame_cycles(harness, scene)
    all_cycles = await bus.read("cycles")
    check_cycles(all_cycles, configuration)
    is_full = len(scene.rect) == configuration.rectangles and not configuration.facts.whole_frames
    if is_full and not (configuration.culling or configuration.light):
        assert all_cycles["group"] == buffered_engine_of(configuration).group_cycles(configuration)
    await bus.write("cycles")
    assert await bus.read("cycles") == {"row": 0, "group": 0}, "a write clears the cycle counters"

    for index in range(len(scene.rect)):
        if index not in kept:
            await bus.write(f"rectangle[{index}].surface", enable=0, red=255)
    await harness.commit(reflections=reflections)
    await harness.expect(few, reflections, "every third rectangle")
    if configuration.facts.whole_frames:
        assert await frame_cycles(harness, few) < all_frame
        return
    few_cycles = await bus.read("cycles")
    saved = (
        (len(scene.rect) - len(few.rect))
        * (reflections + 1)
        * buffered_engine_of(configuration).rect_cycles(configuration)
    )
    fallen = all_cycles["group"] - few_cycles["group"]
    assert 0 <= fallen <= saved if configuration.culling else fallen == saved, (all_cycles, few_cycles)
    assert (few_cycles["row"] < all_cycles["row"]) == (saved > 0)


async def frame_cycles(harness: Harness, scene: Scene) -> int:
    """Return the cycles of the last frame, which must be those of the model; 0 without lists."""
    config = harness.configuration
    if not config.facts.whole_frames:
        return 0
    seen = (await harness.bus.read("frames.cycles"))["cycles"]
    expected = scene_cycles(scene, config, config.most_reflections)
    assert seen == expected, f"a frame took {seen} cycles, expected {expected}"
    return seen


@cocotb.test()
async def bad_rectangle(bench: HierarchyObject) -> None:
    """An enabled rectangle without a plane is reported when it is committed, and is not drawn."""
    harness = Harness(bench)
    bus, scene = harness.bus, harness.scene
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
    await harness.wait_for_frame()
    await harness.expect(scene, scene.reflections, "without the bad one")
    for cleared in (0, 1):
        await bus.write("status", bad_rectangle=cleared)
        assert (await bus.read("status"))["bad_rectangle"] == 1 - cleared, "only writing 1 clears it"


@cocotb.test()
async def run_and_reflections(bench: HierarchyObject) -> None:
    """The picture is black before the first commit and while run is 0; otherwise it has as many reflections as asked
    for, up to the limit of the hardware."""
    harness = Harness(bench)
    scene = harness.scene.model_copy(update={"background": (255, 255, 255)})
    black = np.zeros_like(harness.golden(scene, 0))
    await harness.reset()
    await harness.bus.load_scene(scene)
    harness.expect_picture(await harness.monitor.frame(), black, "nothing committed")
    for asked in range(4):
        await harness.commit(reflections=asked)
        await harness.expect(scene, min(asked, harness.configuration.most_reflections), f"{asked} reflections")
        if asked < 2:
            await harness.commit(run=0, reflections=asked)
            harness.expect_picture(await harness.monitor.frame(), black, "run = 0")


@cocotb.test()
async def start_screen_interrupts(bench: HierarchyObject) -> None:
    """The interrupt rises at StartScreen if enabled and falls when 1 is written. The traffic bench checks its clock."""
    harness = Harness(bench)
    bus = harness.bus
    await harness.reset()
    for enabled in (1, 0):
        await bus.write("irq_enable", start_screen=enabled)
        assert (await bus.read("irq_pending"))["start_screen"] == 0
        await harness.monitor.frame()
        assert (await bus.read("irq_pending"))["start_screen"] == 1, "pending is set whether or not it is enabled"
        assert harness.bench.irq.value == enabled
        for cleared in (0, 1):
            await bus.write("irq_pending", start_screen=cleared)
            assert (await bus.read("irq_pending"))["start_screen"] == 1 - cleared, "only writing 1 clears it"
            assert harness.bench.irq.value == (enabled and not cleared)
