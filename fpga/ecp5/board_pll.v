// SPDX-License-Identifier: MIT
// From the board's oscillator, shift_clk for the DVI link, five times the pixel clock, and clk for the design, which is
// the pixel clock or twice that. board_clocks.v, made with the design, says which.

module board_pll #(
    // clk_in / CLKI_DIV * CLKFB_DIV is shift_clk, and SHIFT_DIV times that the oscillator's, within its 400 to 800 MHz;
    // that by CLK_DIV is clk.
    parameter CLKI_DIV = 1,
    parameter CLKFB_DIV = 5,
    parameter SHIFT_DIV = 4,
    parameter CLK_DIV = 10
) (
    input  wire clk_in,
    output wire clk,
    output wire shift_clk,
    output wire locked
);

// A phase of the divider less one puts the rising edges together. nextpnr takes an analogue setting that is not given as
// 0, no charge pump among them; these are those of ecppll.
(* ICP_CURRENT="12" *) (* LPF_RESISTOR="8" *) (* MFG_ENABLE_FILTEROPAMP="1" *) (* MFG_GMCREF_SEL="2" *)
EHXPLLL #(
    .CLKI_DIV(CLKI_DIV),
    .CLKFB_DIV(CLKFB_DIV),
    .FEEDBK_PATH("CLKOP"),
    .CLKOP_ENABLE("ENABLED"),
    .CLKOP_DIV(SHIFT_DIV),
    .CLKOP_CPHASE(SHIFT_DIV - 1),
    .CLKOP_FPHASE(0),
    .CLKOS_ENABLE("ENABLED"),
    .CLKOS_DIV(CLK_DIV),
    .CLKOS_CPHASE(CLK_DIV - 1),
    .CLKOS_FPHASE(0),
    .CLKOS2_ENABLE("DISABLED"),
    .CLKOS3_ENABLE("DISABLED"),
    .OUTDIVIDER_MUXA("DIVA"),
    .OUTDIVIDER_MUXB("DIVB"),
    .DPHASE_SOURCE("DISABLED"),
    .PLLRST_ENA("DISABLED"),
    .INTFB_WAKE("DISABLED"),
    .STDBY_ENABLE("DISABLED")
) pll (
    .CLKI(clk_in),
    .CLKFB(shift_clk),
    .RST(1'b0),
    .STDBY(1'b0),
    .PHASESEL0(1'b0),
    .PHASESEL1(1'b0),
    .PHASEDIR(1'b1),
    .PHASESTEP(1'b1),
    .PHASELOADREG(1'b1),
    .PLLWAKESYNC(1'b0),
    .ENCLKOP(1'b0),
    .CLKOP(shift_clk),
    .CLKOS(clk),
    .LOCK(locked)
);

endmodule
