// SPDX-License-Identifier: MIT
// Simulation models of the ECP5, iCE40 and Gowin cells that tops use, with frequencies, phases and edges only. A PLL
// whose dividers, frequencies or feedback depart from its data sheet does not lock.

`timescale 1ns / 1ps

// The oscillator of a PLL and its lock: tick changes twice per cycle of the oscillator. The oscillator's frequency is that
// of the input, divided by REFERENCE and multiplied by FEEDBACK * LOOP. It locks if feedback has FEEDBACK edges per REFERENCE edges of
// the input. Limits of the phase comparison and the oscillator are in MHz.
module pll_oscillator #(
    parameter REFERENCE = 1, FEEDBACK = 1, LOOP = 1, LEGAL = 1,
    COMPARED_LEAST = 1, COMPARED_MOST = 1, LEAST = 1, MOST = 1
) (
    input wire clk_in, feedback, reset,
    output reg tick = 1'b0,
    output reg locked = 1'b0
);
    localparam integer PERIODS = 8;

    realtime rose;
    real compared, oscillator;
    reg runs = 1'b0;
    integer edges = 0, cycles = 0;

    initial begin
        // A reference from another PLL is steady once that has locked.
        wait (!reset);
        repeat (2) @(posedge clk_in);
        rose = $realtime;
        @(posedge clk_in) compared = 1000 / ($realtime - rose) / REFERENCE;
        oscillator = compared * FEEDBACK * LOOP;
        // The period is known to a picosecond.
        runs = LEGAL && compared > COMPARED_LEAST * 0.999 && compared < COMPARED_MOST * 1.001
            && oscillator > LEAST * 0.999 && oscillator < MOST * 1.001;
        if (!runs)
            $display("illegal PLL: compares at %0.3f MHz, oscillates at %0.3f MHz", compared, oscillator);
        while (runs) begin
            if (!reset)
                tick = ~tick;
            #(500 / oscillator);
        end
    end

    always @(posedge feedback)
        edges = edges + 1;

    always @(posedge clk_in)
        if (reset || !runs) begin
            locked = 1'b0;
            cycles = 0;
            edges = 0;
        end else if (cycles == PERIODS * REFERENCE) begin
            locked = edges >= PERIODS * FEEDBACK - 1 && edges <= PERIODS * FEEDBACK + 1;
            cycles = 1;
            edges = 0;
        end else
            cycles = cycles + 1;
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

// ECP5: the PLL, with feedback from CLKOP or CLKOS. Limits are those of FPGA-DS-02012, dividers those of FPGA-TN-02200.
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
    pll_oscillator #(
        .REFERENCE(CLKI_DIV), .FEEDBACK(CLKFB_DIV), .LOOP(FEEDBK_PATH == "CLKOP" ? CLKOP_DIV : CLKOS_DIV),
        .LEGAL((FEEDBK_PATH == "CLKOP" || FEEDBK_PATH == "CLKOS") && CLKI_DIV >= 1 && CLKI_DIV <= 128
            && CLKFB_DIV >= 1 && CLKFB_DIV <= 80 && CLKOP_DIV >= 1 && CLKOP_DIV <= 128
            && CLKOS_DIV >= 1 && CLKOS_DIV <= 128 && OUTDIVIDER_MUXA == "DIVA" && OUTDIVIDER_MUXB == "DIVB"
            && CLKOP_FPHASE == 0 && CLKOS_FPHASE == 0),
        .COMPARED_LEAST(10), .COMPARED_MOST(400), .LEAST(400), .MOST(800)
    ) oscillator (
        .clk_in(CLKI), .feedback(CLKFB), .reset(RST && PLLRST_ENA == "ENABLED" || STDBY && STDBY_ENABLE == "ENABLED"),
        .tick(tick), .locked(LOCK)
    );

    // Both outputs count the oscillator's half periods, so that rounding cannot separate them; their rising edges
    // coincide if each phase is its divider minus one.
    integer op_count = 2 * (CLKOP_DIV - 1 - CLKOP_CPHASE);
    integer os_count = 2 * (CLKOS_DIV - 1 - CLKOS_CPHASE);
    always @(tick) begin
        op_count = op_count == 2 * CLKOP_DIV - 1 ? 0 : op_count + 1;
        os_count = os_count == 2 * CLKOS_DIV - 1 ? 0 : os_count + 1;
        CLKOP = op_count < CLKOP_DIV && CLKOP_ENABLE == "ENABLED";
        CLKOS = os_count < CLKOS_DIV && CLKOS_ENABLE == "ENABLED";
    end
endmodule

module ODDRX1F (
    input wire SCLK, RST, D0, D1,
    output wire Q
);
    wire sent;
    ddr_output ddr (.clk(SCLK), .d0(D0), .d1(D1), .q(sent));
    assign Q = sent && !RST;
endmodule

// iCE40: the PLL with its input at a pin, with internal feedback. Limits are those of the UltraPlus family's data sheet.
module SB_PLL40_PAD #(
    parameter FEEDBACK_PATH = "", DIVR = 0, DIVF = 0, DIVQ = 1, FILTER_RANGE = 1
) (
    input wire PACKAGEPIN, RESETB, BYPASS,
    output wire PLLOUTGLOBAL, LOCK
);
    // Limits of the phase comparison in MHz: FILTER_RANGE is 1 from 10 MHz on, and 6 up to 133 MHz, as icepll sets it.
    localparam [55:0] LIMITS = {8'd133, 8'd101, 8'd66, 8'd44, 8'd26, 8'd17, 8'd10};
    wire tick;
    pll_oscillator #(
        .REFERENCE(DIVR + 1), .FEEDBACK(DIVF + 1),
        .LEGAL(FEEDBACK_PATH == "SIMPLE" && DIVR >= 0 && DIVR <= 15 && DIVF >= 0 && DIVF <= 127 && DIVQ >= 1 && DIVQ <= 6),
        .COMPARED_LEAST(LIMITS[8*FILTER_RANGE-8 +: 8]), .COMPARED_MOST(LIMITS[8*FILTER_RANGE +: 8]), .LEAST(533),
        .MOST(1066)
    ) oscillator (
        .clk_in(PACKAGEPIN), .feedback(tick), .reset(!RESETB), .tick(tick), .locked(LOCK)
    );

    integer count = 0;
    reg divided = 1'b0;
    always @(tick) begin
        count = count == (1 << DIVQ) - 1 ? 0 : count + 1;
        if (count == 0)
            divided = ~divided;
    end
    assign PLLOUTGLOBAL = BYPASS ? PACKAGEPIN : divided;
endmodule

// A pin driven at both edges of the clock, which is PIN_TYPE 0100xx.
module SB_IO #(
    parameter [5:0] PIN_TYPE = 6'b000000
) (
    output wire PACKAGE_PIN,
    input wire OUTPUT_CLK, CLOCK_ENABLE, D_OUT_0, D_OUT_1
);
    reg rising, falling;
    always @(posedge OUTPUT_CLK)
        if (CLOCK_ENABLE)
            rising <= D_OUT_0;
    always @(negedge OUTPUT_CLK)
        if (CLOCK_ENABLE)
            falling <= D_OUT_1;
    assign PACKAGE_PIN = PIN_TYPE[5:2] != 4'b0100 ? 1'bx : OUTPUT_CLK ? rising : falling;
endmodule

// Gowin: the PLL, with internal feedback. Limits are those of the GW2A in speed grade C8.
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
    wire tick, settled;
    integer count = 0, found;
    real mhz = 0;
    reg divided = 1'b0;
    pll_oscillator #(
        .REFERENCE(IDIV_SEL + 1), .FEEDBACK(FBDIV_SEL + 1), .LOOP(ODIV_SEL),
        .LEGAL(DYN_IDIV_SEL == "false" && DYN_FBDIV_SEL == "false" && DYN_ODIV_SEL == "false"
            && IDIV_SEL >= 0 && IDIV_SEL <= 63 && FBDIV_SEL >= 0 && FBDIV_SEL <= 63
            && (ODIV_SEL == 2 || ODIV_SEL == 4 || ODIV_SEL == 8 || ODIV_SEL % 16 == 0 && ODIV_SEL <= 128)),
        .COMPARED_LEAST(3), .COMPARED_MOST(500), .LEAST(500), .MOST(1250)
    ) oscillator (
        .clk_in(CLKIN), .feedback(CLKFB_SEL == "internal" ? divided : CLKFB), .reset(RESET || RESET_P),
        .tick(tick), .locked(settled)
    );

    // The charge pump and the filter are set for an input of FCLKIN, in MHz.
    initial found = $sscanf(FCLKIN, "%f", mhz);
    assign LOCK = settled && oscillator.compared * (IDIV_SEL + 1) > mhz * 0.999
        && oscillator.compared * (IDIV_SEL + 1) < mhz * 1.001;

    always @(tick) begin
        count = count == ODIV_SEL - 1 ? 0 : count + 1;
        if (count == 0)
            divided = ~divided;
    end
    assign CLKOUT = CLKOUT_BYPASS == "true" ? CLKIN : divided;
endmodule

// Divides HCLKIN by two or by five; low while RESETN is low.
module CLKDIV #(
    parameter DIV_MODE = "2"
) (
    input wire HCLKIN, RESETN, CALIB,
    output reg CLKOUT = 1'b0
);
    localparam integer HALVES = DIV_MODE == "5" ? 5 : 2;
    integer count = 0;

    always @(HCLKIN)
        if (!RESETN) begin
            count = 0;
            CLKOUT = 1'b0;
        end else begin
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
