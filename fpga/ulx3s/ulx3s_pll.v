// SPDX-License-Identifier: MIT
// From the board's 25 MHz, 50 MHz for the design and 125 MHz for the DVI link, five times the pixel clock.

module ulx3s_pll (
    input  wire clk_25mhz,
    output wire clk,                    // 50 MHz
    output wire shift_clk,              // 125 MHz
    output wire locked
);

// 25 MHz / CLKI_DIV * CLKFB_DIV = 125 MHz at CLKOP, whose divider of 4 makes the oscillator run at 500 MHz, within its
// 400 to 800 MHz; a tenth of that is 50 MHz. A phase of the divider less one puts the rising edges together.
//
// nextpnr takes an analogue setting that is not given as 0, no charge pump among them; these are those of ecppll.
(* ICP_CURRENT="12" *) (* LPF_RESISTOR="8" *) (* MFG_ENABLE_FILTEROPAMP="1" *) (* MFG_GMCREF_SEL="2" *)
EHXPLLL #(
    .CLKI_DIV(1),
    .CLKFB_DIV(5),
    .FEEDBK_PATH("CLKOP"),
    .CLKOP_ENABLE("ENABLED"),
    .CLKOP_DIV(4),
    .CLKOP_CPHASE(3),
    .CLKOP_FPHASE(0),
    .CLKOS_ENABLE("ENABLED"),
    .CLKOS_DIV(10),
    .CLKOS_CPHASE(9),
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
    .CLKI(clk_25mhz),
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
