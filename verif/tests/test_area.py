# SPDX-License-Identifier: MIT
"""Yosys's cell counts for a small design: its modules, their multipliers, and parts that add up to the whole."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace

import pytest
from conftest import called

from raycaster.configuration import configure
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.fpga import area, cells, flows
from raycaster.fpga.area import CHIPS, Chip, Model
from raycaster.fpga.cells import FAMILIES, Area, measure, measure_modules
from raycaster.output import emptied

SMALL = configure(screen="tiny", units=2, rectangles=2, divider_bits=1, allow_underrun=True, culling=False)

INSTANCES = {
    "ray_caster_module": 1, "ray_caster": 1, "line_buffer": 2, "ray_unit": 2, "intersection_helper": 4,
    "divider_step": 4, "clock_gate": 2,
}  # fmt: skip
"""Number of instances of some modules, on each level of the hierarchy."""

NOTHING = Area(0, 0, 0, 0, 0)


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
def test_modules_and_their_multipliers(family, tmp_path):
    """Each ray unit has two multipliers, other modules have none, and the modules add up to the whole.

    Culling needs no multiplier, as its products are sums, and less logic than four ray units, which are an eighth of
    the default design.
    """
    modules = measure_modules(SMALL, family, tmp_path / "modules")
    found = {name: instances for name, (instances, _) in modules.items()}
    assert found.items() >= INSTANCES.items()
    assert next(iter(modules)) == TOP
    # Modules of one block with different widths are counted apart.
    assert {"by_axis_1", "by_axis_9"} <= set(modules)
    multipliers = {name: area.multipliers for name, (_, area) in modules.items() if area.multipliers}
    assert multipliers == {"intersection_helper": 1}
    # On an FPGA, clocks are never gated.
    assert modules["clock_gate"][1] == NOTHING
    parts = sum((area * instances for instances, area in modules.values()), NOTHING)
    whole = measure(SMALL, family, tmp_path / "whole")
    assert whole.multipliers == parts.multipliers == 2 * SMALL.units
    # Flattening propagates constants across modules and adds no registers.
    assert 0 < 0.6 * parts.registers < whole.registers <= parts.registers
    assert 0 < 0.6 * parts.tables < whole.tables <= 1.05 * parts.tables

    more = measure(replace(SMALL, culling=True), family, tmp_path / "culled") - whole
    unit = measure(SMALL, family, tmp_path / "unit", "ray_unit")
    assert not more.multipliers
    assert more.tables < 4 * unit.tables
    assert more.registers < 4 * unit.registers


@pytest.mark.slow_sets("cycloneive")
@pytest.mark.parametrize(("family", "multipliers"), [("ecp5", 1), ("cycloneive", 2)])
def test_wide_multipliers(family, multipliers, tmp_path):
    """9 by 17 bits take one 18-bit multiplier, or two 9-bit ones."""
    wide = replace(SMALL, fraction_bits=8)
    assert measure(wide, FAMILIES[family], tmp_path / "area", "ray_unit").multipliers == 2 * multipliers


def test_the_model_predicts_linear_growth():
    shared, unit = Area(100, 50, 120, 0, 2), Area(10, 5, 12, 2, 1)
    model = Model.of((4, shared + unit * 4), (16, shared + unit * 16))
    assert model == Model(shared, unit)
    chip = Chip("board", "chip", "ecp5", elements=120 + 12 * 32, multipliers=64)
    assert model.fitting(chip, 320) == 32
    assert model.fitting(replace(chip, multipliers=63), 320) == 20
    assert model.fitting(replace(chip, elements=119), 320) == 0
    assert {one.family for one in CHIPS} == set(FAMILIES)


FEATURES = {
    "seed": ["", "m", "p", "mp"],
    "exact": ["", "t", "m", "p", "l", "tmpl"],
    "beam": ["", "t", "m", "p", "tmp"],
}
"""Features of each engine's designs, by their first letters: none, each alone, and all."""


