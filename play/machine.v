// SPDX-License-Identifier: MIT
// A whole system for a loop in C++, with what happens on the ray tracer's bus brought out.
//
// SYSTEM: the system's module. SERIAL: defined where it has a serial port.

module machine #(
    parameter BUTTONS = 5,
    parameter COLOUR_BITS = 8,
    parameter ADDRESS_BITS = 6
) (
    input  wire                    clk,
    input  wire                    ready,
    input  wire [BUTTONS-1:0]      buttons,
    output wire                    uart_tx,
    output wire [COLOUR_BITS-1:0]  vga_r,
    output wire [COLOUR_BITS-1:0]  vga_g,
    output wire [COLOUR_BITS-1:0]  vga_b,
    output wire                    vga_vs,
    output wire                    vga_blank_n,
    output wire                    vga_clk,
    output wire                    busy,            // a picture is being computed
    output wire                    start_screen,    // what was committed goes live with this clock
    output wire                    written,         // the ray tracer takes a write with this clock
    output wire [ADDRESS_BITS-1:0] address,
    output wire [3:0]              byteenable,
    output wire [31:0]             writedata
);

wire vga_hs, vga_sync_n;

`SYSTEM system (
    .clk(clk),
    .ready(ready),
    .buttons(buttons),
`ifdef SERIAL
    .uart_tx(uart_tx),
`endif
    .vga_r(vga_r),
    .vga_g(vga_g),
    .vga_b(vga_b),
    .vga_hs(vga_hs),
    .vga_vs(vga_vs),
    .vga_blank_n(vga_blank_n),
    .vga_sync_n(vga_sync_n),
    .vga_clk(vga_clk)
);

`ifndef SERIAL
assign uart_tx = 1'b1;
`endif

assign busy = system.ray_caster_module_i.progress_busy;
assign start_screen = system.ray_caster_module_i.progress_start_screen && !system.reset;
assign written =
    system.ray_caster_module_i.avs_s0_write && !system.ray_caster_module_i.avs_s0_waitrequest && !system.reset;
assign address = system.ray_caster_module_i.avs_s0_address;
assign byteenable = system.ray_caster_module_i.avs_s0_byteenable;
assign writedata = system.ray_caster_module_i.avs_s0_writedata;

endmodule
