# SPDX-License-Identifier: MIT
"""A clock gate, in Verilog only; MyHDL simulates the ungated clock."""

from pathlib import Path

from myhdl import block

from raycaster.hdl.given import given_verilog


@given_verilog(lambda: Path(__file__).with_suffix(".v"), outputs=("gated_clk",))
@block
def clock_gate(clk, reset, awake, gated_clk):
    """Gate a clock: gated_clk is clk without the rising edges at which both reset and awake are low.

    The gate exists only if the Verilog macro CLOCK_GATING is defined; otherwise gated_clk is clk, so the gated blocks
    must work with either clock. MyHDL does not simulate the gate.

    Args:
        reset: synchronous, active high; the clock runs during reset.
        awake: flag, stable while clk is low; low when the clock may stop.
        gated_clk: output; a `derived_clock` of clk.
    """
    return ()
