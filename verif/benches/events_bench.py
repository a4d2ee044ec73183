# SPDX-License-Identifier: MIT
"""cocotb: record the time in ns of every event of a frame that a bench can await, to compare main programs."""

from __future__ import annotations

import json
from pathlib import Path

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.simtime import get_sim_time
from cocotb.triggers import FallingEdge, NextTimeStep, ReadOnly, ReadWrite, RisingEdge, Timer

from raycaster.sim.harness import Harness

DELAYS_NS = 1, 4, 5, 7, 13, 20, 30, 40, 123
"""Delays that end at edges of the clock, or between them."""


@cocotb.test()
async def events(bench: HierarchyObject) -> None:
    """Check the first frame, and write `events.json` into the job's output directory."""
    harness = Harness(bench)
    seen: list[tuple[str, int, int]] = []

    def note(what: str, value: int) -> None:
        seen.append((what, int(get_sim_time("ns")), value))

    async def note_delays() -> None:
        while True:
            for delay in DELAYS_NS:
                await Timer(delay, "ns")
                note(f"{delay} ns", int(harness.bench.clk.value))

    async def note_phases() -> None:
        while True:
            for edge in (RisingEdge, FallingEdge):
                await edge(harness.bench.clk)
                note(edge.__name__, int(harness.bench.bus_clk.value))
                for phase in (ReadWrite, ReadOnly, NextTimeStep):
                    await phase()
                    note(phase.__name__, int(harness.bench.bus_clk.value))
            await harness.bench.sink.line_event.value_change
            note("line event", int(harness.bench.sink.line_samples.value))

    cocotb.start_soon(note_delays())
    cocotb.start_soon(note_phases())
    scene = harness.scene
    await harness.reset()
    note("reset", 0)
    await harness.load(scene, scene.reflections)
    note("scene", 0)
    frame = await harness.monitor.frame()
    note("frame", int(harness.bench.busy_cycles.value))
    seen += [("line", line.end_ns, line.samples) for line in harness.monitor.frame_lines]
    for name, value in (await harness.bus.read("cycles")).items():
        note(name, value)
    harness.expect_picture(frame, harness.golden(scene, scene.reflections), "frame")
    (Path(harness.job.output) / "events.json").write_text(json.dumps(seen))
