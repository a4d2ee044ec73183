# SPDX-License-Identifier: MIT
"""cocotb: the scene changes in mid-frame, and only whole frames show the change."""

from __future__ import annotations

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.triggers import Event

from raycaster.sim.harness import Harness


@cocotb.test()
async def camera_moves_between_frames(bench: HierarchyObject) -> None:
    """A commit in mid-frame shows from the next frame on; writes after the commit do not show even there."""
    harness = Harness(bench)
    bus, monitor, scene, reflections = harness.bus, harness.monitor, harness.scene, harness.reflections
    x, y, z = scene.camera.position
    moved, moved_again = harness.seen_from((x ^ 21, y ^ 60, z ^ 14)), harness.seen_from((x ^ 40, y ^ 9, z ^ 33))
    pictures = [harness.golden(shown, reflections) for shown in (scene, moved, moved_again)]
    assert len({picture.tobytes() for picture in pictures}) == 3, "the scene looks the same from everywhere"

    await harness.reset()
    await harness.load(scene, reflections)
    assert (await bus.read("control"))["commit"] == 1, "commit must read 1 until StartScreen"
    middle = Event()
    middle_line = harness.screen.vertical.visible // 2
    frame = cocotb.start_soon(monitor.frame(lambda visible: middle.set() if visible == middle_line else None))
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