def test_fixed_sets_of_designs(tmp_path, monkeypatch, capsys, names_for_digests):
    """Each feature is counted alone: for the seed engine in one ray unit, for others in designs."""
    sizes = {"turn": 1, "materials": 10, "patterns": 20, "light": 40}

    def count(config, family, directory, top):
        assert family.name == "ecp5"
        whole = "ray_unit" if config.engine == "seed" else TOP
        assert top == whole
        return Area(100 + sum(size for name, size in sizes.items() if getattr(config, name)), 7, 0, 3, 0)

    monkeypatch.setattr(area, "measure", count)
    path = tmp_path / "features.json"
    area.main(["--features", "--output", str(tmp_path / "area"), "--keep", str(path)])
    designs = json.loads(path.read_text())["figures"]["designs"]
    letters = {name[0]: size for name, size in sizes.items()}
    assert [(row["engine"], "".join(name[0] for name in row["options"]), row["tables"]) for row in designs] == [
        (engine, chosen, 100 + sum(map(letters.get, chosen))) for engine, sets in FEATURES.items() for chosen in sets
    ]
    shown = capsys.readouterr().out
    assert "seed MATERIALS=1 PATTERNS=1" in shown
    assert (shown.count("+71.0%"), shown.count("+31.0%")) == (1, 1)


def test_each_pin_has_a_register(tmp_path):
    """Every port except the clocks gets an input or output register of its width; Icarus accepts the result."""
    config = configure(engine="beam", screen="tiny", rectangles=1, reflections=0, colour_bits=5, pixels=2)
    files = write_verilog(config, tmp_path)
    [module] = [path.read_text() for path in files if path.name == "ray_caster_module.v"]
    top = tmp_path / "top.v"
    text = cells.registered_pins(module)
    top.write_text(text)
    ports, outer = (re.findall(r"^ *(input|output) +\w+ +(\[\d+:0\])? *(\w+),?$", one, re.M) for one in (module, text))
    assert {*outer} == {*ports} - {("output", "", "vga_clk")}
    assert text.count("always") == len(outer) - 1
    sources = [top, *(path for path in files if path.suffix == ".v")]
    call = ["iverilog", "-g2005", "-Wall", "-Wno-timescale", "-s", "registered_pins", "-o", tmp_path / "top", *sources]
    assert not subprocess.run(call, capture_output=True, text=True, check=True).stderr


@pytest.fixture
def nextpnr(monkeypatch):
    """A function that replaces nextpnr by one that reaches these clocks in turn; returns the commands and time limits.

    None stands for a run that takes too long.
    """

    def replace_by(*reached: float | None, code: int = 0) -> list[tuple[list[str], float]]:
        made = []

        def run_nextpnr(command, directory, timeout):
            clock = reached[len(made)]
            made.append((command, timeout))
            if clock is None:
                raise subprocess.TimeoutExpired(command, timeout)
            cells = {"TRELLIS_COMB": {"used": 41_000, "available": 83_640}, "DCCA": {"used": 0, "available": 56}}
            report = {"fmax": {"$glbnet$clk": {"achieved": clock, "constraint": 74.25}}, "utilization": cells}
            (directory / "report.json").write_text(json.dumps(report))
            return subprocess.CompletedProcess(command, code, "", "")

        monkeypatch.setattr(flows, "run_program", run_nextpnr)
        return made

    return replace_by


