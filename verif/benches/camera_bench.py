# SPDX-License-Identifier: MIT
"""cocotb: one scene from several cameras, a frame each; every pixel is compared with the golden model."""

from __future__ import annotations

import itertools

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject

from raycaster.configuration import WORLD_SIZE
from raycaster.sim.harness import Harness

CORNERS = list(itertools.product((0, WORLD_SIZE - 1), repeat=3))


@cocotb.test()
async def cameras(bench: HierarchyObject) -> None:
    """Pictures are right from the scene's own camera, every corner of the world, and a random place per seed."""
    harness = Harness(bench)
    bus, scene, reflections = harness.bus, harness.scene, harness.reflections
    places = [scene.camera.position, *CORNERS]
    places += [tuple(np.random.default_rng(seed).integers(WORLD_SIZE, size=3).tolist()) for seed in harness.job.seeds]
    await harness.reset()
    await bus.load_scene(scene)
    for number, place in enumerate(places):
        await bus.write_camera(place)
        await bus.commit(reflections=reflections)
        await harness.expect(harness.seen_from(place), reflections, f"camera {number} at {place}")
    assert not (await bus.read("status"))["underrun"], "a row was not complete in time"
