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
from raycaster.fpga import flows, placement
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
