# SPDX-License-Identifier: MIT
"""cocotb: a design with a built-in scene: its registers, and its pictures from other cameras."""

from __future__ import annotations

import itertools

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject

from raycaster.configuration import WORLD_SIZE
from raycaster.sim.harness import Harness

EVERY_BIT = (1 << 32) - 1
CORNERS = list(itertools.product((0, WORLD_SIZE - 1), repeat=3))


@cocotb.test()
async def what_is_fixed_ignores_writes(bench: HierarchyObject) -> None:
    """Fixed state is reported as fixed and reads 0, and the picture never changes, whatever is written."""
    harness = Harness(bench)
    bus, config, scene, asked = harness.bus, harness.configuration, harness.scene, harness.reflections
    assert config.fixed is not None
    everything = config.fixed.camera is not None
    await harness.reset()
    assert (await bus.read("engine"))["fixed"] == (2 if everything else 1)
    assert (await bus.read("size"))["rectangles"] == 0
    assert not any(name.startswith("rectangle") for name in bus.registers)

    await harness.load(scene, asked)
    await harness.expect(scene, asked, "the scene")
    kept = 0 if everything else asked
    await bus.commit(reflections=kept)
    assert (await bus.read("control"))["reflections"] == kept
    mapped = {register.address: name for name, register in bus.registers.items()}
    for address in range(1 << bus.address_bits):
        if address not in mapped or (everything and mapped[address] in ("camera", "background")):
            await bus.write_word(address, EVERY_BIT)
            assert await bus.read_word(address) == 0, f"{address} is fixed or unmapped, and reads 0"
    await harness.monitor.frame()
    await harness.expect(scene, asked, "after writes to fixed registers")
    assert await bus.read("status") | {"busy": 0, "frame": 0} == {
        "busy": 0, "underrun": 0, "bad_rectangle": 0, "frame": 0,
    }  # fmt: skip


@cocotb.test()
async def cameras(bench: HierarchyObject) -> None:
    """Pictures are right from a place per seed, the first ones corners of the world, unless the camera is fixed."""
    harness = Harness(bench)
    bus, scene, reflections = harness.bus, harness.scene, harness.reflections
    assert harness.configuration.fixed is not None
    if harness.configuration.fixed.camera is not None:
        return
    await harness.reset()
    await bus.load_scene(scene)
    for seed in harness.job.seeds:
        anywhere = tuple(np.random.default_rng(seed).integers(WORLD_SIZE, size=3).tolist())
        place = CORNERS[seed] if seed < len(CORNERS) else anywhere
        await bus.write_camera(place)
        await bus.commit(reflections=reflections)
        await harness.expect(harness.seen_from(place), reflections, f"camera {seed} at {place}")
    assert not (await bus.read("status"))["underrun"], "a row was not complete in time"
