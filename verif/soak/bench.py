# SPDX-License-Identifier: MIT
"""cocotb: random, stiff or given scenes, a frame each; every pixel is compared with the golden model."""

from __future__ import annotations

import json
import os
from pathlib import Path

import cocotb
from cocotb.handle import HierarchyObject

from raycaster.golden.picture import count_wrong
from raycaster.scene import Scene, dump_scene, load_scene
from raycaster.sim.harness import Harness
from raycaster.verif.catalogue import catalogue
from raycaster.verif.random_scenes import random_scene


@cocotb.test()
async def soak(bench: HierarchyObject) -> None:
    """Show the scenes of the job's seeds; write a line of JSON for each, and failing scenes, whole and shrunk.

    If the job has scene files, separated as in PATH, seeds are indices into them.
    """
    harness = Harness(bench)
    job, configuration = harness.job, harness.configuration
    output = Path(job.output)
    await harness.reset()
    failed, cases = [], catalogue(configuration.features)
    with (output / "results.jsonl").open("w") as results:
        for seed in job.seeds:
            if job.stiff:
                scene = cases[seed].scene.model_copy(update={"reflections": configuration.most_reflections})
            elif job.scene:
                scene = load_scene(job.scene.split(os.pathsep)[seed], configuration.capacity)
            else:
                scene = random_scene(
                    seed, configuration.rectangles, configuration.most_reflections, configuration.features
                )
            result = {"seed": seed, "title": scene.title} | await show(harness, scene)
            if result["wrong_vs_golden"]:
                failed.append(seed)
                (output / f"{seed}.toml").write_text(dump_scene(scene))
                (output / f"{seed}-shrunk.toml").write_text(dump_scene(await shrink(harness, scene)))
            results.write(json.dumps(result) + "\n")
            results.flush()
    status = await harness.bus.read("status")
    assert not status["underrun"], "a row was not complete in time"
    assert not failed, f"wrong pixels in the scenes of seeds {failed}"


async def show(harness: Harness, scene: Scene) -> dict[str, int]:
    """Show one frame of a scene, right after the previous frame, and count its wrong pixels."""
    await harness.load(scene, scene.reflections)
    frame = await harness.monitor.frame()
    golden, perfect = harness.golden_and_exact(scene, scene.reflections)
    return {
        "reflections": scene.reflections,
        "pixels": frame[..., 0].size,
        "wrong_vs_golden": count_wrong(frame, golden),
        "wrong_vs_exact": count_wrong(frame, perfect),
    }


async def shrink(harness: Harness, scene: Scene) -> Scene:
    """Remove rectangles, one by one, while pixels are still wrong."""
    index = 0
    while index < len(scene.rect) and len(scene.rect) > 1:
        fewer = scene.model_copy(update={"rect": scene.rect[:index] + scene.rect[index + 1 :]})
        if (await show(harness, fewer))["wrong_vs_golden"]:
            scene = fewer
        else:
            index += 1
    return scene
