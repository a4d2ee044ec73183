# SPDX-License-Identifier: MIT
"""Frames of the whole design: every visible pixel is compared with the golden model."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from conftest import SMALL_SCENE, Bench
from PIL import Image

from raycaster.configuration import FEATURES, Configuration
from raycaster.design.decide import configure
from raycaster.design.for_scene import design_for, packaged_for
from raycaster.fit.fixing import fix
from raycaster.golden.exact import ExactModel
from raycaster.rtl.engines import ENGINES
from raycaster.scene import load_scene, packaged_scenes
from raycaster.sim.simulator import UNGATED_FLAGS
from raycaster.verif.seeds import seed

PLAIN = packaged_scenes(plain=True)
EVERY_LOOK = dict.fromkeys(FEATURES, True)


def drawn(bench: Bench, design: Configuration, scene: Path) -> tuple[dict, Path]:
    """Draw a scene without a wrong or a late pixel; return the result, and the directory with it.

    All clocks run all the time, as on an FPGA; in most other simulations with Verilator they rest.
    """
    directory = bench("sim.frame_bench", design, "verilator", scene, flags=UNGATED_FLAGS)
    result = json.loads((directory / "result.json").read_text())
    size = design.screen_geometry.horizontal.visible * design.screen_geometry.vertical.visible
    assert (result["pixels"], result["wrong_vs_golden"], result["underrun"]) == (size, 0, False), scene.stem
    return result, directory


FULL_SIZE = {
    **{name: ("seed", path, None) for name, path in PLAIN.items()},
    "exact": ("exact", PLAIN["mirror_room"], None),
    "looks": ("exact", packaged_scenes()["evening"], None),
    "fixed": ("exact", packaged_scenes()["evening"], "all"),
}
"""Engine, scene, and what of the scene is built in."""


@pytest.mark.slow_sets(quick=["exact"])
@pytest.mark.parametrize("case", FULL_SIZE)
def test_full_size(bench: Bench, case):
    """Every scene that the default design can draw, and some in the exact engine, as `make sim` shows them."""
    engine, scene, scope = FULL_SIZE[case]
    options = {"engine": engine}
    made = fix(scene, options, scope).design if scope else design_for(scene, options)
    design = made.configuration
    result, _ = drawn(bench, design, scene)
    assert result["pixels"] == 640 * 2 * made.scene.rows
    assert result["worst_group_cycles"] <= design.group_budget
    assert result["worst_row_cycles"] < design.screen_geometry.row_cycles


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_hundred_scenes(bench: Bench, engine):
    """Random scenes with all looks; all clocks run all the time, as on an FPGA."""
    first, looks = 100 * seed(), dict.fromkeys(ENGINES[engine].facts.features, True)
    design = configure(engine=engine, screen="tiny", reflections=2, **looks)
    bench("verif.soak.bench", design, "verilator", seeds=tuple(range(first, first + 100)), flags=UNGATED_FLAGS)


@pytest.mark.slow_sets("exact", "seed")
@pytest.mark.parametrize("engine", ENGINES)
def test_every_scene(bench: Bench, engine):
    """Every packaged scene on the tiny screen, edge cases included, drawn by one design per engine."""
    most = ENGINES[engine].facts.rectangles
    scenes = packaged_for({"engine": engine, "rectangles": most})
    assert {"matte", "corners", "degenerate", "facing_mirrors"} <= {path.stem for path in scenes}
    assert len(scenes) - len(PLAIN) >= (2 if engine == "seed" else 8)
    # The fewest units that meet the row budget compile fastest.
    size = {"units": 16} if engine == "seed" else {}
    looks = dict.fromkeys(ENGINES[engine].facts.features, True)
    size["rectangles"] = max(12, *(len(load_scene(path).rect) for path in scenes))
    design = configure(engine=engine, screen="tiny", reflections=2, **looks, **size)
    bench("verif.soak.bench", design, "verilator", os.pathsep.join(map(str, scenes)), seeds=tuple(range(len(scenes))))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "scale", "pixels", "shown"),
    [(240, 1, 1, 640 * 480), (200, 2, 1, 640 * 400), (180, 4, 1, 1280 * 720), (180, 6, 2, 1920 * 1080)],
)
def test_full_size_span(bench: Bench, rows, scale, pixels, shown):
    """The room as `make sim ENGINE=span` shows it: doubled, native, 720 lines, and 1080 with two pixels per clock."""
    design = configure(engine="span", rows=rows, scale=scale, pixels=pixels, units=scale)
    scene = PLAIN["mirror_room"]
    result, directory = drawn(bench, design, scene)
    assert result["pixels"] == shown
    # The finer picture samples the same view, so it contains every pixel of the coarse one.
    coarse = ExactModel().render(load_scene(scene), configure(engine="span", rows=rows, scale=1).screen_geometry)
    step = design.screen_geometry.horizontal.visible // 320
    assert np.array_equal(np.asarray(Image.open(directory / "frame.png"))[::step, ::step], coarse)


@pytest.mark.slow_sets(
    quick=[
        "engine=span-reflections=0",
        "engine=exact-reflections=0",
        "engine=exact-reflections=4-materials",
        "units=2-",
    ]
)
@pytest.mark.parametrize(
    "options",
    [
        {"units": 2, "rectangles": 1, "reflections": 0, "divider_bits": 3},
        {"units": 64, "rectangles": 1, "reflections": 0, "colour_bits": 1},
        {"units": 16, "rectangles": 32, "reflections": 0},
        {"units": 16, "reflections": 2, "divider_bits": 2},
        {"units": 8, "rounding": "nearest", "colour_bits": 4},
        {"units": 8, "fraction_bits": 1, "divider_bits": 3},
        {"units": 8, "fraction_bits": 4},
        {"units": 8, "fraction_bits": 4, "rounding": "nearest", "divider_bits": 2},
        {"units": 8, "fraction_bits": 8, "rounding": "nearest", "reflections": 2},
        {"engine": "exact", "reflections": 2},
        {"engine": "exact", "reflections": 4},
        {"engine": "exact", "reflections": 4, "materials": True},
        {"engine": "exact", "reflections": 0, "rectangles": 1, "colour_bits": 4},
        {"engine": "exact", "reflections": 0, "light": True},
        {"engine": "exact", "reflections": 4, "light": True, "culling": True},
        {"engine": "exact", "reflections": 2, **EVERY_LOOK},
        {"engine": "exact", "rectangles": 32, "units": 16},
        {"engine": "span", "reflections": 3, "materials": True, "scale": 1},
        {"engine": "span", "reflections": 4, "scale": 1, "units": 2},
        {"engine": "span", "reflections": 4, **EVERY_LOOK, "scale": 1},
        {"engine": "span", "reflections": 0, "rectangles": 1, "colour_bits": 4},
        {"engine": "span", "rectangles": 128, "units": 5},
        {"engine": "span", "rectangles": 1, "reflections": 0, "colour_bits": 5, "pixels": 2},
        {"engine": "span", "reflections": 2, "turn": True, "patterns": True, "pixels": 2, "units": 3},
    ],
    ids=lambda options: "-".join(f"{name}={value}" for name, value in options.items()),
)
def test_configurations(bench: Bench, tmp_path, options):
    """Each option is tested at its limits in Icarus, which builds quickly."""
    scene = f"reflections = {options.get('reflections', 1)}\n{SMALL_SCENE.read_text()}"
    if options.get("rectangles") == 1:
        scene = scene[: scene.index("[[rect]]", scene.index("[[rect]]") + 1)]
    if options.get("light"):
        scene += "[light]\nposition = [60, 100, 300]\nshade = 0.25\n"
    path = tmp_path / "scene.toml"
    path.write_text(scene)
    configuration = configure(screen="tiny", **{"rectangles": 3} | options)
    bench("sim.frame_bench", configuration, "icarus", path)
