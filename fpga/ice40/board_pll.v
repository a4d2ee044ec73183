// SPDX-License-Identifier: MIT
// From the board's oscillator, clk for the design. board_clocks.v, made with the design, says which.

module board_pll #(
    // clk_in / (DIVR + 1) * (DIVF + 1) is the oscillator's, within its 533 to 1066 MHz; that by 2 to the DIVQ is clk.
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
