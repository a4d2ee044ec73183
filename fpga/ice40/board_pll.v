// SPDX-License-Identifier: MIT
// Makes clk for the design from the board's oscillator. The generated board_clocks.v sets the parameters.

module board_pll #(
    // The PLL's oscillator runs at clk_in / (DIVR + 1) * (DIVF + 1), 533 to 1066 MHz; clk is that divided by 2^DIVQ.
    parameter DIVR = 0,
    parameter DIVF = 66,
    parameter DIVQ = 5,
    parameter FILTER_RANGE = 1
) (
    input  wire clk_in,
    output wire clk,
    output wire shift_clk,
    output wire locked
);

assign shift_clk = 1'b0;                // no DVI link

SB_PLL40_PAD #(
    .FEEDBACK_PATH("SIMPLE"),
    .DIVR(DIVR),
    .DIVF(DIVF),
    .DIVQ(DIVQ),
    .FILTER_RANGE(FILTER_RANGE)
) pll (
    .PACKAGEPIN(clk_in),
    .PLLOUTGLOBAL(clk),
    .LOCK(locked),
    .RESETB(1'b1),
    .BYPASS(1'b0)
);

endmodule
