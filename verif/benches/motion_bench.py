# SPDX-License-Identifier: MIT
"""cocotb: the scene changes in mid-frame, and only whole frames show the change."""

from __future__ import annotations

from collections.abc import Callable

import cocotb
from cocotb.handle import HierarchyObject, LogicObject
from cocotb.simtime import get_sim_time
from cocotb.triggers import ClockCycles, Event, RisingEdge

from raycaster.scene import Scene, load_scene
from raycaster.sim.harness import Harness
from raycaster.sim.monitor import CLOCK_NS

START_SCREEN_TOLERANCE = 8
"""Clocks by which pipeline registers may separate the interrupt from the video output."""


@cocotb.test()
async def camera_moves_between_frames(bench: HierarchyObject) -> None:
    """A commit in mid-frame shows from the next frame on; writes after the commit do not show even there."""
    harness = Harness(bench)
    bus, monitor = harness.bus, harness.monitor
    scene, reflections = _scene(harness)
    x, y, z = scene.camera.position
    moved, moved_again = _seen_from(scene, (x ^ 21, y ^ 60, z ^ 14)), _seen_from(scene, (x ^ 40, y ^ 9, z ^ 33))
    pictures = [harness.golden(shown, reflections) for shown in (scene, moved, moved_again)]
    assert len({picture.tobytes() for picture in pictures}) == 3, (
        "a scene that looks the same from everywhere is no test"
    )

    await harness.reset()
    await bus.load_scene(scene)
    await bus.commit(reflections=reflections)
    assert (await bus.read("control"))["commit"] == 1, "commit must read 1 until StartScreen"
    middle = Event()
    frame = cocotb.start_soon(monitor.frame(_setter(middle, harness.screen.vertical.visible // 2)))
    await middle.wait()
    assert (await bus.read("control"))["commit"] == 0, "commit must read 0 after StartScreen"
    frames_before = (await bus.read("status"))["frame"]

    await bus.write_camera(moved.camera.position)
    await bus.commit(reflections=reflections)
    await bus.write_camera(moved_again.camera.position)
    x, y, z = moved_again.camera.position
    assert await bus.read("camera") == {"x": x, "y": y, "z": z}, "reads return the shadow"
    harness.expect_picture(await frame, pictures[0], "frame 1, during which the camera was moved")
    assert (await bus.read("control"))["commit"] == 1

    harness.expect_picture(await monitor.frame(), pictures[1], "frame 2, the first after the move")
    assert (await bus.read("control"))["commit"] == 0
    assert (await bus.read("status"))["frame"] == frames_before + 1
    monitor.check_pins()


@cocotb.test()
async def one_write_and_a_commit(bench: HierarchyObject) -> None:
    """The shadow keeps its contents: to change one register, write it and commit."""
    harness = Harness(bench)
    bus = harness.bus
    scene, reflections = _scene(harness)
    await harness.reset()
    await bus.load_scene(scene)
    await bus.commit(reflections=reflections)
    harness.expect_picture(await harness.monitor.frame(), harness.golden(scene, reflections), "the scene")
    first = scene.rect[0].model_copy(update={"colour": (1, 254, 129)})
    painted = scene.model_copy(update={"rect": (first, *scene.rect[1:])})
    await bus.write("rectangle[0].surface", enable=1, red=1, green=254, blue=129)
    await bus.commit(reflections=reflections)
    harness.expect_picture(await harness.monitor.frame(), harness.golden(painted, reflections), "one colour changed")


@cocotb.test()
async def start_screen_interrupts(bench: HierarchyObject) -> None:
    """The interrupt is a level that rises at StartScreen, at its place in the frame, and falls when 1 is written."""
    harness = Harness(bench)
    bus, monitor, screen = harness.bus, harness.monitor, harness.screen
    await harness.reset()
    await bus.write("irq_enable", start_screen=1)
    assert harness.bench.irq.value == 0, "irq before the first StartScreen"

    first_line = Event()
    frame = cocotb.start_soon(monitor.frame(_setter(first_line, 1)))
    await first_line.wait()
    assert harness.bench.irq.value == 1, "StartScreen raises irq"
    assert (await bus.read("irq_pending"))["start_screen"] == 1
    await bus.write("irq_pending", start_screen=0)
    await ClockCycles(harness.bench.clk, 2)
    assert harness.bench.irq.value == 1, "writing 0 must not clear a pending interrupt"
    await bus.write("irq_pending", start_screen=1)
    assert (await bus.read("irq_pending"))["start_screen"] == 0
    assert harness.bench.irq.value == 0, "writing 1 clears irq"
    raised = cocotb.start_soon(_rise_ns(harness.bench.irq))
    await frame
    assert not raised.done(), "irq before the second StartScreen"

    await monitor.frame()
    line_ns = screen.line_cycles * CLOCK_NS
    first_visible_hs_ns = monitor.frame_lines[screen.vertical.sync + screen.vertical.back - 1].end_ns
    first_visible_ns = first_visible_hs_ns - screen.beats.front * screen.clocks_per_pixel * CLOCK_NS
    late = (await raised - first_visible_ns + screen.doubling * line_ns) / CLOCK_NS
    assert abs(late) <= START_SCREEN_TOLERANCE, f"StartScreen came {late} clocks late"

    await bus.write("irq_enable", start_screen=0)
    await ClockCycles(harness.bench.clk, 2)
    assert harness.bench.irq.value == 0, "irq is not enabled"
    assert (await bus.read("irq_pending"))["start_screen"] == 1, "pending is set whether or not it is enabled"


def _scene(harness: Harness) -> tuple[Scene, int]:
    scene = load_scene(harness.job.scene, harness.configuration.capacity)
    return scene, harness.job.reflections_of(scene)


def _seen_from(scene: Scene, position: tuple[int, int, int]) -> Scene:
    return scene.model_copy(update={"camera": scene.camera.model_copy(update={"position": position})})


def _setter(event: Event, at_line: int) -> Callable[[int], None]:
    def on_row(visible: int) -> None:
        if visible == at_line:
            event.set()

    return on_row


async def _rise_ns(signal: LogicObject) -> float:
    await RisingEdge(signal)
    return get_sim_time("ns")
