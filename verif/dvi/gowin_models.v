// SPDX-License-Identifier: MIT
// Simulation models of the Gowin cells that tops use, with frequencies, phases and edges only.

`timescale 1ns / 1ps

// The PLL, with internal feedback; it locks after eight input cycles.
module rPLL #(
    parameter FCLKIN = "100.0",
    parameter DEVICE = "GW1N-1",
    parameter IDIV_SEL = 0,
    parameter FBDIV_SEL = 0,
    parameter ODIV_SEL = 8,
    parameter DYN_IDIV_SEL = "false",
    parameter DYN_FBDIV_SEL = "false",
    parameter DYN_ODIV_SEL = "false",
    parameter PSDA_SEL = "0000",
    parameter DUTYDA_SEL = "1000",
    parameter DYN_DA_EN = "false",
    parameter CLKOUT_FT_DIR = 1'b1,
    parameter CLKOUTP_FT_DIR = 1'b1,
    parameter CLKOUT_DLY_STEP = 0,
    parameter CLKOUTP_DLY_STEP = 0,
    parameter CLKFB_SEL = "internal",
    parameter CLKOUT_BYPASS = "false",
    parameter CLKOUTP_BYPASS = "false",
    parameter CLKOUTD_BYPASS = "false",
    parameter DYN_SDIV_SEL = 2,
    parameter CLKOUTD_SRC = "CLKOUT",
    parameter CLKOUTD3_SRC = "CLKOUT"
) (
    input wire CLKIN, CLKFB, RESET, RESET_P,
    input wire [5:0] FBDSEL, IDSEL, ODSEL,
    input wire [3:0] PSDA, FDLY, DUTYDA,
    output reg CLKOUT = 1'b0,
    output reg LOCK = 1'b0
);
    realtime rose;
    real half;

    initial begin
        @(posedge CLKIN) rose = $realtime;
        @(posedge CLKIN) half = ($realtime - rose) * (IDIV_SEL + 1) / (FBDIV_SEL + 1) / 2;
        forever #(half) CLKOUT = ~CLKOUT;
    end

    initial begin
        repeat (8) @(posedge CLKIN);
        LOCK = 1'b1;
    end
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

// Two bits per cycle: D0 while the clock is high, D1 while it is low, both sampled at the rising edge.
module ODDR (
    input wire D0, D1, TX, CLK,
    output wire Q0
);
    reg first, second;

    always @(posedge CLK) begin
        first <= D0;
        second <= D1;
    end

    assign Q0 = CLK ? first : second;
endmodule

module TLVDS_OBUF (
    input wire I,
    output wire O, OB
);
    assign O = I;
    assign OB = ~I;
endmodule
