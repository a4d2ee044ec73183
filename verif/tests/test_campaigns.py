# SPDX-License-Identifier: MIT
"""Campaigns of numbered cases, random scenes and upsets: a correct design passes, and a broken one is reported."""

from __future__ import annotations

import json
import re
from collections import Counter
from functools import partial
from itertools import product
from pathlib import Path
from unittest.mock import MagicMock

import pytest
from cocotb.handle import ArrayObject
from cocotb.types import Range
from conftest import BUILD, ROOT, broken, called, set_day

from raycaster.configuration import configure
from raycaster.golden.catalogue import catalogue
from raycaster.scene import dump_scene, load_scene
from raycaster.sim.job import Job
from raycaster.sim.simulator import SimulationError, build_model, convert, run_bench
from raycaster.verif.campaign import Campaign, Outcome
from raycaster.verif.random_scenes import STYLES, random_scene
from raycaster.verif.soak import soak
from raycaster.verif.upsets.bench import KINDS, bits_of
from raycaster.verif.upsets.upsets import FLAGS, registers_of

LOOKS = ("turn", "materials", "patterns", "light")
SEED = configure(screen="tiny", units=8, rectangles=4, reflections=2, divider_bits=3)
EXACT = configure(engine="exact", screen="tiny", rectangles=1, reflections=0, units=4)


def results_in(directory: Path) -> list[dict]:
    return [json.loads(line) for line in (directory / "results.jsonl").read_text().splitlines()]


def test_scenes_survive_their_file(tmp_path):
    """Scenes of every style and look are read back as they were written."""
    for seed, looks in product(range(4 * len(STYLES)), ((), ("turn",), ("materials", "patterns"), LOOKS)):
        scene = random_scene(seed, 12, 2, looks)
        assert 1 <= len(scene.rect) <= 12
        path = tmp_path / f"{seed}.toml"
        path.write_text(dump_scene(scene))
        assert load_scene(path) == scene
        assert random_scene(seed, 12, 2, looks) == scene
        plain = random_scene(seed, 12, 2)
        assert not scene.lacks(looks)
        assert [rectangle.corners for rectangle in scene.rect] == [rectangle.corners for rectangle in plain.rect]
    needed = Counter(need for seed in range(100) for need in random_scene(seed, 12, 2, LOOKS).lacks(()))
    assert min(needed[look] for look in LOOKS) > 80


def test_the_catalogue_has_what_a_design_shows():
    counts = {looks: len(catalogue(looks)) for looks in ((), ("turn",), ("materials", "patterns"), LOOKS)}
    assert counts[()] >= 80
    assert counts["turn",] - counts[()] >= 15
    assert counts["materials", "patterns"] - counts[()] >= 8
    assert counts[LOOKS] > counts["turn",] + counts["materials", "patterns"] - counts[()]
    assert all(len(case.scene.rect) <= 12 for case in catalogue(LOOKS))


def test_soak_resumes_an_unfinished_run(tmp_path, monkeypatch):
    """Each day has other scenes; a run of which scenes have no result is resumed with its own, on any day."""
    ran: list[range] = []

    def run(campaign: Campaign, arguments, console, *, missing: int = 0) -> Outcome:
        ran.append(campaign.cases)
        return Outcome([], [], missing, 1.0)

    def soak_on(day: int, missing: int, *words: str) -> str:
        set_day(monkeypatch, day)
        monkeypatch.setattr(soak, "run_asked", partial(run, missing=missing))
        return called("verify", "soak", "--seeds", "3", "--screen", "tiny", *words, cwd=tmp_path).stdout

    tenth = 20_261_210 * 10_000
    assert "seed 20261210, by date; repeat with: raycaster verify soak --seed 20261210 --seeds 3 --screen tiny" in (
        soak_on(10, missing=1)
    )
    assert "seed 20261210, of the unfinished run" in soak_on(11, missing=0)
    assert "seed 20261212, by date" in soak_on(12, missing=1)
    soak_on(13, 0, "--fresh")
    soak_on(14, 0, "--seed", "0")
    assert "seed 2" not in soak_on(15, 0, "--first", "77")
    firsts = [tenth, tenth, tenth + 20_000, tenth + 30_000, 0, 77]
    assert ran == [range(first, first + 3) for first in firsts]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "seeds", "reflections", "pixels"),
    [
        (("--seeds", "8", "--seed", "0"), range(8), {3, 4}, 640 * 480),
        # `make soak STIFF=1 ENGINE=exact` uses the full size.
        (("--stiff", "--engine", "exact", "--screen", "tiny"), range(len(catalogue())), {4}, 64 * 48 * 4),
    ],
    ids=["random", "stiff"],
)
def test_soak(words, seeds, reflections, pixels, output):
    """Draw a few scenes at full size, and the stiff catalogue with the exact engine on the tiny screen."""
    ran = called("verify", "soak", *words, "--build", str(output), cwd=ROOT)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    results = results_in(output / "soak")
    assert [result["seed"] for result in results] == list(seeds)
    assert {result["reflections"] for result in results} >= reflections
    assert all(result["pixels"] == pixels and result["wrong_vs_golden"] == 0 for result in results)


