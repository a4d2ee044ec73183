# SPDX-License-Identifier: MIT
"""One scene as a Tiny Tapeout project: its ports, its picture on the Pmod, and its gates."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml
from conftest import BUILD, SMALL_SCENE, broken
from rich.console import Console

from raycaster.fit.fixing import design_of
from raycaster.fpga import tiny_tapeout
from raycaster.fpga.tiny_tapeout import DEFAULTS, Gates, shape_for, write_info, write_project
from raycaster.sim.job import Job
from raycaster.sim.simulator import SimulationError, build_model, run_bench
from raycaster.verif.benches.tiny_tapeout_bench import PinsBench

PINS = ["R1", "G1", "B1", "vsync", "R0", "G0", "B0", "hsync"]
"""Signals on uo[0] to uo[7], as on the Tiny VGA Pmod."""


def project(**options):
    return design_of(SMALL_SCENE, options, "all", Console(quiet=True), **DEFAULTS)


def show(design, files: list[Path], output: Path, simulator: str = "verilator") -> None:
    """Run the bench on a project's Verilog; a wrong pixel fails."""
    model = build_model(design.configuration, simulator, build=BUILD, verilog=files, bench=PinsBench())
    job = Job(design.configuration, scene=str(design.path), output=str(output), reflections=design.reflections)
    run_bench(model, "raycaster.verif.benches.tiny_tapeout_bench", job, output)


@pytest.mark.slow_sets("beam", "icarus-exact")
@pytest.mark.parametrize(
    ("simulator", "options"),
    [
        ("verilator", {}),
        ("verilator", {"engine": "beam", "rows": 240}),
        ("icarus", {"engine": "beam", "screen": "tiny", "rows": 48}),
        ("icarus", {}),
    ],
    ids=["exact", "beam", "icarus-tiny", "icarus-exact"],
)
def test_a_frame_is_golden(simulator, options, tmp_path, output):
    """The size is 640x480 except on the tiny screen; in Icarus, registers start unknown, as on a chip."""
    design = project(**options)
    show(design, write_project(design, tmp_path / "project"), output, simulator)


@pytest.mark.slow_sets(quick=["colours"])
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        pytest.param("blue[0], green[0], red[0]", "red[0], green[0], blue[0]", id="colours"),
        pytest.param("{hsync, blue[0]", "{!hsync, blue[0]", id="hsync"),
        pytest.param("red[0], vsync,", "red[0], hsync,", id="vsync"),
        pytest.param("RUN | COMMIT", "COMMIT", id="run"),
        pytest.param("CONTROL = 4'h4", "CONTROL = 4'h5", id="control"),
        pytest.param("uio_oe = 8'b0", "uio_oe = 8'b1", id="outputs"),
    ],
)
def test_a_wrong_pin_is_noticed(right, wrong, tmp_path, output):
    design = project(engine="beam", screen="tiny", rows=48)
    *others, top = write_project(design, tmp_path / "project")
    assert top.read_text().count(right) == 1
    files = broken([*others, top], tmp_path, top.stem, right, wrong)
    with pytest.raises(SimulationError):
        show(design, files, output, "icarus")


@pytest.mark.slow
def test_the_gates_show_the_same(tmp_path, output, capsys):
    """The netlist whose gates are counted draws the picture and has the counted number of registers."""
    kept = tmp_path / "kept.json"
    words = [str(SMALL_SCENE), "--output", str(tmp_path), "--keep", str(kept)]
    tiny_tapeout.main(words)
    figures = json.loads(kept.read_text())["figures"]
    [row] = figures["designs"]
    netlist = tmp_path / "gates" / "project" / "netlist.v"
    assert len(re.findall(r"^  always @\(posedge clk\)", netlist.read_text(), re.M)) == row["registers"]
    # Two rows of 80 rays, with two bits per colour channel.
    assert row["registers"] > row["buffer_bits"] == 2 * 80 * 6
    assert row["gates"] > 3000
    assert row["products"] == 8
    printed = capsys.readouterr().out
    assert f"{row['gates']:,}" in printed
    info = yaml.safe_load((tmp_path / "project" / "info.yaml").read_text())
    tiles = row["gates"] / figures["gates_a_tile"] + row["registers"] / figures["registers_a_tile"]
    assert row["tiles"] == round(tiles, 1)
    assert info["project"]["tiles"] == shape_for(tiles)
    show(project(), [netlist], output)


def test_the_project_is_described(tmp_path):
    files = write_project(project(), tmp_path / "project")
    info = yaml.safe_load(write_info(project(), files, "6x2").read_text())
    assert info["yaml_version"] == 6
    assert {name: info["project"][name] for name in ("top_module", "source_files", "clock_hz", "tiles")} == {
        "top_module": "tt_um_raycaster", "source_files": [path.name for path in files], "clock_hz": 25_000_000,
        "tiles": "6x2",
    }  # fmt: skip
    assert files[-1].stem == "tt_um_raycaster"
    assert {path.name for path in (tmp_path / "project" / "src").iterdir()} == {path.name for path in files}
    assert list(info["pinout"]) == [f"{port}[{bit}]" for port in ("ui", "uo", "uio") for bit in range(8)]
    assert [info["pinout"][f"uo[{bit}]"] for bit in range(8)] == PINS


def test_tiles():
    """Half a tile of registers and half a tile of gates make one tile."""
    gates = Gates(gates=500, registers=160, products=0, buffer_bits=0)
    assert gates.tiles == 1
    assert [shape_for(tiles) for tiles in (0.1, 1, 1.1, 6.5, 12.9, 16, 16.1)] == [
        "1x1", "1x1", "1x2", "4x2", "8x2", "8x2", None,
    ]  # fmt: skip