def test_placing_and_routing_alone(tmp_path, monkeypatch, capsys, names_for_digests, nextpnr):
    """nextpnr's report is kept with its seed; a run with another seed has files of its own."""
    calls = nextpnr(81.256, 81.256)
    monkeypatch.setattr(area, "find_program", lambda name: name)
    monkeypatch.setattr(area, "prepare_wasm", lambda name: None)
    monkeypatch.setattr(area, "register_products", lambda netlist: 0)
    monkeypatch.setattr(area, "synthesise", lambda config, family, directory, top: directory.mkdir(parents=True))
    options = ("--engine", "beam", "--rows", "180", "--scale", "6", "--pixels", "2", "--route-only", "--seed", "3")
    kept = tmp_path / "routed.json"
    area.main([*options, "--output", str(tmp_path / "area"), "--keep", str(kept)])
    area.main([*options, "--seed", "4", "--output", str(tmp_path / "area")])
    command = calls[0][0]
    assert [call[0][call[0].index("--seed") + 1] for call in calls] == ["3", "4"]
    assert len([*(tmp_path / "area").glob("*/report.json")]) == 2
    assert command[command.index("--freq") + 1] == "74.25"
    assert json.loads(kept.read_text())["figures"] == {
        "configuration": "beam-vga180-s6-u2-r12-m1-c8", "seed": 3, "clock_mhz": 74.25, "routed_mhz": 81.26,
        "cells": {"TRELLIS_COMB": [41_000, 83_640]},
    }  # fmt: skip
    assert "81.26 MHz of 74.25, 41,000 of 83,640 TRELLIS_COMB" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("reached", "code", "kept", "runs"),
    [
        ((75.0,), 0, 75.0, 1),
        ((70.0, 76.0), 0, 76.0, 2),
        ((70.0, 72.0), 0, 72.0, 2),
        ((70.0, None), 0, 70.0, 2),
        ((70.0, 76.0), 1, 70.0, 1),
    ],
    ids=["met", "met then", "missed", "no end", "failed"],
)
def test_a_missed_clock_is_routed_again(reached, code, kept, runs, tmp_path, nextpnr):
    """A missed clock is routed once more; a second run that takes too long keeps the first result."""
    made = nextpnr(*reached, code=code)
    done = flows.place_and_route(["nextpnr", "--seed", "1"], ("--again",), tmp_path)
    assert done.returncode == code
    assert json.loads((tmp_path / "report.json").read_text())["fmax"]["$glbnet$clk"]["achieved"] == kept
    logs = [("--again" in command, command[-1]) for command, _ in made]
    assert logs == [(False, "nextpnr.log"), (True, "again.log")][:runs]
    assert made[-1][1] == (flows.LONGEST, flows.LEAST_AGAIN)[runs - 1]


def test_the_command(tmp_path):
    """Designs with fewer units are counted too; each unit has two multipliers."""
    options = ("--screen", "tiny", "--units", "2", "--rectangles", "1", "--reflections", "0", "--divider-bits", "1")
    options += ("--allow-underrun", "--culling", "0", "--family", "ecp5")
    done = called("area", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "area: usually 3 min, less with kept results\n")
    [written] = tmp_path.glob("build/area/*-seed-1/area.json")
    published = json.loads(written.read_text())["families"]["ecp5"]
    assert set(published) == {"units", "shared", "unit"}
    assert [area["multipliers"] for area in published["units"].values()] == [4, 2]


def test_a_design_is_counted_once(tmp_path, monkeypatch):
    """A kept count needs no Yosys; other designs, families and modules are counted separately."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "")
    asked = []

    def write(config, directory):
        emptied(directory)
        (directory / "design.v").write_text(config.name)
        return [directory / "design.v"]

    def netlist(directory, script):
        asked.append(script[-3])
        return {top: {"cells": {}} for top in (TOP, "ray_unit")}

    monkeypatch.setattr(cells, "write_verilog", write)
    monkeypatch.setattr(cells, "_netlist", netlist)
    ecp5 = FAMILIES["ecp5"]
    for _ in range(2):
        measure(SMALL, ecp5, tmp_path / "one")
        measure(SMALL, ecp5, tmp_path / "unit", "ray_unit")
        measure(SMALL, FAMILIES["cyclonev"], tmp_path / "other")
        measure(replace(SMALL, rectangles=3), ecp5, tmp_path / "more")
    assert len(asked) == 4
