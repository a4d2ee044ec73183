// SPDX-License-Identifier: MIT
// Simulation models of the ECP5 and Gowin cells that tops use, with frequencies, phases and edges only.

`timescale 1ns / 1ps

// The oscillator of a PLL: tick changes HALVES * FEEDBACK / REFERENCE / 2 times per cycle of the input; it locks after
// eight cycles.
module pll_oscillator #(
    parameter REFERENCE = 1, parameter FEEDBACK = 1, parameter HALVES = 2
) (
    input wire clk_in,
    output reg tick = 1'b0,
    output reg locked = 1'b0
);
    realtime rose;
    real half;

    initial begin
        @(posedge clk_in) rose = $realtime;
        @(posedge clk_in) half = ($realtime - rose) * REFERENCE / FEEDBACK / HALVES;
        forever begin
            tick = ~tick;
            #(half);
        end
    end

    initial begin
        repeat (8) @(posedge clk_in);
        locked = 1'b1;
    end
endmodule

// Two bits per cycle: d0 while the clock is high, d1 while it is low, both sampled at the rising edge.
module ddr_output (
    input wire clk, d0, d1,
    output wire q
);
    reg first, second;

    always @(posedge clk) begin
        first <= d0;
        second <= d1;
    end

    assign q = clk ? first : second;
endmodule

// ECP5: the PLL, with feedback from CLKOP. Parameters from FEEDBK_PATH on have no effect here.
module EHXPLLL #(
    parameter CLKI_DIV = 1, CLKFB_DIV = 1, CLKOP_DIV = 8, CLKOP_CPHASE = 0, CLKOS_DIV = 8, CLKOS_CPHASE = 0,
    FEEDBK_PATH = "", CLKOP_ENABLE = "", CLKOP_FPHASE = 0, CLKOS_ENABLE = "", CLKOS_FPHASE = 0, CLKOS2_ENABLE = "",
    CLKOS3_ENABLE = "", OUTDIVIDER_MUXA = "", OUTDIVIDER_MUXB = "", DPHASE_SOURCE = "", PLLRST_ENA = "",
    INTFB_WAKE = "", STDBY_ENABLE = ""
) (
    input wire CLKI, CLKFB, RST, STDBY, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP,
    output reg CLKOP = 1'b0,
    output reg CLKOS = 1'b0,
    output wire LOCK
);
    wire tick;
    pll_oscillator #(.REFERENCE(CLKI_DIV), .FEEDBACK(CLKFB_DIV), .HALVES(2 * CLKOP_DIV)) oscillator (
        .clk_in(CLKI), .tick(tick), .locked(LOCK)
    );

    // Both outputs count the oscillator's half periods, so that rounding cannot separate them; their rising edges
    // coincide if each phase is its divider minus one.
    integer op_count = 2 * (CLKOP_DIV - 1 - CLKOP_CPHASE);
    integer os_count = 2 * (CLKOS_DIV - 1 - CLKOS_CPHASE);
    always @(tick) begin
        op_count = op_count == 2 * CLKOP_DIV - 1 ? 0 : op_count + 1;
        os_count = os_count == 2 * CLKOS_DIV - 1 ? 0 : os_count + 1;
        CLKOP = op_count < CLKOP_DIV;
        CLKOS = os_count < CLKOS_DIV;
    end
endmodule

module ODDRX1F (
    input wire SCLK, RST, D0, D1,
    output wire Q
);
    ddr_output ddr (.clk(SCLK), .d0(D0), .d1(D1), .q(Q));
endmodule

// Gowin: the PLL, with internal feedback. Parameters from FCLKIN on have no effect here.
module rPLL #(
    parameter IDIV_SEL = 0, FBDIV_SEL = 0,
    FCLKIN = "", DEVICE = "", ODIV_SEL = 8, DYN_IDIV_SEL = "", DYN_FBDIV_SEL = "", DYN_ODIV_SEL = "", PSDA_SEL = "",
    DUTYDA_SEL = "", DYN_DA_EN = "", CLKOUT_FT_DIR = 1'b1, CLKOUTP_FT_DIR = 1'b1, CLKOUT_DLY_STEP = 0,
    CLKOUTP_DLY_STEP = 0, CLKFB_SEL = "", CLKOUT_BYPASS = "", CLKOUTP_BYPASS = "", CLKOUTD_BYPASS = "",
    DYN_SDIV_SEL = 2, CLKOUTD_SRC = "", CLKOUTD3_SRC = ""
) (
    input wire CLKIN, CLKFB, RESET, RESET_P,
    input wire [5:0] FBDSEL, IDSEL, ODSEL,
    input wire [3:0] PSDA, FDLY, DUTYDA,
    output wire CLKOUT, LOCK
);
    pll_oscillator #(.REFERENCE(IDIV_SEL + 1), .FEEDBACK(FBDIV_SEL + 1)) oscillator (
        .clk_in(CLKIN), .tick(CLKOUT), .locked(LOCK)
    );
endmodule

// Divides HCLKIN by two or by five.
module CLKDIV #(
    parameter DIV_MODE = "2"
) (
    input wire HCLKIN, RESETN, CALIB,
    output reg CLKOUT = 1'b0
);
    localparam integer HALVES = DIV_MODE == "5" ? 5 : 2;
    integer count = 0;

    always @(HCLKIN) begin
        count = count == HALVES - 1 ? 0 : count + 1;
        if (count == 0)
            CLKOUT = ~CLKOUT;
    end
endmodule

module ODDR (
    input wire D0, D1, TX, CLK,
    output wire Q0
);
    ddr_output ddr (.clk(CLK), .d0(D0), .d1(D1), .q(Q0));
endmodule

module TLVDS_OBUF (
    input wire I,
    output wire O, OB
);
    assign O = I;
    assign OB = ~I;
endmodule