@pytest.mark.slow
def test_a_wrong_scene_shrinks(bench, output, tmp_path):
    """A design that swaps the bounds on one axis loses rectangles; one rectangle is enough to show it."""
    fault = "rect_sorter", "(written_y_0 > written_y_1)", "(written_y_0 <= written_y_1)"
    files = broken(convert(SEED, BUILD), tmp_path, *fault)
    with pytest.raises(SimulationError, match="wrong pixels in the scenes of seeds"):
        bench("verif.soak.bench", SEED, "icarus", verilog=files, seeds=(0, 1, 5))
    shrunk = list(output.glob("*-shrunk.toml"))
    assert shrunk
    for path in shrunk:
        assert len(load_scene(path).rect) == 1 < len(load_scene(path.with_name(path.name.replace("-shrunk", ""))).rect)


def test_signals_assigned_at_an_edge_are_registers():
    """Every module with a clocked process has some, memories included; comparisons are no assignments."""
    files = {file.stem: file.read_text() for file in convert(EXACT, BUILD)}
    found = registers_of(convert(EXACT, BUILD))
    assert {module for module, names in found.items() if names} == {name for name in files if "posedge" in files[name]}
    for module, names in found.items():
        declared = re.findall(r"\breg\b.*?(\w+)(?: \[\S+\])?[;,]?$", files[module], re.M)
        assert set(names) <= set(declared), module
    assert {"x", "y", "hs", "vs"} <= set(found["video_generator"])
    assert any(re.search(rf"^reg .* {name} \[", files["line_buffer"], re.M) for name in found["line_buffer"])


def test_a_register_weighs_as_much_as_its_bits():
    memory = MagicMock(spec=ArrayObject, range=Range(15, "downto", 0))
    memory.__len__.return_value, memory.__getitem__.return_value = 16, [0] * 32
    assert (bits_of([0]), bits_of(memory)) == (1, 512)


def upset(files: list[Path], directory: Path, cases: int) -> None:
    """Run cases in which only the line counter has bits to flip."""
    model = build_model(EXACT, build=BUILD, verilog=files, flags=FLAGS)
    registers = {"video_generator": ("y",)}
    job = Job(EXACT, output=str(directory), seeds=tuple(range(cases)), registers=registers)
    run_bench(model, "raycaster.verif.upsets.bench", job, directory)


@pytest.mark.slow_sets("24")
@pytest.mark.parametrize("cases", [12, 24])
def test_a_sound_design_comes_back(tmp_path: Path, cases: int):
    """After jumps of the line counter, which lose syncs, after resets and after misuse, the picture soon recovers."""
    upset(convert(EXACT, BUILD), tmp_path, cases)
    results = results_in(tmp_path)
    assert {result["outcome"] for result in results} <= {"StartScreen", "commit", "unseen"}
    assert Counter(result["kind"] for result in results).keys() == set(KINDS)
    flipped = [result for result in results if result["kind"] == "upset"]
    assert all(result["where"].startswith("ray_caster_renderer_i.video_generator_i.y[") for result in flipped)
    assert any(result["lost_sync"] and result["outcome"] == "StartScreen" for result in flipped)


@pytest.mark.slow
def test_a_design_that_hangs_is_reported(tmp_path: Path):
    """The line counter stops once an upset makes it smaller than it ever is in normal operation."""
    fault = "video_generator", "y <= y + 1;", "if (y >= -8) y <= y + 1;"
    files = broken(convert(EXACT, BUILD), tmp_path, *fault)
    with pytest.raises(SimulationError, match="did not recover in cases"):
        upset(files, tmp_path, 24)
    assert "hangs" in {result["outcome"] for result in results_in(tmp_path)}
