# SPDX-License-Identifier: MIT
"""`make sim` from outside: its outputs and its exit codes."""

from __future__ import annotations

import contextlib
import json
import os
import re
import threading
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import FLOOR_SCENE, PATTERNED_SCENE, ROOT, SMALL_SCENE, TURNED_SCENE, called, refusal, refused
from PIL import Image

from raycaster.configuration import FEATURES
from raycaster.design.decide import OPTIONS as DESIGN_OPTIONS
from raycaster.design.decide import configure
from raycaster.design.for_scene import design_for, left_out, packaged_for
from raycaster.errors import UserError
from raycaster.golden.frames import shown_hz
from raycaster.output import Console, emptied, replaced
from raycaster.scene import packaged_scenes
from raycaster.sim import scenes as simulate
from raycaster.sim.contact_sheet import CAPTION
from raycaster.sim.scenes import PICTURED, output_directory, run_all
from raycaster.sim.simulator import MODELS_VARIABLE, Model, SimulationError, convert

# Icarus builds quickly.
SMALL = configure(engine="exact", screen="tiny", rectangles=3)
OPTIONS = "--engine exact --rectangles 3 --screen tiny --simulator icarus"
SMALL_OPTIONS = (SMALL_SCENE, *OPTIONS.split())


def _sim(build: Path, *arguments: object, code: int = 0) -> str:
    """Run the command, which must end with a code, and return its output."""
    ran = called("sim", "--build", str(build), *map(str, SMALL_OPTIONS + arguments), cwd=ROOT)
    assert ran.returncode == code, ran.stdout + ran.stderr
    return ran.stdout


def test_two_scenes_and_one(tmp_path, monkeypatch):
    """The run writes pictures, results and a table; a sheet shows both scenes; with waveforms, it names their file."""
    monkeypatch.delenv(MODELS_VARIABLE)  # so that no built model is found
    output, sizes = tmp_path / "sim-exact-tiny-rectangles-3", "(128x96 for 64x48 rays)"
    other = tmp_path / "other.toml"
    other.write_text(SMALL_SCENE.read_text().replace("#c8c8b4", "#ff0000"))
    output.mkdir()
    for stale in ("older", "older-failed"):
        emptied(output / stale)
    (output / "mine").mkdir()
    said = _sim(tmp_path, other)
    assert "building exact-tiny48-u2-r3-m1-c8 with icarus" in said
    assert "was built before" not in said
    sheet = Image.open(output / "scenes.png")
    assert sheet.size == (2 * 320 + 8, 240 + CAPTION)
    names = [sheet.crop((left, 240, left + 320, 240 + CAPTION)) for left in (0, 328)]
    assert all(low == 0 for name in names for low, _ in name.getextrema()), "no name below a frame"
    assert {path.name for path in output.iterdir()} == {"small", "other", "mine", "scenes.png"}
    floors = [sheet.getpixel((left + 160, 235)) for left in (0, 328)]
    assert floors == [Image.open(output / name / "frame.png").getpixel((64, 94)) for name in ("small", "other")]
    pictures = f"{output / 'scenes.png'} and {output}/*/frame.png"
    assert f"2 scenes, 0 of 24,576 pixels wrong {sizes}; pictures: {pictures}\n" in said

    said, small = _sim(tmp_path, "--waves"), output / "small"
    assert "was built before" not in said, "waveforms need another model"
    assert {path.name for path in output.iterdir()} == {"small", "other", "mine"}, "the sheet has an older frame"
    for name in ("frame", "golden", "exact", "diff"):
        assert Image.open(small / f"{name}.png").size == (128, 96)
    assert (small / "frame.png").read_bytes() == (small / "golden.png").read_bytes()
    assert json.loads((small / "result.json").read_text())["wrong_vs_golden"] == 0
    assert f"1 scene, 0 of 12,288 pixels wrong {sizes}; picture: {small / 'frame.png'}\n" in said
    assert (small / "waves.fst").stat().st_size > 0
    assert str(small / "waves.fst") in said


