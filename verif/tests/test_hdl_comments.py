# SPDX-License-Identifier: MIT
"""Docstrings and comments stand in the Verilog, in its words."""

from pathlib import Path

from hdl_blocks import converted
from myhdl import always_comb, always_seq, block

from raycaster.convert.vocabulary import VOCABULARY
from raycaster.design.decide import configure
from raycaster.hdl.signals import bit, reset_signal
from raycaster.rtl.common.interfaces import Place
from raycaster.rtl.common.records import Signs


@block
def with_documented_ports(clk, reset, value, slope, pair, cycles: int, config=None):
    """Do nothing, `config.units` times in `SETUP_LATENCY` cycles.

    Without config.turn it is `slope.dx` that is not read, whatever config.rounding says.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        value: flag; read for `unit_bits` units with slope.dy,
            or not at all; None with config.turn, and where nothing reads it.
        slope: `Signs`. None where there is no ray. Read `cycles` cycles later.
        pair: `Place`; output.
        cycles: no port.
    """

    # With config.materials a row has `config.screen_geometry.doubling` lines.
    @always_seq(clk.posedge, reset=reset)
    def copy():
        pair.row.next = value + slope.dz

    @always_comb
    def join():
        pair.column_offset.next = value

    return copy, join


def test_ports_and_processes_have_their_comments(tmp_path):
    """Each argument's text stands above its first port; numbers, options and Verilog names replace Python expressions.
    A process needs no comment."""
    config = configure(units=32)
    top = with_documented_ports(bit(), reset_signal(), bit(), Signs(), Place(config), 3, config)
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
    // synchronous, active high.
    input  wire       reset,
    // flag; read for 5 units with slope_dy, or not at all.
    input  wire       value,
    // Signs. Read 3 cycles later.
    // [2] dx, [1] dy, [0] dz.
    input  wire [2:0] slope_word,
    // pair_*: Place; output.
    // row of rays, 0 at the top.
    output reg  [7:0] pair_row,
    // number of the group in its row.
    output wire [3:0] pair_column_offset
"""
    )
    assert "\n\n// With MATERIALS=1 a row has 2 lines.\nalways @" in body
    assert body.endswith("end\n\nassign pair_column_offset = value;\n\nendmodule\n")


def test_verilog_is_the_same_in_a_second_conversion(tmp_path):
    """No name depends on what was converted before."""
    plain = converted_texts(tmp_path)
    assert plain == converted_texts(tmp_path)
    assert "// Do nothing, 32 times in 5 cycles." in plain[0] and "function [5:0] total;" in plain[1]


def converted_texts(directory: Path) -> list[str]:
    """Convert blocks with docstrings, functions and labels."""
    import test_hdl_programs as programs  # noqa: PLC0415 - its table would be a second one of this file's tests

    config = configure(units=32)
    top = with_documented_ports(bit(), reset_signal(), bit(), Signs(), Place(config), 3, config)
    texts = [converted(top, directory, vocabulary=VOCABULARY)["with_documented_ports"].path.read_text()]
    for block_, makers, *_ in (one.values for one in programs.PROGRAMS if "functions" in one.id or "loops" in one.id):
        made = block_(**{name: programs.argument(maker) for name, maker in makers.items()})
        texts += [module.path.read_text() for module in converted(made, directory).values()]
    return texts
