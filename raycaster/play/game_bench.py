# SPDX-License-Identifier: MIT
"""cocotb bench: a system with a processor runs a program; every pixel of every frame is compared with the golden model.

The golden model draws the scene that the program committed: the bench follows the ray tracer's accepted writes.
"""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles
from PIL import Image

from raycaster.golden.picture import count_wrong
from raycaster.sim.harness import RESET_CLOCKS, Viewer
from raycaster.sim.register_model import SceneFollower


class Tap:
    """Records the system's other outputs: text on the serial port, and scenes on the ray tracer's bus."""

    def __init__(self, viewer: Viewer):
        self.text = Path(viewer.job.output) / "uart.txt"
        """File of the text that was sent so far."""
        self.text.write_bytes(b"")
        self.scenes = SceneFollower(viewer.configuration)
        self.writes = 0
        """Number of writes that the ray tracer accepted."""
        self.again = 0
        """Number of pictures that were shown again, as the next frame was late."""
        self._bench = viewer.bench
        cocotb.start_soon(self._receive())
        cocotb.start_soon(self._follow())

    async def _receive(self) -> None:
        with self.text.open("ab", buffering=0) as file:
            while True:
                await self._bench.uart_event.value_change
                file.write(bytes([int(self._bench.uart_byte.value)]))

    async def _follow(self) -> None:
        bench = self._bench
        while True:
            await bench.bus_event.value_change
            clock = int(bench.bus_clock.value)
            # A write in StartScreen's clock is too late for it.
            if int(bench.bus_start_screen.value):
                takes, again = (bool(int(one.value)) for one in (bench.bus_takes_scene, bench.bus_again))
                self.scenes.start_screen(clock, takes=takes, again=again)
                self.again += again
            if int(bench.bus_write.value):
                self.writes += 1
                self.scenes.write(
                    clock, int(bench.bus_address.value), int(bench.bus_writedata.value), int(bench.bus_byteenable.value)
                )


@cocotb.test()
async def play(bench: Any) -> None:
    """Show a frame for each of the job's buttons; write the pictures, `uart.txt` and `result.json` to its output."""
    viewer = Viewer(bench)
    job, output = viewer.job, Path(viewer.job.output)
    bench.buttons.value = job.buttons[0]
    await ClockCycles(bench.clk, RESET_CLOCKS)
    viewer.monitor.forget()
    tap = Tap(viewer)
    bench.ready.value = 1

    # CPU time of this process, as the machine may be busy with others.
    started, golden_seconds = time.process_time(), 0.0
    shown, pixels, wrong, complaints = 0, 0, 0, []
    for number in range(len(job.buttons)):
        frame = await viewer.monitor.frame()
        # The next frame's vertical sync has just begun, and its StartScreen is still to come.
        if number + 1 < len(job.buttons):
            bench.buttons.value = job.buttons[number + 1]
        before = time.process_time()
        Image.fromarray(frame).save(output / f"frame_{number:04}.png")
        scene = tap.scenes.shown
        expected = viewer.golden_live(scene)
        pixels += expected[..., 0].size
        wrong += count_wrong(frame, expected)
        try:
            viewer.expect_picture(frame, expected, f"frame {number}")
        except AssertionError as complaint:  # later frames count too
            complaints.append(complaint)
        shown += scene is not None and scene.run
        golden_seconds += time.process_time() - before
        assert not int(bench.halted.value), f"frame {number}: the processor halted; it sent {tap.text.read_bytes()!r}"
    seconds = time.process_time() - started

    frames = len(job.buttons)
    clocks = frames * viewer.screen.frame_cycles
    result = {
        "configuration": viewer.configuration.name,
        "frames": frames,
        "shown": shown,
        "again": tap.again,
        "pixels": pixels,
        "wrong": wrong,
        "writes": tap.writes,
        "clocks": clocks,
        "seconds": round(seconds, 3),
        "golden_seconds": round(golden_seconds, 3),
        "clocks_a_second": round(clocks / (seconds - golden_seconds)),
    }
    (output / "result.json").write_text(json.dumps(result, indent=2) + "\n")
    if complaints:
        raise complaints[0]
    viewer.monitor.check_pins()
    assert not int(bench.underruns.value), "a row was not complete in time"
    assert not int(bench.uart_faults.value), "a start or stop bit on the serial port is wrong"
