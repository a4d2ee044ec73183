# SPDX-License-Identifier: MIT
"""A clock gate, in Verilog only; MyHDL simulates the ungated clock."""

from pathlib import Path

from myhdl import block

from raycaster.hdl.given import given_verilog


@given_verilog(lambda: Path(__file__).with_suffix(".v"), outputs=("gated_clk",))
@block
def clock_gate(clk, awake, gated_clk):
    """Gate a clock: gated_clk is clk without the rising edges at which awake is low.

    The gate exists only if the Verilog macro CLOCK_GATING is defined; otherwise gated_clk is clk, so the gated blocks
    must work with either clock. MyHDL does not simulate the gate.

    Args:
        clk: the clock.
        awake: flag, from registers of clk; low when the clock may stop.
        gated_clk: output clock; connected by rests_on only.
    """
    return ()


def rests_on(gated_clk, *blocks) -> None:
    """Connect the `clk` of these blocks to a clock_gate's output in their parent's Verilog.

    In MyHDL they keep the clock of their arguments: a derived clock would rise only after the registers of its source
    clock had changed.
    """
    for one in blocks:
        one.verilog_clk = gated_clk
