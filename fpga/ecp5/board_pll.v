// SPDX-License-Identifier: MIT
// Makes two clocks from the board's oscillator: shift_clk for the DVI link, five times the pixel clock, and clk for the
// design, the pixel clock or twice that. The generated board_clocks.v sets the parameters.

module board_pll #(
    // If FIRST_DIV is not 0, a first PLL makes reference = clk_in / FIRST_CLKI_DIV * FIRST_FB_DIV / FIRST_DIV; its
    // oscillator runs at clk_in / FIRST_CLKI_DIV * FIRST_FB_DIV. Otherwise reference is clk_in.
    parameter FIRST_CLKI_DIV = 1,
    parameter FIRST_FB_DIV = 1,
    parameter FIRST_DIV = 0,
    // shift_clk = reference / CLKI_DIV * CLKFB_DIV. The PLL's oscillator runs at shift_clk * SHIFT_DIV. clk is the
    // oscillator divided by CLK_DIV. Oscillators run at 400 to 800 MHz, and a phase detector at 10 MHz or more.
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

wire reference, first_locked, last_locked;

assign locked = first_locked & last_locked;

// nextpnr sets missing analogue parameters to 0, for example to no charge pump; these values come from ecppll.
generate
    if (FIRST_DIV == 0) begin : one
        assign reference = clk_in;
        assign first_locked = 1'b1;
    end else begin : two
        wire feedback;

        (* ICP_CURRENT="12" *) (* LPF_RESISTOR="8" *) (* MFG_ENABLE_FILTEROPAMP="1" *) (* MFG_GMCREF_SEL="2" *)
        EHXPLLL #(
            .CLKI_DIV(FIRST_CLKI_DIV),
            .CLKFB_DIV(1),
            .FEEDBK_PATH("CLKOS"),
            .CLKOP_ENABLE("ENABLED"),
            .CLKOP_DIV(FIRST_DIV),
            .CLKOP_CPHASE(FIRST_DIV - 1),
            .CLKOP_FPHASE(0),
            .CLKOS_ENABLE("ENABLED"),
            .CLKOS_DIV(FIRST_FB_DIV),
            .CLKOS_CPHASE(FIRST_FB_DIV - 1),
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
            .CLKFB(feedback),
            .RST(1'b0),
            .STDBY(1'b0),
            .PHASESEL0(1'b0),
            .PHASESEL1(1'b0),
            .PHASEDIR(1'b1),
            .PHASESTEP(1'b1),
            .PHASELOADREG(1'b1),
            .PLLWAKESYNC(1'b0),
            .ENCLKOP(1'b0),
            .CLKOP(reference),
            .CLKOS(feedback),
            .LOCK(first_locked)
        );
    end
endgenerate

// A phase of the divider minus one aligns the rising edges. Without a reference, the PLL is held in reset.
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
    .PLLRST_ENA("ENABLED"),
    .INTFB_WAKE("DISABLED"),
    .STDBY_ENABLE("DISABLED")
) pll (
    .CLKI(reference),
    .CLKFB(shift_clk),
    .RST(!first_locked),
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
    .LOCK(last_locked)
);

endmodule
