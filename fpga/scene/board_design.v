// SPDX-License-Identifier: MIT
// A scene, with its camera moved by the board's buttons.

module board_design #(
    parameter COLOUR_BITS = 8
) (
    input  wire clk,
    input  wire ready,
    input  wire [5:0] buttons,              // down, up, right, left, back, forward
    input  wire uart_rx,                    // not read
    output wire uart_tx,
    output wire [COLOUR_BITS-1:0] vga_r,
    output wire [COLOUR_BITS-1:0] vga_g,
    output wire [COLOUR_BITS-1:0] vga_b,
    output wire vga_hs,
    output wire vga_vs,
    output wire vga_blank_n,
    output wire vga_clk
);

assign uart_tx = 1'b1;                  // idle

scene_system system (
    .clk(clk),
    .ready(ready),
    .buttons(buttons),
    .vga_r(vga_r),
    .vga_g(vga_g),
    .vga_b(vga_b),
    .vga_hs(vga_hs),
    .vga_vs(vga_vs),
    .vga_blank_n(vga_blank_n),
    .vga_sync_n(),
    .vga_clk(vga_clk)
);

endmodule
