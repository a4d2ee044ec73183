# SPDX-License-Identifier: MIT
"""The report: commands repeat their points, results are computed once, and pages are complete and true."""

from __future__ import annotations

import csv
import json
import re
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from html import unescape

import pytest
from rich.console import Console

from raycaster.design.decide import configure
from raycaster.fpga.cells import Area
from raycaster.report import __main__ as report
from raycaster.report import designs, plots, points
from raycaster.report.extent import extent
from raycaster.report.points import Point, Sweep, picture
from raycaster.scene import find_scene
from raycaster.verif.catalogue import catalogue

POINTS = (
    picture("seed:5", 4, "nearest", 1),
    Point("cells", "ray_unit", configure(screen="tiny", units=1, rectangles=1, allow_underrun=True)),
    Point("time", "raycaster/scenes/boxes.toml", configure(culling=False, fraction_bits=8), 5),
)


def test_a_command_repeats_its_point(capsys):
    """The command that the tables give names the point, and prints its result."""
    for point in POINTS:
        program, *rest = point.command.split()
        assert (program, rest[:2]) == (".venv/bin/python", ["-m", "raycaster.report.points"])
        assert points.parsed(rest[2:]) == point
    points.main(POINTS[0].arguments.split())
    assert json.loads(capsys.readouterr().out) == POINTS[0].compute()


def sweep_of(directory, make_executor=lambda: ProcessPoolExecutor(2)) -> Sweep:
    return Sweep(directory / "store", make_executor, Console(quiet=True))


@pytest.mark.slow
def test_a_small_report(tmp_path, monkeypatch):
    """It has everything once, including simulations, and needs no other file; cell counts are invented."""

    def cells(config, family, directory, top):
        return Area(config.units * (600 + 20 * config.fraction_bits) + 3000, 0, 0, 2 * config.units, 0)

    def rows(name: str) -> list[dict[str, str]]:
        with (tmp_path / f"{name}.csv").open() as file:
            return list(csv.DictReader(file))

    monkeypatch.setattr(points, "measure", cells)
    scenes = tmp_path / "raycaster" / "scenes"
    scenes.mkdir(parents=True)
    for name in ("corners", "mirror_room"):
        (scenes / f"{name}.toml").write_text(find_scene(name).read_text())
    monkeypatch.chdir(tmp_path)
    what = replace(extent(quick=True), fractions=(0, 4), worlds=6, cases=catalogue()[::20])
    write = partial(report.write_report, tmp_path, what, command_line="raycaster report")
    path, figures = write(sweep_of(tmp_path))
    html = unescape(path.read_text())
    assert 'class="alarm"' not in html and figures["alarms"] == 0
    assert html.count("<figure") == html.count("<svg ") == 9
    assert not re.search(r"(src|href)=\"(?!data:|#)", html)
    # The kept figures of the designs draw the same plot.
    again = designs.of_kept(json.loads(json.dumps(figures["designs"])))
    plots.save(designs.work_precision(again, "frame_ms"), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_text() == (tmp_path / "work_frame_ms.svg").read_text()
    corners = picture("raycaster/scenes/corners.toml", 4, "nearest", 1)
    assert corners.command in {row["command"] for row in rows("pictures")}
    best = rows("designs")
    assert {one["design"].split()[0] for one in best} == {"seed", "exact,", "span"}
    assert all(one["pixels unlike the model"] == "0" and "--runs 5" in one["command"] for one in best)
    assert "0 designs took more or fewer cycles than predicted, and 0 pixels differ from the golden model" in html
    # Nothing is computed twice: the pages are rebuilt from kept results.
    assert unescape(write(sweep_of(tmp_path, lambda: pytest.fail("not kept")))[0].read_text()) == html
