# SPDX-License-Identifier: MIT
"""cocotb: a design with lists that draws a moving scene more slowly than the monitor is refreshed.

Every picture must be a whole earlier frame: the one that the model of a frame's time says. So must the registers
`frames`. A frame with more runs than a list has entries is never shown.
"""

from __future__ import annotations

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.simtime import get_sim_time

from raycaster.golden.frames import cycles_of, runs_of, scene_rows
from raycaster.program import scene_fields
from raycaster.scene import Scene
from raycaster.sim.harness import Harness
from raycaster.sim.monitor import CLOCK_NS
from raycaster.sim.register_model import FrameCounts, RegisterFile, Switch

FRAMES, MOST_REFRESHES = 3, 40
"""Frames that must be shown, and refreshes within which they must."""

STEP = 5
"""World units that the camera moves per refresh."""

READING = 100
"""Cycles within which all registers of frames are read."""


class Timeline:
    """What a design must show at each refresh, and what its registers must say: from the times of its frames."""

    def __init__(self, harness: Harness):
        self.counts, self.switch = FrameCounts(), Switch()
        self.start_cycle = RegisterFile(harness.configuration).start_screen_clock
        """Cycle of the next StartScreen, counted from the end of reset."""
        self._harness, self._whole = harness, 0

    def go_to(self, cycle: int) -> None:
        """End the frame that is drawn, if it is whole before a cycle."""
        if self.switch.state == "draw" and self._whole < cycle:
            self._clock(self._whole, start_screen=False, whole=True)

    def start_screen(self, pending: Scene | None) -> bool:
        """Pass the next StartScreen, with a committed scene, or none so far; return True if it goes live."""
        cycle, harness = self.start_cycle, self._harness
        self.start_cycle += harness.screen.frame_cycles
        self.go_to(cycle)
        takes = self.switch.state == "wait"
        self._clock(cycle, start_screen=True)
        if takes:
            self._clock(cycle + 1, run=pending is not None, frame=pending)
        if takes and pending is not None:
            config = harness.configuration
            self._whole = cycle + cycles_of(scene_rows(pending, config, config.most_reflections), config)
        return takes

    def is_quiet(self, cycle: int) -> bool:
        """Return True if no frame becomes whole while registers are read from a cycle on."""
        return self.switch.state != "draw" or abs(self._whole - cycle) > READING

    def _clock(
        self, cycle: int, *, start_screen: bool = False, run: bool = False, frame: Scene | None = None,
        whole: bool = False,
    ) -> None:  # fmt: skip
        self.counts.clock(self.switch.events(start_screen, whole, False, cycle), "", 0, 0)
        self.switch.clock(start_screen, run, frame, whole, False, cycle)


def fits(harness: Harness) -> bool:
    """Return True if a list holds the job's scene."""
    config = harness.configuration
    return runs_of(scene_rows(harness.scene, config, config.most_reflections)) <= config.list


@cocotb.test()
async def late_frames(bench: HierarchyObject) -> None:
    """Move the camera of a scene that fits a list whenever a commit went live; compare every picture and counter."""
    harness = Harness(bench)
    bus, config, reflections = harness.bus, harness.configuration, harness.configuration.most_reflections
    if not fits(harness):
        return
    scene, pending, writes = harness.scene, None, True
    x, y, z = scene.camera.position
    await harness.reset()
    released_ns = get_sim_time("ns")
    timeline, shown, quiet = Timeline(harness), [], 0
    for number in range(MOST_REFRESHES):
        if writes:
            camera = scene.camera.model_copy(update={"position": (x, y + STEP * number, z)})
            pending = scene.model_copy(update={"camera": camera})
            for name, fields in scene_fields(pending, config):
                if number == 0 or name == "camera":
                    await bus.write(name, **fields)
            await bus.commit(reflections=reflections)
        cycle = int(get_sim_time("ns") - released_ns) // CLOCK_NS
        assert number or cycle + READING < timeline.start_cycle, "the first StartScreen comes too early"
        takes = timeline.start_screen(pending)
        seen = await harness.monitor.frame()
        frame = timeline.switch.shown
        what = f"refresh {number}, which shows frame {len(set(shown))}"
        black = harness.golden_live(None)
        harness.expect_picture(seen, black if frame is None else harness.golden(frame, reflections), what)
        shown.append(frame and frame.camera.position)
        cycle = int(get_sim_time("ns") - released_ns) // CLOCK_NS
        timeline.go_to(cycle)
        if timeline.is_quiet(cycle):
            for name, fields in timeline.counts.fields().items():
                assert (read := await bus.read(name)) == fields, f"{name}: {read}, expected {fields}, {what}"
            quiet += 1
        writes = takes
        if len(set(shown)) > FRAMES:  # the first one is black
            break
        assert (commit := (await bus.read("control"))["commit"]) == (not takes), f"commit reads {commit}, {what}"
    assert len(set(shown)) > FRAMES, f"less than {FRAMES} frames were shown"
    assert quiet > len(shown) // 2
    assert timeline.counts.late and timeline.counts.again > 2, "no frame was late"
    await bus.write("frames.status", late=1)
    await bus.write("frames.left")
    assert (await bus.read("frames.status"))["late"] == 0
    harness.monitor.check_pins()


@cocotb.test()
async def full_list(bench: HierarchyObject) -> None:
    """Commit a scene that does not fit a list: it leaves the picture as it was."""
    harness = Harness(bench)
    bus, reflections = harness.bus, harness.configuration.most_reflections
    heavy = harness.scene
    if fits(harness):
        return
    few = heavy.model_copy(update={"rect": heavy.rect[:1]})
    await harness.reset()
    for _ in range(2):
        await harness.load(few, reflections)
        await harness.expect(few, reflections, "the scene with few runs")
        assert (await bus.read("frames.status"))["list_full"] == 0
        drawn = (await bus.read("frames.counts"))["drawn"]
        await harness.load(heavy, reflections)
        for _ in range(3):
            await harness.expect(few, reflections, "the scene before one with too many runs")
        assert (await bus.read("frames.status"))["list_full"] == 1
        assert (await bus.read("frames.counts"))["drawn"] - drawn <= 1, "a frame with too many runs counts as drawn"
        await harness.load(few, reflections)
        await bus.write("frames.status", list_full=1)
