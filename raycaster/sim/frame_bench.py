# SPDX-License-Identifier: MIT
"""cocotb bench: show one scene, and compare every pixel of the frame with the golden and the exact picture."""

from __future__ import annotations

import json
import time
from pathlib import Path

import cocotb
from cocotb.handle import HierarchyObject
from PIL import Image

from raycaster.golden.frames import scene_cycles
from raycaster.golden.picture import count_wrong, diff_picture, first_wrong
from raycaster.sim.harness import Harness
from raycaster.sim.monitor import VideoError

SYNC = "sync.png"
"""Picture of a frame with its blanking, if that departs from the video standard."""


def explained(error: VideoError, output: Path) -> str:
    """Write the picture of a frame that departs from the video standard, if there is one; say where to look."""
    where = "the signals come from the module video_generator"
    if error.picture is None:
        return where
    Image.fromarray(error.picture).save(output / SYNC)
    return f"{output / SYNC} shows them in pink; {where}"


@cocotb.test()
async def one_frame(bench: HierarchyObject) -> None:
    """Program the job's scene, capture a frame, write pictures and `result.json` to the job's output directory."""
    harness = Harness(bench)
    job, bus, scene, reflections = harness.job, harness.bus, harness.scene, harness.reflections

    started = time.perf_counter()
    await harness.reset()
    await harness.load(scene, reflections)
    try:
        frame = await harness.monitor.frame(on_row=harness.write_progress)
    except VideoError as error:
        raise VideoError(f"{error}; {explained(error, Path(job.output))}") from None
    frame_cycles = int(harness.bench.busy_cycles.value)
    cycles = await bus.read("cycles")
    status = await bus.read("status")
    if harness.configuration.facts.whole_frames:
        cycles = dict.fromkeys(cycles, 0)
        frame_cycles = (await bus.read("frames.cycles"))["cycles"]
    seconds = time.perf_counter() - started
    harness.monitor.check_pins()

    golden, perfect = harness.golden_and_exact(scene, reflections)
    output = Path(job.output)
    pictures = {"frame": frame, "golden": golden, "exact": perfect, "diff": diff_picture(frame, golden)}
    for name, picture in pictures.items():
        Image.fromarray(picture).save(output / f"{name}.png")
    doubling = harness.screen.doubling
    place = first_wrong(frame, golden)
    result = {
        "configuration": harness.configuration.name,
        "reflections": reflections,
        "pixels": golden[..., 0].size,
        "wrong_vs_golden": count_wrong(frame, golden),
        "first_wrong_ray": [coordinate // doubling for coordinate in place] if place else None,
        "wrong_vs_exact": count_wrong(frame, perfect),
        "frame_cycles": frame_cycles,
        "worst_row_cycles": cycles["row"],
        "worst_group_cycles": cycles["group"],
        "underrun": bool(status["underrun"]),
        "sim_seconds": round(seconds, 3),
    }
    (output / "result.json").write_text(json.dumps(result, indent=2) + "\n")
    harness.expect_picture(frame, golden, "frame")
    if harness.configuration.facts.whole_frames:
        expected = scene_cycles(scene, harness.configuration, reflections)
        assert frame_cycles == expected, f"the frame took {frame_cycles} cycles, and {expected} in golden/frames.py"
    assert not status["bad_rectangle"], "the scene's rectangles were reported as bad"
