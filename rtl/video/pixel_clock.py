# SPDX-License-Identifier: MIT
"""The monitor's clock, if a pixel takes one clock."""

from myhdl import block, instances

from raycaster.hdl.verbs import assign


@block
def pixel_clock(clk, vga_clk):
    """Invert the clock for the monitor, so that it samples data half a pixel after the rising edge of clk.

    This is the only logic on the clock: sufficient for simulation, and for outputs that stay in the FPGA. A board with
    a DAC replaces this module with its DDR output register, which clocks out 0 in the first half of each clk and 1 in
    the second: on an ECP5 ODDRX1F with D0 = 0, D1 = 1, in Intel's chips ALTDDIO_OUT with datain_h = 0, datain_l = 1.

    Args:
        vga_clk: output, clk inverted.
    """

    invert = assign(vga_clk, lambda: not clk)

    return instances()
