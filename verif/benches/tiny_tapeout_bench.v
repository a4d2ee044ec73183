// SPDX-License-Identifier: MIT
// A Tiny Tapeout project with the VGA Pmod. A line sink passes whole video lines to Python.

`timescale 1ns / 1ns

module tiny_tapeout_bench #(
    parameter H_TOTAL = 800,            // pixels per line, blanking included
    parameter HS_ACTIVE = 0             // level of hsync during its pulse
) (`CLOCK_PORT);
    `OWN_CLOCK

    // Driven and read by Python
    reg rst_n /*verilator public_flat_rw*/;
    reg [7:0] ui_in /*verilator public_flat_rw*/;
    reg [7:0] uio_in /*verilator public_flat_rw*/;
    reg ena /*verilator public_flat_rw*/;
    wire [7:0] uio_out /*verilator public_flat_rw*/;
    wire [7:0] uio_oe /*verilator public_flat_rw*/;

    wire [7:0] uo_out;

    tt_um_raycaster project (.*);

    // The Pmod has no pins for the clock, blanking or composite sync.
    line_sink #(
        .COLOUR_BITS(2),
        .H_TOTAL(H_TOTAL),
        .HS_ACTIVE(HS_ACTIVE),
        .CLOCKS_PER_PIXEL(1)
    ) sink (
        .clk(clk),
        .reset(!rst_n),
        .vga_r({uo_out[0], uo_out[4]}),
        .vga_g({uo_out[1], uo_out[5]}),
        .vga_b({uo_out[2], uo_out[6]}),
        .vga_hs(uo_out[7]),
        .vga_vs(uo_out[3]),
        .vga_blank_n(1'b0),
        .vga_sync_n(1'b0),
        .vga_clk(!clk)
    );
endmodule
