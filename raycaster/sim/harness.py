# SPDX-License-Identifier: MIT
"""Common start of every cocotb bench: its job, the design's reset, the bus and the monitor."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from cocotb.handle import HierarchyObject
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from raycaster.buses import BUSES
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import describe_difference, shown
from raycaster.scene import Scene, load_scene
from raycaster.sim.buses import DRIVERS
from raycaster.sim.job import Job
from raycaster.sim.monitor import CLOCK_NS, Monitor
from raycaster.sim.register_model import LiveScene

PROGRESS_LINES = 16
"""Lines between progress reports: opening a file takes longer than simulating a line."""

RESET_CLOCKS = 4
RESET_TOLERANCE = 8
"""Clocks that registers on the way to the video output may add after the end of reset."""


class Viewer:
    """A monitor that watches a bench, and the pictures that it must show."""

    def __init__(self, bench: HierarchyObject):
        self.bench: Any = bench
        self.job = Job.from_environment()
        self.configuration = self.job.configuration
        self.screen = self.configuration.screen_geometry
        self.model = model_of(self.configuration)
        self.monitor = Monitor(bench, self.configuration)

    @cached_property
    def scene(self) -> Scene:
        """The job's scene."""
        return load_scene(self.job.scene, self.configuration.capacity)

    @property
    def reflections(self) -> int:
        """Number of reflections to show the job's scene with."""
        return self.job.reflections_of(self.scene)

    def shown(self, picture: np.ndarray) -> np.ndarray:
        """Convert a golden picture to what the monitor must show; see `raycaster.golden.picture.shown`."""
        return shown(picture, self.configuration)

    def golden(self, scene: Scene, reflections: int) -> np.ndarray:
        """Draw the screen that this design must show for a scene; uint8, visible lines x visible pixels x 3."""
        return self.shown(self.model.render(scene, self.screen, reflections))

    def golden_and_exact(self, scene: Scene, reflections: int) -> tuple[np.ndarray, np.ndarray]:
        """Draw a scene's golden and exact screens; for an engine without quotients they are the same."""
        golden = self.golden(scene, reflections)
        if not self.configuration.facts.divides:
            return golden, golden
        return golden, self.shown(ExactModel().render(scene, self.screen, reflections))

    def golden_live(self, scene: LiveScene | None) -> np.ndarray:
        """Draw the golden screen of the live registers; black if stopped, or before the first StartScreen."""
        if scene is None or not scene.run:
            return self.shown(np.zeros((self.screen.rows, self.screen.columns, 3), dtype=np.uint8))
        return self.shown(scene.picture(self.model, self.screen))

    def expect_picture(self, seen: np.ndarray, expected: np.ndarray, what: str) -> None:
        """Check every visible pixel.

        Raises:
            AssertionError: pixels differ; says how many, and the first one.
        """
        if difference := describe_difference(seen, expected):
            raise AssertionError(f"{what}: {difference}")

    async def expect(self, scene: Scene, reflections: int, what: str) -> None:
        """Wait for the next frame, and check every pixel of the scene that it must show."""
        self.expect_picture(await self.monitor.frame(), self.golden(scene, reflections), what)


class Harness(Viewer):
    """The bench with a bus to program the design and a monitor that watches it."""

    def __init__(self, bench: HierarchyObject):
        super().__init__(bench)
        self.bus = DRIVERS[self.configuration.bus](bench, self.configuration)

    async def load(self, scene: Scene, reflections: int) -> None:
        """Write a scene and commit it."""
        await self.bus.load_scene(scene)
        await self.commit(reflections=reflections)

    async def commit(self, *, run: int = 1, reflections: int) -> None:
        """Commit what was written, so that the next frame shows it."""
        await self.bus.commit(run=run, reflections=reflections)
        await self.wait_for_frame()

    async def wait_for_frame(self) -> None:
        """With lists, wait until the frame of the committed scene is whole, so that the next StartScreen shows it.

        On a serial bus, which takes longer than a frame, wait until the committed scene is live.
        """
        whole_frames = self.configuration.facts.whole_frames
        if not whole_frames and not BUSES[self.configuration.bus].serial:
            return
        while (await self.bus.read("control"))["commit"] or (whole_frames and (await self.bus.read("status"))["busy"]):
            self.monitor.rest()
            await Timer(self.screen.line_cycles * CLOCK_NS, "ns")
        self.monitor.forget()

    async def reset(self) -> None:
        """Reset the design; returns at the first clock edge at which reset is low."""
        self.bench.reset.value = 1
        for _ in range(RESET_CLOCKS):
            await RisingEdge(self.bench.clk)
        await FallingEdge(self.bench.clk)
        self.bench.reset.value = 0
        self.monitor.forget()
        await RisingEdge(self.bench.clk)

    async def frame_after_reset(self, released_ns: float, on_row: Callable[[int], None] | None = None) -> np.ndarray:
        """Return the first frame after a reset, which restarts the video at the start of the vertical front porch.

        Args:
            released_ns: the time at which reset ended.
            on_row: see `Monitor.frame`.

        Returns:
            Its visible part; see `Monitor.frame`.

        Raises:
            AssertionError: HS or VS came too early or too late.
        """
        vertical = self.screen.vertical
        line_ns = self.screen.line_cycles * CLOCK_NS
        porch_end = await self.monitor.line()
        late = (porch_end.end_ns - released_ns) // CLOCK_NS - self.screen.beats.front * self.screen.clocks_per_pixel
        assert 0 <= late <= RESET_TOLERANCE, f"HS's leading edge came {late} clocks after the front porch since reset"
        frame = await self.monitor.frame(on_row)
        lines = (self.monitor.frame_lines[0].end_ns - line_ns - porch_end.end_ns) / line_ns
        assert lines == vertical.front, f"VS's leading edge came {lines} lines after HS's first"
        return frame

    def write_progress(self, visible_lines: int) -> None:
        """Report the number of visible lines so far to the parent now and then, if it asked."""
        if self.job.progress and visible_lines % PROGRESS_LINES == 0:
            Path(self.job.progress).write_text(str(visible_lines))
