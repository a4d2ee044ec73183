// SPDX-License-Identifier: MIT
// The ULX3S: connects pins. What ulx3s_design draws is on the board's DVI connector, and what it says on the serial port of
// the USB connector US1. The power button starts everything anew.

module ulx3s (
    input  wire       clk_25mhz,
    input  wire [6:0] btn,              // power (active low), fire 1, fire 2, up, down, left, right
    output wire [7:0] led,
    output wire [3:0] gpdi_dp,          // blue, green, red, clock
    output wire       ftdi_rxd,         // the USB chip's input
    output wire       wifi_gpio0
);

wire clk, shift_clk, locked;
wire [7:0] vga_r, vga_g, vga_b;
wire vga_hs, vga_vs, vga_blank_n, vga_clk;
wire [9:0] blue, green, red;
wire pixel, pixel_end;

assign led = {locked, 1'b0, btn[6:1]};
assign wifi_gpio0 = 1'b1;               // low would have the ESP32 load another bitstream

ulx3s_clocks clocks (
    .clk_25mhz(clk_25mhz),
    .vga_clk(vga_clk),
    .clk(clk),
    .shift_clk(shift_clk),
    .locked(locked),
    .pixel_end(pixel_end)
);

ulx3s_design shown (
    .clk(clk),
    .ready(locked & btn[0]),
    .btn(btn[6:1]),
    .uart_tx(ftdi_rxd),
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
    .ready(locked & btn[0]),
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
    .shift_clk(shift_clk),
    .blue(blue),
    .green(green),
    .red(red),
    .pixel(pixel),
    .gpdi_dp(gpdi_dp)
);

endmodule
