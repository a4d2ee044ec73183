# SPDX-License-Identifier: MIT
"""Yosys's cell counts for a small design: its modules, their multipliers, and parts that add up to the whole."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace

import pytest
from conftest import called

from raycaster.convert.take_home import TOP
from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.fpga import area, flows, placement
from raycaster.fpga.board import Board, QuartusBoard, board_names, find_board
from raycaster.fpga.cells import FAMILIES, Area, measure, measure_modules
from raycaster.runs.outcomes import kept_outcome

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


FEATURES = {
    "seed": ["", "m", "p", "mp"],
    "exact": ["", "t", "m", "p", "l", "tmpl"],
    "span": ["", "t", "m", "p", "l", "tmpl"],
}
"""Features of each engine's designs, by their first letters: none, each alone, and all."""


def test_fixed_sets_of_designs(tmp_path, monkeypatch, capsys, names_for_digests):
    """Each feature is counted alone: for the seed engine in one ray unit, else in designs. The page's rooms follow."""
    sizes = {"turn": 1, "materials": 10, "patterns": 20, "light": 40}

    def count(config, family, directory, top):
        assert family.name == "ecp5"
        whole = "ray_unit" if config.engine == "seed" else TOP
        assert top == whole
        return Area(100 + sum(size for name, size in sizes.items() if getattr(config, name)), 7, 0, 3, 0)

    monkeypatch.setattr(area, "measure", count)
    path = tmp_path / "features.json"
    area.main(["--features", "--output", str(tmp_path / "area"), "--keep", str(path)])
    designs = kept_outcome(path).figures["designs"]
    letters = {name[0]: size for name, size in sizes.items()}
    featured = [row for row in designs if row["options"].keys() <= sizes.keys()]
    assert [(row["engine"], "".join(name[0] for name in row["options"]), row["tables"]) for row in featured] == [
        (engine, chosen, 100 + sum(map(letters.get, chosen))) for engine, sets in FEATURES.items() for chosen in sets
    ]
    assert all(room in [row["options"] for row in designs] for room in area.ROOM_DESIGNS.values())
    shown = capsys.readouterr().out
    assert "seed MATERIALS=1 PATTERNS=1" in shown
    assert shown.count("+71.0%") == 2 + sum("light" in room for room in area.ROOM_DESIGNS.values())


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
def test_a_missed_clock_is_routed_again(reached, code, kept, runs, tmp_path, monkeypatch):
    """A missed clock is routed once more; a second run that takes too long, as None, keeps the first result."""
    made = []

    def run_nextpnr(command, directory, timeout):
        clock = reached[len(made)]
        made.append((command, timeout))
        if clock is None:
            raise subprocess.TimeoutExpired(command, timeout)
        report = {"fmax": {"$glbnet$clk": {"achieved": clock, "constraint": 74.25}}}
        (directory / "report.json").write_text(json.dumps(report))
        return subprocess.CompletedProcess(command, code, "", "")

    monkeypatch.setattr(flows, "run_program", run_nextpnr)
    done = flows.place_and_route(["nextpnr", "--seed", "1"], ("--again",), tmp_path)
    assert done.returncode == code
    assert json.loads((tmp_path / "report.json").read_text())["fmax"]["$glbnet$clk"]["achieved"] == kept
    logs = [("--again" in command, command[-1]) for command, _ in made]
    assert logs == [(False, "nextpnr.log"), (True, "again.log")][:runs]
    assert made[-1][1] == (flows.LONGEST, flows.LEAST_AGAIN)[runs - 1]


