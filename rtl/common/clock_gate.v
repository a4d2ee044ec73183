// SPDX-License-Identifier: MIT
// A clock that rests while nothing needs it.
//
// CLOCK_GATING is for simulators, which then leave out what rests, and for chips whose tools build gates into clocks.
// Without it, as on FPGAs, the clock goes on, and awake has no reader.

`timescale 1ns/10ps

module clock_gate (
    input  wire clk,
    input  wire awake,
    output wire gated_clk
);

`ifdef CLOCK_GATING
reg open;

// It only follows while the clock is low, so no pulse is cut short.
always @* begin: LATCH
    if (!clk)
        open = awake;
end

assign gated_clk = clk & open;
`else
assign gated_clk = clk;
`endif

endmodule
