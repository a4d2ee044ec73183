// SPDX-License-Identifier: MIT
// A clock gate.
//
// Define CLOCK_GATING for simulators, which then skip blocks whose clock is stopped, and for chips whose tools support
// clock gates. Without it, as on FPGAs, gated_clk is clk, and reset and awake are unused.

`timescale 1ns/10ps

module clock_gate (
    input  wire clk,
    input  wire reset,
    input  wire awake,
    output wire gated_clk
);

`ifdef CLOCK_GATING
reg open;

// The latch is transparent only while clk is low, so no clock pulse is cut short.
always @* begin: LATCH
    if (!clk)
        open = awake || reset;
end

assign gated_clk = clk & open;
`else
assign gated_clk = clk;
`endif

endmodule
