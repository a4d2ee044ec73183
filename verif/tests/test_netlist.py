# SPDX-License-Identifier: MIT
"""Yosys netlists of a chip's cells behave like the Verilog: a ray unit on its vectors, and a design in a frame."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, called, refusal
from engine_vectors import check_ray_unit
from vectors import Bench

from raycaster.configuration import configure
from raycaster.output import emptied
from raycaster.rtl.seed.ray_unit import ray_unit
from raycaster.scene import packaged_scenes
from raycaster.sim import netlist
from raycaster.sim import scenes as simulate
from raycaster.sim.netlist import Netlist, NetlistError, synthesise

LIGHT = "[light]\nposition = [60, 100, 300]\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cells", "options", "light", "some"),
    [
        ("ecp5", "--units 4 --rectangles 3 --reflections 1", "", ("LUT4", "CCU2C")),
        ("ice40", "--engine exact --rectangles 3 --units 8 --light 1", LIGHT, ("SB_LUT4", "SB_MAC16", "SB_RAM40_4K")),
        ("gowin", "--engine exact --rectangles 3 --units 8", "", ("LUT4", "ALU", "DFFRE")),
    ],
    ids=["ecp5", "ice40", "gowin"],
)
def test_frame(tmp_path, cells, options, light, some):
    """The command draws every pixel: the seed engine, and the exact engine with the multipliers of iCE40, and a light,
    and without those of Gowin."""
    scene, build = tmp_path / "small.toml", BUILD / "test" / f"netlist-{cells}"
    scene.write_text(SMALL_SCENE.read_text() + light)
    ran = called("sim", "--gates", "--build", str(build), str(scene), "--cells", cells, *options.split(), cwd=ROOT)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    result = json.loads((build / "gates" / "small" / "result.json").read_text())
    assert (result["pixels"], result["wrong_vs_golden"]) == (128 * 96, 0)
    columns = [cell.rpartition("_")[2] for cell in some]  # headings have a line per part of a name
    for text in ("-tiny48-u", "through the netlist", *columns):
        assert text in ran.stdout
    assert not (build / "sim").exists()
    # An earlier version's netlist may be there, too.
    newest = max(build.glob("model/*/netlist-*/made"), key=lambda mark: mark.stat().st_mtime).parent
    counts = json.loads((newest / "cells.json").read_text())
    assert all(counts["design"]["num_cells_by_type"][cell] > 0 for cell in some)
    if cells != "gowin":
        longest = max(map(len, re.findall(r"\\(\S+)", (newest / "netlist.v").read_text())))
        assert longest <= 95, "Verilator's waveforms fail with longer names"


@pytest.fixture(scope="module")
def unit(tmp_path_factory) -> tuple:
    """Return the default design and the netlist of its ray unit."""
    directory = tmp_path_factory.mktemp("ray_unit")
    config = configure()
    return config, synthesise(Bench(ray_unit, directory, config).verilog, directory / "netlist", top="ray_unit")


def test_ray_unit(unit, leaf_of, random):
    config, made = unit
    leaf = leaf_of(ray_unit, config)
    assert made.cells["LUT4"] > 500
    assert made.cells["TRELLIS_FF"] > 200
    leaf.verilog = made.files
    check_ray_unit(leaf, config, random, rays=100)


def test_broken_cell_is_noticed(unit, leaf_of, tmp_path, random):
    """A single changed carry cell among hundreds of cells makes wrong pixels."""
    config, made = unit
    *models, file = made.files
    text, sound = file.read_text(), 'INJECT1_0("NO")'
    instances = re.findall(r"^  CCU2C #\([^;]*;", text, re.MULTILINE)
    chosen = next(one for one in instances if "colour_sum_0_i.total" in one and sound in one)
    changed = tmp_path / "netlist.v"
    changed.write_text(text.replace(chosen, chosen.replace(sound, 'INJECT1_0("YES")')))
    leaf = leaf_of(ray_unit, config)
    leaf.verilog = [*models, changed]
    with pytest.raises(AssertionError, match=r"ray_unit, cycle \d+: Verilog .*, MyHDL "):
        check_ray_unit(leaf, config, random)


SMALL = """
module small (input clk, input [3:0] a, input [3:0] b, output reg [3:0] sum);
    always @(posedge clk) sum <= a + b;
endmodule
"""


def synthesise_small(text: str, directory: Path) -> Netlist:
    source = directory / "small.v"
    source.write_text(text)
    return synthesise([source], directory / "netlist", top="small")


def test_synthesised_once(tmp_path):
    """Unchanged files are found, changed ones are not, and the same files give the same bytes elsewhere."""
    first = synthesise_small(SMALL, tmp_path)
    text = first.files[-1].read_bytes()
    assert first.fresh
    assert first.cells["TRELLIS_FF"] == 4
    assert not synthesise_small(SMALL, tmp_path).fresh
    changed = synthesise_small(SMALL.replace("a + b", "a - b"), tmp_path)
    assert changed.fresh
    assert changed.files[-1].read_bytes() != text
    again = synthesise_small(SMALL, emptied(tmp_path / "again"))
    assert again.fresh
    assert again.files[-1].read_bytes() == text


def test_cell_without_model(tmp_path):
    """An error is better than a netlist that no simulator can build."""
    library_cell = "EHXPLLL pll (.CLKI(clk), .CLKOP(sum[0]));"
    text = SMALL.replace("output reg [3:0] sum", "output [3:0] sum")
    text = re.sub(r"always.*;", library_cell + " assign sum[3:1] = 0;", text)
    for _ in range(2):
        with pytest.raises(NetlistError, match="has cells without a model: EHXPLLL"):
            synthesise_small(text, tmp_path)


def test_missing_yosys_gets_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(netlist, "find_spec", lambda name: None)
    error = refusal(tmp_path, "sim", "--gates", str(SMALL_SCENE))
    assert error.startswith("Yosys is missing; it comes with the extra formal: ")


def test_default_design():
    """By default one small design shows all plain scenes in time, each with its own number of reflections."""
    scenes = list(packaged_scenes(plain=True).values())
    runs = simulate.plan_runs(scenes, {}, simulate.GATES_OPTIONS)
    assert len(simulate.configurations(runs)) == 1
    assert runs[0].configuration.screen == "tiny"
    assert {run.reflections for run in runs} == {0, 1, 2}
    runs = simulate.plan_runs(scenes, {"units": "32", "reflections": "1"}, simulate.GATES_OPTIONS)
    assert {(run.configuration.units, run.reflections) for run in runs} == {(32, 1)}
