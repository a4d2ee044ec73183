# SPDX-License-Identifier: MIT
"""Docstrings and comments stand in the Verilog, in its words."""

import ast
import re
from pathlib import Path

import pytest
from hdl_blocks import converted, step
from myhdl import always, always_comb, block

from raycaster import rtl
from raycaster.configuration import configure
from raycaster.convert.vocabulary import VOCABULARY
from raycaster.hdl.signals import bit, unconnected, unsigned
from raycaster.rtl.common.interfaces import Place
from raycaster.rtl.common.records import Signs


@block
def few_words(clk, value, kept, both, either, stepped):
    """Connect processes that are mostly self-explanatory."""

    @always(clk.posedge)
    def keep():
        kept.next = value

    @always_comb
    def join():
        both.next = kept & value

    # The reason for this one is not plain.
    @always_comb
    def choose():
        either.next = kept | value

    stepping = step(clk, value, kept, stepped, unconnected(1))

    return keep, join, choose, stepping


def test_a_process_needs_no_comment(tmp_path):
    modules = converted(few_words(bit(), *(unsigned(4) for _ in range(5))), tmp_path)
    _, _, body = modules["few_words"].path.read_text().partition(");\n\n")
    assert (
        body
        == """always @(posedge clk) begin
    kept <= value;
end

assign both = kept & value;

// The reason for this one is not plain.
assign either = kept | value;

step step_i (
    .clk(clk),
    .value(value),
    .step_by(kept),
    .stepped(stepped),
    .wrapped()
);

endmodule
"""
    )


@block
def with_documented_ports(clk, value, slope, pair, cycles: int, config=None):
    """Do nothing, `config.units` times in `SETUP_LATENCY` cycles.

    Without config.turn it is `slope.dx` that is not read, whatever config.rounding says.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        value: flag; read for `unit_bits` units with slope.dy,
            or not at all; None with config.turn, and where nothing reads it.
        slope: `Signs`. None where there is no ray. Read `cycles` cycles later.
        pair: `Place`; output.
        cycles: no port.
        config: the design.
    """

    # With config.materials a row has `config.screen_geometry.doubling` lines.
    @always(clk.posedge)
    def copy():
        pair.row.next = value + slope.dz
        pair.column_offset.next = value

    return copy


def test_ports_have_their_comments(tmp_path):
    """Each argument's text precedes its first port, with numbers, options and Verilog names instead of Python's."""
    config = configure(units=32)
    top = with_documented_ports(bit(), bit(), Signs(), Place(config), 3, config)
    modules = converted(top, tmp_path, vocabulary=VOCABULARY)
    head, _, body = modules["with_documented_ports"].path.read_text().partition(");\n\n")
    assert (
        head[head.index("// Do") :]
        == """// Do nothing, 32 times in 5 cycles.
//
// Without TURN=1 it is slope_dx that is not read, whatever ROUNDING says.
module with_documented_ports (
    // the clock, 50 MHz.
    input  wire       clk,
    // flag; read for 5 units with slope_dy, or not at all.
    input  wire       value,
    // Signs. Read 3 cycles later.
    // [2] dx, [1] dy, [0] dz.
    input  wire [2:0] slope_word,
    // pair_*: Place; output.
    // row of rays, 0 at the top.
    output reg  [7:0] pair_row,
    // number of the group in its row.
    output reg  [3:0] pair_column_offset
"""
    )
    assert "// With MATERIALS=1 a row has 2 lines.\nalways @" in body


@pytest.mark.parametrize(
    "path", [path for path in Path(rtl.__file__).parent.glob("*/*.py")], ids=lambda path: path.stem
)
def test_each_port_of_the_hardware_is_documented(path):
    """The docstring of each block lists its arguments in order."""
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.FunctionDef) and any(ast.unparse(one) == "block" for one in node.decorator_list):
            _, _, listed = (ast.get_docstring(node) or "").partition("Args:\n")
            given = [argument.arg for argument in [*node.args.args, *node.args.kwonlyargs]]
            assert re.findall(r"^    (\w+): ", listed, re.M) == given, f"{path}:{node.lineno}"
