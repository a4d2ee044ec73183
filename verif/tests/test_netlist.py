# SPDX-License-Identifier: MIT
"""Netlists behave like the Verilog: a ray unit, a design in a frame, and multipliers with internal registers."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, called, refusal
from engine_vectors import check_ray_unit
from myhdl import always, always_comb, block, instances

from raycaster.configuration import configure
from raycaster.fpga.multipliers import connect_register, register_products
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, signed
from raycaster.output import emptied
from raycaster.rtl.seed.ray_unit import ray_unit
from raycaster.scene import packaged_scenes
from raycaster.sim import netlist
from raycaster.sim import scenes as simulate
from raycaster.sim.netlist import LIBRARIES, Netlist, NetlistError, cell_models, find_yosys, synthesise
from raycaster.tools import run_yosys

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


def test_ray_unit(leaf_of, random, tmp_path):
    config = configure()
    leaf = leaf_of(ray_unit, config)
    made = synthesise(leaf.verilog, tmp_path / "netlist", top="ray_unit")
    assert made.cells["LUT4"] > 500
    assert made.cells["TRELLIS_FF"] > 200
    leaf.verilog = made.files
    check_ray_unit(leaf, config, random, rays=100)


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


# Multipliers of the ECP5, whose registers take those of products -----------------------------------------------------


OUTPUTS = {"plain": 19, "narrow": 12, "enabled": 19, "cleared": 19, "added": 20, "twice": 19, "now": 19, "later": 19}
"""Width of each output; only `plain` and `narrow` are registers that alone read a product."""


@block
def products(clk, enable, reset, a, b, plain, narrow, enabled, cleared, added, twice, now, later):
    """Products, each read by a register of another kind."""
    plain_product, narrow_product, enabled_product, cleared_product, added_product, twice_product, again, product = (
        signed(19) for _ in range(8)
    )

    @always_comb
    def multiply():
        plain_product.next = a * b
        narrow_product.next = (a + 1) * b
        enabled_product.next = a * (b + 1)
        cleared_product.next = (a + 2) * b
        added_product.next = a * (b + 2)
        twice_product.next = (a + 3) * b
        product.next = a * (b + 3)

    @always_comb
    def show():
        now.next = product

    @always(clk.posedge)
    def register():
        plain.next = plain_product
        narrow.next = narrow_product[12:].signed()
        if enable:
            enabled.next = enabled_product
        if reset:
            cleared.next = 0
        else:
            cleared.next = cleared_product
        added.next = added_product + 1
        later.next = product
        again.next = twice_product
        twice.next = again ^ twice_product

    return instances()


A, B, P = ([f"{name}{place}" for place in range(width)] for name, width in (("A", 18), ("B", 18), ("P", 36)))
MODEL = f"""
module MULT18X18D #(
    parameter REG_OUTPUT_CLK = "NONE"
) (
    input {", ".join([*A, *B])}, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, CLK0, CE0, RST0,
    input {", ".join(f"C{place}" for place in range(18))},
    output {", ".join(P)}
);
wire signed [18:0] a = {{SIGNEDA & A17, {", ".join(reversed(A))}}}, b = {{SIGNEDB & B17, {", ".join(reversed(B))}}};
wire signed [37:0] product = a * b;
reg [35:0] held = 0;
always @(posedge CLK0) if (RST0) held <= 0; else if (CE0) held <= product[35:0];
assign {{{", ".join(reversed(P))}}} = REG_OUTPUT_CLK == "CLK0" ? held : product[35:0];
endmodule
"""


def check_products(leaf: Leaf, made: Path, random: np.random.Generator) -> None:
    """Compare the netlist's outputs with those of MyHDL."""
    run_yosys(made.parent, "write", [f"read_json {made.name}", "write_verilog -noattr -noexpr netlist.v"])
    ranges = {"enable": (0, 2), "reset": (0, 2), "a": (-512, 512), "b": (-256, 256)}
    stimulus = [{name: int(random.integers(*each)) for name, each in ranges.items()} for _ in range(300)]
    leaf.run_both([{"enable": 1, "reset": 1}] * 3 + stimulus, settled=3)


def test_products_in_the_multipliers_registers(tmp_path, random):
    """Plain registers that alone read a product, plain and narrow, move into the multiplier; no output changes. A
    product that is registered in the fabric too arrives a cycle late, so the model has registers."""
    widths = {"clk": 1, "enable": 1, "reset": 1, "a": 10, "b": 9} | OUTPUTS

    def ports() -> dict[str, object]:
        return {name: bit() if width == 1 else signed(width) for name, width in widths.items()}

    leaf = Leaf(products, ports, tmp_path)
    made = tmp_path / "made.json"
    run_yosys(tmp_path, "make", ["read_verilog products.v", f"synth_ecp5 -top products -json {made.name}"])
    for name, text in {"cells": cell_models(LIBRARIES["ecp5"], find_yosys() / "ecp5"), "model": MODEL}.items():
        (tmp_path / f"{name}.v").write_text(text)
    leaf.verilog = [tmp_path / f"{name}.v" for name in ("netlist", "model", "cells")]

    def cells() -> Counter:
        return Counter(cell["type"] for cell in json.loads(made.read_text())["modules"]["products"]["cells"].values())

    before = cells()
    assert register_products(made) == 2
    assert before - cells() == Counter(TRELLIS_FF=OUTPUTS["plain"] + OUTPUTS["narrow"])
    check_products(leaf, made, random)

    design = json.loads(made.read_text())
    module = design["modules"]["products"]
    [clock] = module["ports"]["clk"]["bits"]
    for cell in module["cells"].values():
        if cell["type"] == "MULT18X18D":
            connect_register(cell, clock)
    made.write_text(json.dumps(design))
    with pytest.raises(AssertionError, match="Verilog"):
        check_products(leaf, made, random)
