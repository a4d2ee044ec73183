// SPDX-License-Identifier: MIT

`timescale 1ns/10ps

// RayCaster on the pins of a DE10-Lite, named as in its manual.
//
// KEY[1] left, KEY[0] right: the camera moves while a key is pressed (low).
// SW[0] up, SW[1] down, SW[3] back, SW[4] forward: it moves while a switch is high. SW[2] high: reset.
module ray_caster_project #(
    parameter COLOUR_BITS = 4
) (
    input  wire       MAX10_CLK1_50,
    input  wire [1:0] KEY,
    input  wire [4:0] SW,
    output wire [3:0] VGA_R,
    output wire [3:0] VGA_G,
    output wire [3:0] VGA_B,
    output wire       VGA_HS,
    output wire       VGA_VS
);

wire [COLOUR_BITS-1:0] red;
wire [COLOUR_BITS-1:0] green;
wire [COLOUR_BITS-1:0] blue;

// buttons[5:0]: down, up, right, left, back, forward. The DAC consists of resistors and needs no clock; blanked pixels
// are already black.
scene_system system (
    .clk(MAX10_CLK1_50),
    .ready(~SW[2]),
    .buttons({SW[1], SW[0], ~KEY[0], ~KEY[1], SW[3], SW[4]}),
    .vga_r(red),
    .vga_g(green),
    .vga_b(blue),
    .vga_hs(VGA_HS),
    .vga_vs(VGA_VS),
    .vga_blank_n(),
    .vga_sync_n(),
    .vga_clk()
);

channel_pins #(.BITS(COLOUR_BITS), .PINS(4)) red_pins (.channel(red), .pins(VGA_R));
channel_pins #(.BITS(COLOUR_BITS), .PINS(4)) green_pins (.channel(green), .pins(VGA_G));
channel_pins #(.BITS(COLOUR_BITS), .PINS(4)) blue_pins (.channel(blue), .pins(VGA_B));

endmodule
