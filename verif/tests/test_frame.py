# SPDX-License-Identifier: MIT
"""Frames of the whole design: every visible pixel is compared with the golden model."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, Bench
from PIL import Image

from raycaster.configuration import configure
from raycaster.design import packaged_for
from raycaster.engines import ENGINES
from raycaster.golden.exact import ExactModel
from raycaster.scene import load_scene, packaged_scenes

PLAIN = packaged_scenes(plain=True)


@pytest.mark.slow_sets(quick=["boxes"])
@pytest.mark.parametrize("scene", PLAIN.values(), ids=PLAIN)
def test_full_size(bench: Bench, scene):
    """Every scene that the default design can draw, as `make sim` shows it."""
    check_full_size(bench, scene, "seed")


@pytest.mark.slow_sets("beam", "seed")
@pytest.mark.parametrize("engine", ENGINES)
def test_scenes_with_looks(bench: Bench, engine):
    """Every scene that needs more than the default design, on the tiny screen, drawn by one design per engine."""
    scenes = [path for path in packaged_for({"engine": engine}) if path.stem not in PLAIN]
    assert len(scenes) >= (2 if engine == "seed" else 8)
    # The fewest units that meet the row budget compile fastest.
    size = {"units": 16} if engine == "seed" else {}
    looks = dict.fromkeys(ENGINES[engine].looks, True)
    design = configure(engine=engine, screen="tiny", reflections=2, **looks, **size)
    for scene in scenes:
        result = json.loads((bench("sim.frame_bench", design, "verilator", scene) / "result.json").read_text())
        assert (result["pixels"], result["wrong_vs_golden"]) == (128 * 96, 0), scene.stem
        assert not result["underrun"], scene.stem


@pytest.mark.slow
def test_full_size_exact(bench: Bench):
    """The mirror room, as `make sim ENGINE=exact` shows it."""
    check_full_size(bench, ROOT / "scenes" / "mirror_room.toml", "exact")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "scale", "pixels", "shown"),
    [(240, 1, 1, 640 * 480), (200, 2, 1, 640 * 400), (180, 4, 1, 1280 * 720), (180, 6, 2, 1920 * 1080)],
)
def test_full_size_beam(bench: Bench, rows, scale, pixels, shown):
    """The room as `make sim ENGINE=beam` shows it: doubled, native, 720 lines, and 1080 with two pixels per clock."""
    configuration = configure(engine="beam", rows=rows, scale=scale, pixels=pixels)
    scene = ROOT / "scenes" / "mirror_room.toml"
    directory = bench("sim.frame_bench", configuration, "verilator", scene)
    result = json.loads((directory / "result.json").read_text())
    assert (result["pixels"], result["wrong_vs_golden"]) == (shown, 0)
    assert result["worst_row_cycles"] == configuration.screen_geometry.horizontal.visible // pixels
    assert result["worst_group_cycles"] == 1
    # The finer picture samples the same view, so it contains every pixel of the coarse one.
    coarse = ExactModel().render(load_scene(scene), configure(engine="beam", rows=rows, scale=1).screen_geometry)
    step = configuration.screen_geometry.horizontal.visible // 320
    assert np.array_equal(np.asarray(Image.open(directory / "frame.png"))[::step, ::step], coarse)


def check_full_size(bench: Bench, scene, engine: str) -> dict:
    contents = load_scene(scene)
    configuration = configure(engine=engine, rows=contents.rows, reflections=contents.reflections)
    result = json.loads((bench("sim.frame_bench", configuration, "verilator", scene) / "result.json").read_text())
    assert result["pixels"] == 640 * 2 * configuration.rows
    assert result["wrong_vs_golden"] == 0
    assert not result["underrun"]
    assert result["worst_group_cycles"] <= configuration.group_budget
    assert result["worst_row_cycles"] < configuration.screen_geometry.row_cycles
    return result


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_tiny_in_icarus(engine):
    """The command draws the tiny screen in Icarus, with zero, one and two reflections and with edge cases."""
    build = BUILD / "test" / f"tiny_in_icarus_{engine}"
    scenes = [ROOT / "scenes" / f"{name}.toml" for name in ("matte", "corners", "degenerate", "facing_mirrors")]
    options = ("--engine", engine, "--screen", "tiny", "--simulator", "icarus", "--build", str(build))
    options += tuple(map(str, scenes))
    subprocess.run([sys.executable, "-m", "raycaster.cli", "sim", *options], cwd=ROOT, check=True)
    for scene in scenes:
        result = json.loads((build / f"sim-{engine}-tiny" / scene.stem / "result.json").read_text())
        assert result["pixels"] == 128 * 96
        assert result["wrong_vs_golden"] == 0


@pytest.mark.slow_sets(
    quick=[
        "engine=beam-reflections=0",
        "engine=beam-reflections=4-scale=1",
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
        {"engine": "exact", "reflections": 2, "light": True, "turn": True, "materials": True, "patterns": True},
        {"engine": "exact", "rectangles": 32, "units": 16},
        {"engine": "beam", "reflections": 2, "scale": 1},
        {"engine": "beam", "reflections": 3, "materials": True, "scale": 1},
        {"engine": "beam", "reflections": 4, "scale": 1},
        {"engine": "beam", "reflections": 4, "turn": True, "patterns": True, "materials": True, "scale": 1},
        {"engine": "beam", "reflections": 0, "rectangles": 1, "colour_bits": 4},
        {"engine": "beam", "rectangles": 32},
        {"engine": "beam", "rectangles": 1, "reflections": 0, "colour_bits": 5, "pixels": 2},
        {"engine": "beam", "reflections": 2, "turn": True, "patterns": True, "pixels": 2},
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
