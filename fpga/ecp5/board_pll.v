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

generate
    if (FIRST_DIV == 0) begin : one
        assign reference = clk_in;
        assign first_locked = 1'b1;
    end else begin : two
        wire feedback;

        tuned_pll #(
            .CLKI_DIV(FIRST_CLKI_DIV), .CLKFB_DIV(1), .FEEDBK_PATH("CLKOS"), .CLKOP_DIV(FIRST_DIV),
            .CLKOS_DIV(FIRST_FB_DIV), .PLLRST_ENA("DISABLED")
        ) pll (
            .reset(1'b0), .clk_in(clk_in), .feedback(feedback), .clk_op(reference), .clk_os(feedback),
            .locked(first_locked)
        );
    end
endgenerate

// Without a reference, the PLL is held in reset.
tuned_pll #(
    .CLKI_DIV(CLKI_DIV), .CLKFB_DIV(CLKFB_DIV), .FEEDBK_PATH("CLKOP"), .CLKOP_DIV(SHIFT_DIV), .CLKOS_DIV(CLK_DIV),
    .PLLRST_ENA("ENABLED")
) pll (
    .reset(!first_locked), .clk_in(reference), .feedback(shift_clk), .clk_op(shift_clk), .clk_os(clk),
    .locked(last_locked)
);

endmodule

// A PLL with two outputs, whose rising edges are aligned, as the phase of a divider minus one does. nextpnr sets missing
// analogue parameters to 0, for example to no charge pump; these values come from ecppll.
module tuned_pll #(
    parameter CLKI_DIV = 1, CLKFB_DIV = 1, FEEDBK_PATH = "CLKOP", CLKOP_DIV = 8, CLKOS_DIV = 8, PLLRST_ENA = "DISABLED"
) (
    input  wire reset,
    input  wire clk_in,
    input  wire feedback,               // the output that FEEDBK_PATH names
    output wire clk_op,
    output wire clk_os,
    output wire locked
);

(* ICP_CURRENT="12" *) (* LPF_RESISTOR="8" *) (* MFG_ENABLE_FILTEROPAMP="1" *) (* MFG_GMCREF_SEL="2" *)
EHXPLLL #(
    .CLKI_DIV(CLKI_DIV),
    .CLKFB_DIV(CLKFB_DIV),
    .FEEDBK_PATH(FEEDBK_PATH),
    .CLKOP_ENABLE("ENABLED"),
    .CLKOP_DIV(CLKOP_DIV),
    .CLKOP_CPHASE(CLKOP_DIV - 1),
    .CLKOP_FPHASE(0),
    .CLKOS_ENABLE("ENABLED"),
    .CLKOS_DIV(CLKOS_DIV),
    .CLKOS_CPHASE(CLKOS_DIV - 1),
    .CLKOS_FPHASE(0),
    .CLKOS2_ENABLE("DISABLED"),
    .CLKOS3_ENABLE("DISABLED"),
    .OUTDIVIDER_MUXA("DIVA"),
    .OUTDIVIDER_MUXB("DIVB"),
    .DPHASE_SOURCE("DISABLED"),
    .PLLRST_ENA(PLLRST_ENA),
    .INTFB_WAKE("DISABLED"),
    .STDBY_ENABLE("DISABLED")
) pll (
    .CLKI(clk_in),
    .CLKFB(feedback),
    .RST(reset),
    .STDBY(1'b0),
    .PHASESEL0(1'b0),
    .PHASESEL1(1'b0),
    .PHASEDIR(1'b1),
    .PHASESTEP(1'b1),
    .PHASELOADREG(1'b1),
    .PLLWAKESYNC(1'b0),
    .ENCLKOP(1'b0),
    .CLKOP(clk_op),
    .CLKOS(clk_os),
    .LOCK(locked)
);

endmodule