def test_a_scene_is_watched(tmp_path, monkeypatch, capsys):
    """It is drawn again when it is saved; a mistake in it is one line."""
    scene, right = tmp_path / "mine.toml", SMALL_SCENE.read_text()
    scene.write_text(right)
    edits = iter([right.replace("camera", "camel"), right])

    def edit(_: float) -> None:
        text = next(edits, None)
        if text is None:
            raise KeyboardInterrupt
        os.utime(scene, ns=(0, 0))  # in case that the clock of files is coarse
        scene.write_text(text)

    monkeypatch.setattr(simulate, "time", SimpleNamespace(sleep=edit, perf_counter=time.perf_counter))
    words = [str(scene), *OPTIONS.split(), "--build", str(tmp_path), "--watch"]
    assert simulate.main(words) == 0
    said = capsys.readouterr().out
    assert (said.count("1 scene, 0 of 12,288 pixels wrong"), said.count("Ctrl-C ends")) == (2, 3)
    assert "was built before" in said and re.search(r"mine\.toml: .*camel", said)
    assert "needs the scenes to watch" in refused(simulate.main, "--watch")


def test_pictures_of_another_screen_or_engine_are_kept_apart():
    """They are for each engine that draws, and each option that may change a picture."""
    for expected, engines, options in (
        ("sim", ["seed", "exact"], {}),
        ("sim-seed", ["seed"], {"units": 8, "bus": "apb"}),
        ("sim-span-180", ["span"], {"engine": "span", "rows": 180}),
        ("sim-exact-tiny", ["exact"], {"screen": "tiny"}),
        ("sim-seed-reflections-0-rectangles-20", ["seed"], {"reflections": 0, "rectangles": 20}),
        ("sim-seed-fraction-bits-3-rounding-nearest", ["seed"], {"fraction_bits": 3, "rounding": "nearest"}),
        ("sim-seed-colour-bits-4-fix-all", ["seed"], {"colour_bits": 4, "fix": "all"}),
    ):
        assert output_directory(Path("build"), engines, options) == Path("build") / expected
    alike = {"engine", "screen", "rows", "scale", "units", "pixels", "divider_bits", "list", "culling", "bus", "baud"}
    assert alike | {*FEATURES, *PICTURED} == {*DESIGN_OPTIONS, "fix", "cells"}


@pytest.mark.parametrize(
    ("options", "reason", "among"),
    [
        ({"engine": "span", "light": "0"}, "needs a light", {"lamplight"}),
        ({"engine": "seed"}, "needs a camera that turns: the seed engine measures depth", {"pool"}),
        ({"patterns": "0"}, "needs rectangles with patterns", {"chessboard"}),
        ({"engine": "exact"}, "has more than 12 rectangles", {"hall_of_mirrors"}),
        ({"engine": "span", "rectangles": "128"}, "", set()),
    ],
)
def test_scenes_that_are_left_out_have_a_reason(options, reason, among):
    found = left_out(options)
    assert bool(found) == bool(reason)
    names = {name for said, listed in found.items() if said.startswith(reason) for name in listed}
    assert among <= names and not names & {path.stem for path in packaged_for(options)}
    assert len(packaged_for(options)) + sum(map(len, found.values())) == len(packaged_scenes())


def test_a_list_that_is_too_short_is_refused(tmp_path):
    """Before anything is built, with the length that the scene needs, which is enough."""
    words = (str(SMALL_SCENE), "ENGINE=span", "SCREEN=tiny")
    said = refusal(tmp_path, "sim", *words, "LIST=98")
    found = re.search(r"small\.toml: a frame has [\d,]+ runs .*, but a list .* 98; take .*\D(\d+) or more$", said)
    assert found, said
    enough = found[1]
    for entries, right in ((int(enough), True), (int(enough) - 2, False)):
        with contextlib.nullcontext() if right else pytest.raises(UserError):
            simulate.check_list(design_for(SMALL_SCENE, {"engine": "span", "screen": "tiny", "list": entries}))


