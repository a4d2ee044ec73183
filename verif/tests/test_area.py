# SPDX-License-Identifier: MIT
"""Yosys's cell counts for a small design: its modules, their multipliers, and parts that add up to the whole."""

from __future__ import annotations

import json
import re
import subprocess
from collections import Counter
from dataclasses import replace

import pytest
from conftest import called

from raycaster.configuration import configure
from raycaster.convert.write import write_verilog
from raycaster.fpga import area, cells, flows
from raycaster.fpga.area import CHIPS, Chip, Model
from raycaster.fpga.cells import FAMILIES, Area, measure, measure_modules
from raycaster.rtl.common.widths import exact_slope_bits

SMALL = configure(screen="tiny", units=2, rectangles=2, divider_bits=1, allow_underrun=True, culling=False)

families = pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)


INSTANCES = {
    "ray_caster_module": 1, "avalon_interface": 1, "camera_mem": 1, "rect_mem": 1, "rect_sorter": 1, "rect_slot": 2,
    "scene_word": 3, "ray_caster_renderer": 1, "video_generator": 1, "line_buffer": 2, "ray_caster": 1,
    "ray_control": 1, "ray_sequencer": 1, "rect_sequencer": 1, "ray_unit": 2, "ray_generator": 2,
    "magnitude": 8, "by_axis_1": 6, "by_axis_9": 14, "by_axis_27": 2,
    "intersection_finder": 2, "intersection_helper": 4,
    "divider": 4, "divider_step": 4, "z_buffer": 2, "ray_mem": 2, "colour_combiner": 2, "colour_share": 2,
    "colour_sum": 6,
    # For the ray caster's clock and the memories' clock.
    "clock_gate": 2,
}  # fmt: skip


@pytest.mark.slow
@families
def test_modules_and_their_multipliers(family, tmp_path):
    """Each ray unit has two multipliers, other modules have none, and the modules add up to the whole."""
    modules = measure_modules(SMALL, family, tmp_path / "modules")
    assert {name: instances for name, (instances, _) in modules.items()} == INSTANCES
    multipliers = {name: area.multipliers for name, (_, area) in modules.items() if area.multipliers}
    assert multipliers == {"intersection_helper": 1}
    # On an FPGA, clocks are never gated.
    assert modules["clock_gate"][1] == Area(0, 0, 0, 0, 0)
    parts = sum((area * instances for instances, area in modules.values()), Area(0, 0, 0, 0, 0))
    whole = measure(SMALL, family, tmp_path / "whole")
    assert whole.multipliers == parts.multipliers == 2 * SMALL.units
    # Flattening propagates constants across modules and adds no registers.
    assert 0.6 * parts.registers < whole.registers <= parts.registers
    assert 0.6 * parts.tables < whole.tables <= 1.05 * parts.tables


UNIT = {
    "ray_unit", "ray_generator", "magnitude", "intersection_finder", "intersection_helper", "divider", "divider_step",
    "z_buffer", "ray_mem", "colour_combiner", "colour_share", "colour_sum", "by_axis_1", "by_axis_9", "by_axis_27",
}  # fmt: skip


