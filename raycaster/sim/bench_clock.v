// SPDX-License-Identifier: MIT
// Clock of a bench: with MAIN_CLOCK, raycaster/sim/main.cpp drives it through a port, which is faster; else the bench does.

`ifdef MAIN_CLOCK
`define CLOCK_PORT input wire clk /*verilator public_flat_rw*/
`define OWN_CLOCK
`else
`define CLOCK_PORT
// 50 MHz
`define OWN_CLOCK reg clk /*verilator public_flat_rw*/; initial clk = 1'b0; always #10 clk = ~clk;
`endif