@pytest.mark.parametrize(
    ("cycles", "said"),
    [(1, "60"), (419999, "60"), (420000, "60/2 = 30"), (839999, "60/2 = 30"), (840000, "60/3 = 20")],
)
def test_frames_per_second_on_the_monitor(cycles, said):
    """640x480 has 800 x 525 clocks per refresh, 59.5 times per second."""
    assert shown_hz(cycles, configure(engine="span")) == said


def test_an_interrupted_run_leaves_the_pictures(tmp_path, monkeypatch):
    """Ctrl-C ends the running simulator, no other scene begins, and the pictures of the last run stay."""
    design = design_for(SMALL_SCENE, {"screen": "tiny", "units": 8, "rectangles": 3})
    before = tmp_path / design.name / "frame.png"
    with replaced(before.parent) as partial:
        (partial / before.name).write_text("as it was")
    begun = []
    running, ended = threading.Event(), threading.Event()

    def run_bench(model, bench, job, directory):
        begun.append(job.scene)
        running.set()
        ended.wait()
        raise SimulationError("the simulation ended without a result")

    def interrupted_wait(*arguments, **named):
        running.wait()
        threading.Timer(1, ended.set).start()  # after the pool's pending jobs were cancelled
        raise KeyboardInterrupt

    monkeypatch.setattr(simulate, "run_bench", run_bench)
    monkeypatch.setattr(simulate, "wait", interrupted_wait)
    model = Model(design.configuration, "icarus", tmp_path, False, False)
    runs = [replace(design, path=path) for path in (SMALL_SCENE, Path("second.toml"), Path("third.toml"))]
    with pytest.raises(KeyboardInterrupt):
        run_all(runs, {design.configuration.name: model}, tmp_path, 1, Console(quiet=True))
    assert len(begun) == 1
    assert before.read_text() == "as it was"


def test_a_wrong_pixel_fails(tmp_path):
    """If the hardware differs from the golden model, the exit code is 1 and the output says where to look."""
    (combiner,) = (path for path in convert(SMALL, tmp_path) if path.stem.startswith("colour_combiner"))
    text, faults = re.subn(r"assign pixel_word = (.+);", r"assign pixel_word = ~\1;", combiner.read_text())
    assert faults
    combiner.write_text(text)
    said = _sim(tmp_path, code=1)
    output = tmp_path / "sim-exact-tiny-rectangles-3" / "small"
    command = f"raycaster trace {SMALL_SCENE} --pixel 0,0 {OPTIONS}"
    for text in ("pixels are wrong", str(output / "sim.log"), str(output / "diff.png"), command):
        assert text in said


def test_a_scene_chooses_what_it_needs(tmp_path):
    def chosen(text, **options):
        path = tmp_path / "mine.toml"
        path.write_text(text)
        config = design_for(path, options).configuration
        return config.engine, config.features

    assert chosen(FLOOR_SCENE) == ("seed", ())
    assert chosen(FLOOR_SCENE, engine="exact", turn="1") == ("exact", ("turn",))
    assert chosen(TURNED_SCENE) == ("exact", ("turn",))
    assert chosen(TURNED_SCENE, engine="span") == ("span", ("turn",))
    assert chosen(PATTERNED_SCENE) == ("seed", ("patterns",))
    assert chosen(TURNED_SCENE + "mirror = 0") == ("exact", ("turn", "materials"))


def test_a_packaged_scene_from_anywhere(tmp_path):
    """A packaged scene is found by name in a directory without scenes, and outputs go to its build/."""
    ran = called("sim", "floor", "SCREEN=tiny", "ENGINE=span", cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert (tmp_path / "build" / "sim-span-tiny" / "floor" / "frame.png").is_file()
