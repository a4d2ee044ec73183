// SPDX-License-Identifier: MIT
// Makes two clocks from the board's oscillator: shift_clk for the DVI link, five times the pixel clock, and clk for the
// design, the pixel clock or twice that. The generated board_clocks.v sets the parameters.

module board_pll #(
    // fast = clk_in / (IDIV_SEL + 1) * (FBDIV_SEL + 1). The PLL's oscillator runs at fast * ODIV_SEL, 500 to 1250 MHz.
    // clk = fast / 5; shift_clk = fast / 2 if HALVED, otherwise fast.
    parameter FCLKIN = "27",
    parameter IDIV_SEL = 3,
    parameter FBDIV_SEL = 36,
    parameter ODIV_SEL = 4,
    parameter HALVED = 1
) (
    input  wire clk_in,
    output wire clk,
    output wire shift_clk,
    output wire locked
);

wire fast;

rPLL #(
    .FCLKIN(FCLKIN),
    .DEVICE("GW2AR-18C"),
    .IDIV_SEL(IDIV_SEL),
    .FBDIV_SEL(FBDIV_SEL),
    .ODIV_SEL(ODIV_SEL),
    .DYN_IDIV_SEL("false"),
    .DYN_FBDIV_SEL("false"),
    .DYN_ODIV_SEL("false"),
    .PSDA_SEL("0000"),
    .DUTYDA_SEL("1000"),
    .DYN_DA_EN("false"),
    .CLKOUT_FT_DIR(1'b1),
    .CLKOUTP_FT_DIR(1'b1),
    .CLKOUT_DLY_STEP(0),
    .CLKOUTP_DLY_STEP(0),
    .CLKFB_SEL("internal"),
    .CLKOUT_BYPASS("false"),
    .CLKOUTP_BYPASS("false"),
    .CLKOUTD_BYPASS("false"),
    .DYN_SDIV_SEL(2),
    .CLKOUTD_SRC("CLKOUT"),
    .CLKOUTD3_SRC("CLKOUT")
) pll (
    .CLKIN(clk_in),
    .CLKFB(1'b0),
    .RESET(1'b0),
    .RESET_P(1'b0),
    .FBDSEL(6'b0),
    .IDSEL(6'b0),
    .ODSEL(6'b0),
    .PSDA(4'b0),
    .FDLY(4'b0),
    .DUTYDA(4'b0),
    .CLKOUT(fast),
    .LOCK(locked)
);

CLKDIV #(.DIV_MODE("5")) fifth (.HCLKIN(fast), .RESETN(locked), .CALIB(1'b0), .CLKOUT(clk));

generate
    if (HALVED)
        CLKDIV #(.DIV_MODE("2")) half (.HCLKIN(fast), .RESETN(locked), .CALIB(1'b0), .CLKOUT(shift_clk));
    else
        assign shift_clk = fast;
endgenerate

endmodule
