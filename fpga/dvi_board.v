// SPDX-License-Identifier: MIT
// A board with a DVI link, except its pins: sends the picture of board_design on the link, and its text on serial.

module dvi_board (
    input  wire       clk_in,           // the oscillator
    input  wire       run,              // low resets everything, like an unlocked PLL
    input  wire [5:0] buttons,          // down, up, right, left, back, forward
    input  wire       serial_in,        // to here
    output wire       locked,
    output wire       serial,           // from here
    output wire [3:0] link_p,           // clock, red, green, blue
    output wire [3:0] link_n
);

// Kept, so that nextpnr reports the clocks by these names.
(* keep *) wire clk, shift_clk;
wire [7:0] vga_r, vga_g, vga_b;
wire vga_hs, vga_vs, vga_blank_n, vga_clk;
wire [9:0] blue, green, red;
wire pixel, pixel_end;
wire [3:0] link;

board_clocks clocks (
    .clk_in(clk_in),
    .vga_clk(vga_clk),
    .clk(clk),
    .shift_clk(shift_clk),
    .locked(locked),
    .pixel_end(pixel_end)
);

board_design shown (
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
    .vga_clk(vga_clk)
);

dvi_encoder encoder (
    .clk(clk),
    .pixel_end(pixel_end),
    .vga_r(vga_r),
    .vga_g(vga_g),
    .vga_b(vga_b),
    .vga_hs(vga_hs),
    .vga_vs(vga_vs),
    .vga_blank_n(vga_blank_n),
    .blue(blue),
    .green(green),
    .red(red),
    .pixel(pixel)
);

dvi_serialiser serialiser (
    .clk(clk),
    .shift_clk(shift_clk),
    .blue(blue),
    .green(green),
    .red(red),
    .pixel(pixel),
    .link(link)
);

link_pins pins (.link(link), .link_p(link_p), .link_n(link_n));

endmodule
