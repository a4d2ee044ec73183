// SPDX-License-Identifier: MIT
// A scene, its camera moved by the board's buttons: fire 1 and 2 are forward and back, the others what they say.

module ulx3s_design (
    input  wire       clk,
    input  wire       ready,
    input  wire [6:1] btn,              // fire 1, fire 2, up, down, left, right
    output wire       uart_tx,
    output wire [7:0] vga_r,
    output wire [7:0] vga_g,
    output wire [7:0] vga_b,
    output wire       vga_hs,
    output wire       vga_vs,
    output wire       vga_blank_n,
    output wire       vga_clk
);

assign uart_tx = 1'b1;                  // idle

ray_caster_system system (
    .clk(clk),
    .ready(ready),
    .buttons({btn[4], btn[3], btn[6], btn[5], btn[2], btn[1]}),
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
