# SPDX-License-Identifier: MIT
"""Simulate ECP5 multipliers with internal product registers and compare them with the products in MyHDL."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from myhdl import always, always_comb, block, instances

from raycaster.fpga.multipliers import connect_register, register_products
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, signed
from raycaster.sim.netlist import LIBRARIES, cell_models, find_yosys
from raycaster.tools import run_yosys
from raycaster.verif.seeds import seed

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


def simulate(leaf: Leaf, made: Path) -> None:
    """Compare the netlist's outputs with those of MyHDL."""
    run_yosys(made.parent, "write", [f"read_json {made.name}", "write_verilog -noattr -noexpr netlist.v"])
    random = np.random.default_rng(seed())
    ranges = {"enable": (0, 2), "reset": (0, 2), "a": (-512, 512), "b": (-256, 256)}
    stimulus = [{name: int(random.integers(*each)) for name, each in ranges.items()} for _ in range(300)]
    leaf.run_both([{"enable": 1, "reset": 1}] * 3 + stimulus, settled=3)


def test_products_in_the_multipliers_registers(tmp_path):
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
    simulate(leaf, made)

    design = json.loads(made.read_text())
    module = design["modules"]["products"]
    [clock] = module["ports"]["clk"]["bits"]
    for cell in module["cells"].values():
        if cell["type"] == "MULT18X18D":
            connect_register(cell, clock)
    made.write_text(json.dumps(design))
    with pytest.raises(AssertionError, match="Verilog"):
        simulate(leaf, made)
