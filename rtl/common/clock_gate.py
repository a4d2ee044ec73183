# SPDX-License-Identifier: MIT
"""A clock that rests while nothing needs it, in Verilog; MyHDL simulates the clock that goes on."""

from pathlib import Path

from myhdl import block

from raycaster.rtl.common.given import given_verilog


@given_verilog(lambda: Path(__file__).with_suffix(".v"), outputs=("gated_clk",))
@block
def clock_gate(clk, awake, gated_clk):
    """Gate a clock: gated_clk is clk without the cycles at whose end awake is low.

    awake counts only where the Verilog macro CLOCK_GATING is defined; elsewhere gated_clk is clk, so the gated blocks
    must not depend on whether the clock rests. MyHDL does not simulate the gate.

    Args:
        clk: the clock.
        awake: flag, from registers of clk; low where the clock may rest.
        gated_clk: output clock, for rests_on only.
    """
    return ()


def rests_on(gated_clk, *blocks) -> None:
    """Have the Verilog of these blocks' parent connect their `clk` to a clock_gate's.

    In MyHDL they keep the clock that they were given: a derived clock would rise there after the registers of its
    source had changed.
    """
    for one in blocks:
        one.verilog_clk = gated_clk
