// SPDX-License-Identifier: MIT
// Simulation models of the ECP5 cells that tops use, with frequencies, phases and edges only.

`timescale 1ns / 1ps

// The PLL, with feedback from CLKOP; it locks after eight input cycles.
module EHXPLLL #(
    parameter CLKI_DIV = 1,
    parameter CLKFB_DIV = 1,
    parameter FEEDBK_PATH = "CLKOP",
    parameter CLKOP_ENABLE = "ENABLED",
    parameter CLKOP_DIV = 8,
    parameter CLKOP_CPHASE = 0,
    parameter CLKOP_FPHASE = 0,
    parameter CLKOS_ENABLE = "DISABLED",
    parameter CLKOS_DIV = 8,
    parameter CLKOS_CPHASE = 0,
    parameter CLKOS_FPHASE = 0,
    parameter CLKOS2_ENABLE = "DISABLED",
    parameter CLKOS3_ENABLE = "DISABLED",
    parameter OUTDIVIDER_MUXA = "DIVA",
    parameter OUTDIVIDER_MUXB = "DIVB",
    parameter DPHASE_SOURCE = "DISABLED",
    parameter PLLRST_ENA = "DISABLED",
    parameter INTFB_WAKE = "DISABLED",
    parameter STDBY_ENABLE = "DISABLED"
) (
    input wire CLKI, CLKFB, RST, STDBY, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP,
    output reg CLKOP = 1'b0,
    output reg CLKOS = 1'b0,
    output reg LOCK = 1'b0
);
    realtime rose;
    real half;

    // Counts half periods of the oscillator. Both outputs count the same half periods, so that rounding cannot separate
    // them; their rising edges coincide if each phase is its divider minus one.
    integer op_count = 2 * (CLKOP_DIV - 1 - CLKOP_CPHASE);
    integer os_count = 2 * (CLKOS_DIV - 1 - CLKOS_CPHASE);
    initial begin
        @(posedge CLKI) rose = $realtime;
        @(posedge CLKI) half = ($realtime - rose) * CLKI_DIV / CLKFB_DIV / CLKOP_DIV / 2;
        forever begin
            op_count = op_count == 2 * CLKOP_DIV - 1 ? 0 : op_count + 1;
            os_count = os_count == 2 * CLKOS_DIV - 1 ? 0 : os_count + 1;
            CLKOP = op_count < CLKOP_DIV;
            CLKOS = os_count < CLKOS_DIV;
            #(half);
        end
    end

    initial begin
        repeat (8) @(posedge CLKI);
        LOCK = 1'b1;
    end
endmodule

// Two bits per cycle: D0 while the clock is high, D1 while it is low, both sampled at the rising edge.
module ODDRX1F (
    input wire SCLK, RST, D0, D1,
    output wire Q
);
    reg first, second;

    always @(posedge SCLK) begin
        first <= D0;
        second <= D1;
    end

    assign Q = SCLK ? first : second;
endmodule
