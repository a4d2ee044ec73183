# SPDX-License-Identifier: MIT
"""cocotb: artificial scenes, for points that other benches leave uncovered."""

from __future__ import annotations

from itertools import pairwise

import cocotb
from cocotb.handle import HierarchyObject

from raycaster.configuration import CHANNEL_BITS, WORLD_SIZE
from raycaster.scene import Camera, Light, Rectangle, Scene
from raycaster.sim.harness import Harness
from raycaster.sim.register_model import Agent
from raycaster.verif.random_scenes import random_scene

LIT_SCENES, LIT_RECTANGLES = 12, 6
"""Number of random scenes with a light, with few enough rectangles for the row budget."""


@cocotb.test()
async def every_bit_of_the_live_scene(bench: HierarchyObject) -> None:
    """All coordinates and colours are at their maximum for one frame, then 0 for one frame."""
    harness = Harness(bench)
    await harness.reset()
    for high in (True, False):
        place, channel = (WORLD_SIZE - 1, (1 << CHANNEL_BITS) - 1) if high else (0, 0)
        point, colour = (place, place, place), (channel, channel, channel)
        lit = high and harness.configuration.light
        scene = Scene(
            background=colour,
            camera=Camera(position=point),
            light=Light(position=point, shade=0.75) if lit else None,
            rect=(Rectangle(corners=(point, point), colour=colour),) * harness.configuration.rectangles,
        )
        # No reflections: with this many rectangles, they need not meet the row budget.
        await harness.bus.load_scene(scene)
        await harness.bus.commit(reflections=0)
        golden = harness.golden(scene, 0)
        harness.expect_picture(await harness.monitor.frame(), golden, "all ones" if high else "all zeros")


@cocotb.test()
async def every_constant(bench: HierarchyObject) -> None:
    """The registers that describe the design read as its configuration says."""
    harness = Harness(bench)
    await harness.reset()
    agent = Agent(harness.configuration)
    for name in ("id", "version", "engine", "size"):
        address = agent.registers[name].address
        agent.bus["bus_address"] = address
        assert await harness.bus.read_word(address) == agent.read({}), name


@cocotb.test()
async def every_axis_in_every_entry(bench: HierarchyObject) -> None:
    """The planes of all rectangles are on one axis, a different one in each frame."""
    harness = Harness(bench)
    await harness.reset()
    for axis in (1, 2, 0):
        corners = [[100, 100, 100], [400, 400, 400]]
        corners[1][axis] = corners[0][axis]
        rectangle = Rectangle.model_validate({"corners": corners, "colour": (200, 100, 50)})
        scene = Scene(
            # At distances with the lowest bits of 0, -101 and 80.
            camera=Camera(position=(20, 256, 201)),
            rect=(rectangle,) * harness.configuration.rectangles,
        )
        await harness.bus.load_scene(scene)
        await harness.bus.commit(reflections=0)
        harness.expect_picture(await harness.monitor.frame(), harness.golden(scene, 0), f"along {'xyz'[axis]}")


@cocotb.test()
async def every_bit_of_every_distance(bench: HierarchyObject) -> None:
    """Each bit of the camera's distances from a plane and from its bounds rises and falls between frames."""
    harness = Harness(bench)
    await harness.reset()
    # Alternating bits: 0010101010, its complement, and 1010101010, which differs from the first in its sign only.
    up, down, far_down = 0b0010101010, ~0b0010101010, ~0b0101010101
    near, below, above = (200, down, up, up), (400, far_down, down, far_down), (20, up, ~far_down, ~far_down)
    for eye, low, high, plane in (near, below, near, above, near):
        corners = [[eye + bound, eye + plane, eye + bound] for bound in (low, high)]
        rectangle = Rectangle.model_validate({"corners": corners, "colour": (200, 100, 50)})
        scene = Scene(
            camera=Camera(position=(eye, eye, eye)),
            rect=(rectangle,) * harness.configuration.rectangles,
        )
        await harness.bus.load_scene(scene)
        await harness.bus.commit(reflections=0)
        harness.expect_picture(await harness.monitor.frame(), harness.golden(scene, 0), f"from {eye}")


@cocotb.test()
async def three_copies_of_every_entry(bench: HierarchyObject) -> None:
    """In each frame, one table is live, the next is pending, and the one after that is being written."""
    harness = Harness(bench)
    await harness.reset()
    rectangles = harness.configuration.rectangles
    scenes = [
        Scene(
            camera=Camera(position=(20, 256, 200)),
            rect=(Rectangle(corners=((300, 100, 100), (300, 400, 400)), colour=colour),) * rectangles,
        )
        for colour in ((250, 0, 0), (0, 250, 0), (0, 0, 250), (250, 250, 0), (0, 250, 250))
    ]
    await harness.bus.load_scene(scenes[0])
    for number, (shown, following) in enumerate(pairwise(scenes)):
        await harness.bus.commit(reflections=0)
        await harness.bus.load_scene(following)
        harness.expect_picture(await harness.monitor.frame(), harness.golden(shown, 0), f"table {number}")


@cocotb.test()
async def random_lights(bench: HierarchyObject) -> None:
    """Random scenes with a light, a frame each, if the design has one."""
    harness = Harness(bench)
    configuration = harness.configuration
    await harness.reset()
    for seed in range(LIT_SCENES if configuration.light else 0):
        scene = random_scene(seed, LIT_RECTANGLES, configuration.reflections, configuration.looks)
        await harness.bus.load_scene(scene)
        await harness.bus.commit(reflections=scene.reflections)
        golden = harness.golden(scene, scene.reflections)
        harness.expect_picture(await harness.monitor.frame(), golden, f"seed {seed}")