def test_where_the_blocks_are(tmp_path):
    """A tile belongs to the block with most of its cells; small blocks belong to those around them."""
    cells = {f"a_i.{at}": f"X{at}/Y0/SLICEA" for at in range(8)} | {"a_i.b.1": "X0Y1/LUT", "c": "X3Y1/LUT"}
    cells |= {f"d.{at}": f"X2Y1/LUT{at}" for at in range(9)} | {f"d.e.{at}": f"X{1 + at % 2}Y1/DFF" for at in range(14)}
    placed = {name: {"attributes": {"NEXTPNR_BEL": place}} for name, place in cells.items()}
    path = tmp_path / "placed.json"
    path.write_text(json.dumps({"modules": {"top": {"cells": placed}, "LUT4": {"cells": {}}}}))
    tiles, names = placement.tiles_of(path)
    assert [names[number] for number in tiles[0]] == 8 * ["a"]
    assert [names[number] for number in tiles[1, :4]] == ["a", "d.e", "d", "all else"] and set(tiles[1, 4:]) == {-1}


def test_a_module_is_routed_alone(tmp_path, monkeypatch, capsys):
    """nextpnr's report on paths between registers is printed and kept; paths from and to pads are left out."""
    used = {"TRELLIS_COMB": 9, "TRELLIS_FF": 8, "MULT18X18D": 4, "DP16KD": 2}
    path = [
        {"delay": 0.52, "to": {"cell": "count", "port": "Q"}},
        {"delay": 1.234, "net": "rect_mem_i.index", "to": {"cell": "LUT", "port": "A"}},
    ]
    clocks = [("<async>", "posedge $glbnet$clk"), ("posedge $glbnet$clk",) * 2]
    report = {
        "fmax": {"$glbnet$clk": {"achieved": 77.007, "constraint": 51.5}},
        "utilization": {name: {"used": count, "available": 10} for name, count in used.items()},
        "critical_paths": [{"from": one, "to": other, "path": path} for one, other in clocks],
    }
    commands = []

    def run_nextpnr(command, again, directory):
        commands.append((command, again))
        (directory / "report.json").write_text(json.dumps(report))
        return subprocess.CompletedProcess(command, 0, "", "")

    monkeypatch.setattr(area, "place_and_route", run_nextpnr)
    monkeypatch.setattr(area, "write_netlist", lambda flow, sources, top, multipliers, work: work / f"{top}.json")
    kept = tmp_path / "routed.json"
    options = ("--route", "--seed", "3", "--engine", "exact", "--output", str(tmp_path / "area"), "--keep", str(kept))
    area.main(options)
    [(command, again)] = commands
    assert again == ()
    assert {"--85k", f"{TOP}.json"} <= {*command}
    assert [command[command.index(name) + 1] for name in ("--freq", "--seed")] == ["51.5", "3"]
    figures = kept_outcome(kept).figures
    assert figures["cells"][figures["kinds"]["logic"]] == [9, 10]
    assert figures["clocks"] == {"clk": [77.01, 51.5]}
    assert figures["path"] == [[0.52, "count"], [1.23, "rect_mem_i.index"]]
    shown = capsys.readouterr().out
    assert re.search(r"clk +77.01 MHz +51.50 MHz +met", shown)
    assert re.search(r"1.23 +rect_mem_i.index", shown)
    with pytest.raises(UserError, match="route: places a module on an ECP5"):
        area.main(["--route", "--family", "cyclonev"])
    with pytest.raises(UserError, match="seed: chooses the placement"):
        area.main(["--seed", "3"])


@pytest.mark.slow
def test_the_command(tmp_path):
    """Each unit has two multipliers; the share of a board's chip is printed."""
    options = ("--screen", "tiny", "--units", "2", "--rectangles", "1", "--reflections", "0", "--divider-bits", "1")
    options += ("--allow-underrun", "--culling", "0", "--family", "ecp5", "--keep", "area.json")
    done = called("area", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "area: usually 3 min\n")
    [counted] = kept_outcome(tmp_path / "area.json").figures["families"].values()
    assert counted["multipliers"] == 4
    assert re.search(rf"ULX3S.* LFE5U-85F-6BG381C +83,640 +{counted['elements']:,} +\d+% +4 of 156", done.stdout)
    boards = [find_board(name, Board) for name in board_names(Board)]
    assert {board.counted_as for board in boards if isinstance(board, QuartusBoard)} < set(FAMILIES)
