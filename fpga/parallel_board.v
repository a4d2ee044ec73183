// SPDX-License-Identifier: MIT
// A board with a DAC or a transmitter, except its pins. The picture of board_design, one pixel per clock, changes at
// the falling edge of vga_clk and is captured at the rising edge.

module parallel_board #(
    parameter COLOUR_BITS = 8
) (
    input  wire clk_in,                     // the oscillator
    input  wire run,                        // low resets everything, like an unlocked PLL
    input  wire [5:0] buttons,              // down, up, right, left, back, forward
    input  wire serial_in,                  // to here
    output wire locked,
    output wire serial,                     // from here
    output wire [COLOUR_BITS-1:0] vga_r,
    output wire [COLOUR_BITS-1:0] vga_g,
    output wire [COLOUR_BITS-1:0] vga_b,
    output wire vga_hs,
    output wire vga_vs,
    output wire vga_blank_n,
    output wire vga_clk
);

// Kept, so that nextpnr reports the clock by this name.
(* keep *) wire clk;

board_clocks clocks (
    .clk_in(clk_in),
    .vga_clk(1'b0),
    .clk(clk),
    .shift_clk(),
    .locked(locked),
    .pixel_end()
);

board_design #(.COLOUR_BITS(COLOUR_BITS)) shown (
    .clk(clk),
    .ready(locked & run),
    .buttons(buttons),
    .uart_rx(serial_in),
    .uart_tx(serial),
    .vga_r(vga_r),
    .vga_g(vga_g),
    .vga_b(vga_b),
    .vga_hs(vga_hs),
    .vga_vs(vga_vs),
    .vga_blank_n(vga_blank_n),
    .vga_clk()
);

clock_pin monitor_clock (.clk(clk), .pin(vga_clk));

endmodule
