// SPDX-License-Identifier: MIT

`timescale 1ns/10ps

// RayCaster on the pins of a DE2-115 or a DE1-SoC, named as in their manuals.
//
// KEY[3] left, KEY[2] forward, KEY[1] back, KEY[0] right: the camera moves while a key is pressed (low).
// SW[0] up, SW[1] down: the camera moves while a switch is high. SW[2] high: reset.
module ray_caster_project #(
    parameter COLOUR_BITS = 8
) (
    input  wire       CLOCK_50,
    input  wire [3:0] KEY,
    input  wire [2:0] SW,
    output wire [7:0] VGA_R,
    output wire [7:0] VGA_G,
    output wire [7:0] VGA_B,
    output wire       VGA_CLK,
    output wire       VGA_BLANK_N,
    output wire       VGA_HS,
    output wire       VGA_VS,
    output wire       VGA_SYNC_N
);

wire [COLOUR_BITS-1:0] red;
wire [COLOUR_BITS-1:0] green;
wire [COLOUR_BITS-1:0] blue;

// buttons[5:0]: down, up, right, left, back, forward.
scene_system system (
    .clk(CLOCK_50),
    .ready(~SW[2]),
    .buttons({SW[1], SW[0], ~KEY[0], ~KEY[3], ~KEY[1], ~KEY[2]}),
    .vga_r(red),
    .vga_g(green),
    .vga_b(blue),
    .vga_hs(VGA_HS),
    .vga_vs(VGA_VS),
    .vga_blank_n(VGA_BLANK_N),
    .vga_sync_n(VGA_SYNC_N),
    .vga_clk(VGA_CLK)
);

channel_pins #(.BITS(COLOUR_BITS), .PINS(8)) red_pins (.channel(red), .pins(VGA_R));
channel_pins #(.BITS(COLOUR_BITS), .PINS(8)) green_pins (.channel(green), .pins(VGA_G));
channel_pins #(.BITS(COLOUR_BITS), .PINS(8)) blue_pins (.channel(blue), .pins(VGA_B));

endmodule
