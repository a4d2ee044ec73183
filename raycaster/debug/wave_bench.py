# SPDX-License-Identifier: MIT
"""cocotb bench: show one scene until the bench has written its window of the frame."""

from __future__ import annotations

from typing import Any

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.triggers import RisingEdge

from raycaster.scene import load_scene
from raycaster.sim.harness import Harness


@cocotb.test()
async def one_window(bench: HierarchyObject) -> None:
    """Program the job's scene as the frame bench does, and end with the window; pixels are not checked."""
    harness = Harness(bench)
    job, configuration = harness.job, harness.configuration
    scene = load_scene(job.scene, configuration.capacity)
    await harness.reset()
    await harness.bus.load_scene(scene)
    await harness.bus.commit(reflections=scene.reflections if job.reflections is None else job.reflections)
    window: Any = bench.window
    window.armed.value = 1
    await RisingEdge(window.closed)