@pytest.mark.slow
@families
def test_the_cost_of_culling(family, tmp_path):
    """Culling needs no multiplier, as its products are sums, and less logic than four ray units."""
    modules = measure_modules(replace(SMALL, culling=True), family, tmp_path / "area")
    found, taken = Counter(), Area(0, 0, 0, 0, 0)
    for name, (instances, counted) in modules.items():
        if name not in INSTANCES:
            found[re.sub(r"_\d+$", "", name)] += instances
            taken += counted * instances
    products = {"array_multiplier": 6, "multiplier_step": 6 * (exact_slope_bits(SMALL) + 1)}
    assert found == {"group_culler": 1, "group_tester": 1, "rect_copy": 1, "rect_setup": 1, "by_axis": 3} | products
    assert not taken.multipliers
    unit = sum(
        (modules[name][1] * (count // SMALL.units) for name, count in INSTANCES.items() if name in UNIT),
        Area(0, 0, 0, 0, 0),
    )
    # Four units are an eighth of the default design.
    assert taken.tables < 4 * unit.tables
    assert taken.registers < 4 * unit.registers


@pytest.mark.slow_sets("cycloneive")
@pytest.mark.parametrize(("family", "multipliers"), [("ecp5", 1), ("cycloneive", 2)])
def test_wide_multipliers(family, multipliers, tmp_path):
    """9 by 17 bits take one 18-bit multiplier, or two 9-bit ones."""
    wide = configure(
        screen="tiny", units=2, rectangles=2, fraction_bits=8, divider_bits=1, allow_underrun=True, culling=False
    )
    assert measure(wide, FAMILIES[family], tmp_path / "area").multipliers == 4 * multipliers


@pytest.mark.slow
def test_one_more_register_shows(tmp_path, monkeypatch):
    family = FAMILIES["cycloneive"]
    sound = measure(SMALL, family, tmp_path / "sound")

    def write_with_register(config, directory):
        files = write_verilog(config, directory)
        path = directory / "avalon_interface.v"
        right = "assign irq = irq_pending && irq_enable;\n"
        assert right in path.read_text()
        late = "reg late;\nalways @(posedge clk) late <= irq_pending && irq_enable;\nassign irq = late;\n"
        path.write_text(path.read_text().replace(right, late))
        return files

    monkeypatch.setattr("raycaster.fpga.cells.write_verilog", write_with_register)
    assert measure(SMALL, family, tmp_path / "broken").registers == sound.registers + 1


def test_the_model_predicts_linear_growth():
    shared, unit = Area(100, 50, 120, 0, 2), Area(10, 5, 12, 2, 1)
    model = Model.of((4, shared + unit * 4), (16, shared + unit * 16))
    assert model == Model(shared, unit)
    chip = Chip("board", "chip", "ecp5", elements=120 + 12 * 32, multipliers=64)
    assert model.fitting(chip, 320) == 32
    assert model.fitting(replace(chip, multipliers=63), 320) == 20
    assert model.fitting(replace(chip, elements=119), 320) == 0


def test_bridges(tmp_path, monkeypatch, capsys, names_for_digests):
    """Each bridge is counted alone, in a design that has it."""

    def count(config, family, directory, top):
        assert (family.name, top) == ("ecp5", f"{config.bus}_bridge")
        return Area(len(config.bus), 7, 0, 0, 0)

    monkeypatch.setattr(area, "measure", count)
    kept = tmp_path / "bridges.json"
    area.main(["--bridges", "--output", str(tmp_path / "area"), "--keep", str(kept)])
    bridges = json.loads(kept.read_text())["figures"]["bridges"]
    assert [(row["bus"], row["tables"]) for row in bridges] == [("axi4lite", 8), ("wishbone", 8), ("apb", 3)]
    assert "axi4lite" in capsys.readouterr().out


FEATURES = {
    "seed": [(), ("materials",), ("patterns",), ("materials", "patterns")],
    "exact": [
        (), ("turn",), ("materials",), ("patterns",), ("light",), ("turn", "materials", "patterns", "light"),
    ],
    "beam": [(), ("turn",), ("materials",), ("patterns",), ("turn", "materials", "patterns")],
}  # fmt: skip


def test_features(tmp_path, monkeypatch, capsys, names_for_digests):
    """Each feature alone and all together: in one ray unit for the seed engine, in whole designs for the others."""

    def count(config, family, directory, top):
        assert (family.name, top) == ("ecp5", "ray_unit" if config.engine == "seed" else "ray_caster_module")
        return Area(100 + config.turn + 10 * config.materials + 20 * config.patterns + 40 * config.light, 7, 0, 3, 0)

    monkeypatch.setattr(area, "measure", count)
    kept = tmp_path / "features.json"
    area.main(["--features", "--output", str(tmp_path / "area"), "--keep", str(kept)])
    outcome = json.loads(kept.read_text())
    designs = outcome["figures"]["designs"]
    assert len(outcome["provenance"]["designs"]) == len(designs)
    found = {engine: [tuple(row["options"]) for row in designs if row["engine"] == engine] for engine in FEATURES}
    assert (found, len(designs)) == (FEATURES, 15)
    assert [row["tables"] for row in designs] == [
        100,
        110,
        120,
        130,
        100,
        101,
        110,
        120,
        140,
        171,
        100,
        101,
        110,
        120,
        131,
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
    top.write_text(cells.registered_pins(module))
    text = top.read_text()
    widths = {"reset": "", "avs_s0_writedata": "[31:0]", "vga_g": "[9:0]", "vga_hs": "", "irq": ""}
    for name, width in widths.items():
        given = name in ("reset", "avs_s0_writedata")
        assert re.search(rf"{'input wire' if given else 'output reg'} +{re.escape(width)} *{name}\b", text), name
        taken = (f"{name}_inside", name) if given else (name, f"{name}_inside")
        assert f"always @(posedge clk) {taken[0]} <= {taken[1]};" in text
    assert text.count("always") == 17
    sources = [top, *(path for path in files if path.suffix == ".v")]
    call = ["iverilog", "-g2005", "-Wall", "-Wno-timescale", "-s", "registered_pins", "-o", tmp_path / "top", *sources]
    assert not subprocess.run(call, capture_output=True, text=True, check=True).stderr


def test_placing_and_routing_alone(tmp_path, monkeypatch, capsys, names_for_digests):
    """nextpnr's report is kept with its seed."""
    calls = []

    def run_nextpnr(command, directory, timeout):
        calls.append(command)
        report = {
            "fmax": {"$glbnet$clk": {"achieved": 81.256, "constraint": 74.25}},
            "utilization": {
                "TRELLIS_COMB": {"used": 41_000, "available": 83_640},
                "DCCA": {"used": 0, "available": 56},
            },
        }
        (directory / "report.json").write_text(json.dumps(report))
        return subprocess.CompletedProcess(command, 0, "", "")

    monkeypatch.setattr(area, "find_program", lambda name: name)
    monkeypatch.setattr(area, "prepare_wasm", lambda name: None)
    monkeypatch.setattr(area, "register_products", lambda netlist: 0)
    monkeypatch.setattr(flows, "run_program", run_nextpnr)
    monkeypatch.setattr(area, "synthesise", lambda config, family, directory, top: directory.mkdir(parents=True))
    options = ("--engine", "beam", "--rows", "180", "--scale", "6", "--pixels", "2", "--route-only", "--seed", "3")
    kept = tmp_path / "routed.json"
    area.main([*options, "--output", str(tmp_path / "area"), "--keep", str(kept)])
    [command] = calls
    assert command[command.index("--seed") + 1] == "3"
    assert command[command.index("--freq") + 1] == "74.25"
    figures = json.loads(kept.read_text())["figures"]
    assert figures == {
        "configuration": "beam-vga180-s6-u2-r12-m1-c8", "seed": 3, "clock_mhz": 74.25, "routed_mhz": 81.26,
        "cells": {"TRELLIS_COMB": [41_000, 83_640]},
    }  # fmt: skip
    assert "81.26 MHz of 74.25, 41,000 of 83,640 TRELLIS_COMB" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("reached", "code", "kept", "calls"),
    [
        ((75.0,), 0, 75.0, 1),
        ((70.0, 76.0), 0, 76.0, 2),
        ((70.0, 72.0), 0, 72.0, 2),
        ((70.0, None), 0, 70.0, 2),
        ((70.0, 76.0), 1, 70.0, 1),
    ],
    ids=["met", "met then", "missed", "no end", "failed"],
)
def test_a_missed_clock_is_routed_again(reached, code, kept, calls, tmp_path, monkeypatch):
    """A missed clock is routed once more; None stands for a timeout, which keeps the first result."""
    made = []

    def run_nextpnr(command, directory, timeout):
        clock = reached[len(made)]
        made.append((command, timeout))
        if clock is None:
            raise subprocess.TimeoutExpired(command, timeout)
        report = {"fmax": {"clk": {"achieved": clock, "constraint": 74.25}}}
        (directory / "report.json").write_text(json.dumps(report))
        return subprocess.CompletedProcess(command, code, "", "")

    monkeypatch.setattr(flows, "run_program", run_nextpnr)
    done = flows.place_and_route(["nextpnr", "--seed", "1"], ("--again",), tmp_path)
    assert done.returncode == code
    assert json.loads((tmp_path / "report.json").read_text())["fmax"]["clk"]["achieved"] == kept
    assert [("--again" in command, command[-1]) for command, _ in made] == [
        (False, "nextpnr.log"), (True, "again.log"),
    ][:calls]  # fmt: skip
    assert made[-1][1] == (flows.LONGEST, flows.LEAST_AGAIN)[calls - 1]


def test_every_chip_belongs_to_a_family():
    assert {chip.family for chip in CHIPS} == set(FAMILIES)


def test_the_command(tmp_path):
    options = ("--screen", "tiny", "--units", "4", "--rectangles", "1", "--allow-underrun", "--culling", "0")
    options += ("--family", "ecp5")
    done = called("area", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "area: usually 3 min, less with kept results\n")
    published = json.loads((tmp_path / "build" / "area" / "area.json").read_text())["families"]["ecp5"]
    assert set(published) == {"units", "shared", "unit"}
    assert [area["multipliers"] for area in published["units"].values()] == [8, 4, 2]


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--family", "ice40"), "error: family: expected one of ecp5, cycloneive, cyclonev, got ice40"),
        (("--units", "7"), "error: units: 7 does not divide the 320 columns"),
        (("--features", "--engine", "beam"), "error: features: counts a fixed set of designs"),
    ],
)
def test_bad_options_get_one_line(tmp_path, options, complaint):
    done = called("area", *options, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(complaint)
    assert done.stderr.count("\n") == 1
    assert not any(tmp_path.iterdir())


def test_a_design_is_counted_once(tmp_path, monkeypatch):
    """A kept count needs no Yosys; other designs, families and modules are counted separately."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "")
    asked = []

    def netlist(directory, script):
        asked.append(script[-3])
        return {top: {"cells": {}} for top in ("ray_caster_module", "ray_unit")}

    monkeypatch.setattr(cells, "_netlist", netlist)
    tiny, ecp5 = configure(screen="tiny", units=1, rectangles=2, allow_underrun=True), FAMILIES["ecp5"]
    for _ in range(2):
        measure(tiny, ecp5, tmp_path / "one")
        measure(tiny, ecp5, tmp_path / "unit", "ray_unit")
        measure(tiny, FAMILIES["cyclonev"], tmp_path / "other")
        measure(replace(tiny, rectangles=3), ecp5, tmp_path / "more")
    assert len(asked) == 4
