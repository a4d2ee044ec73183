// SPDX-License-Identifier: MIT
// The bench: a clock, the design, and a line sink that hands Python a whole video line at once.
//
// Python touches only the signals marked public.

`timescale 1ns / 1ns

module bench #(
    parameter ADDRESS_BITS = 8,     // of the bus's word address
    parameter COLOUR_BITS = 8,      // of a channel
    parameter H_TOTAL = 800,        // pixels a line, blanking included
    parameter HS_ACTIVE = 0,        // level of HS in its pulse
    parameter CLOCKS_PER_PIXEL = 2, // 1 or 2
    parameter PIXELS = 1            // of a pixel clock, 1 or 2
) (`CLOCK_PORT);
    `OWN_CLOCK

    // What Python drives
    reg reset /*verilator public_flat_rw*/;
    initial reset = 1'b1;

    // What Python reads
    wire irq /*verilator public_flat_rw*/;

    // The bus, by the names that its drivers know. Python that waits for an edge of clk runs, in Verilator, when all
    // registers have changed already. So drivers of a bus with a bridge have a clock that rises in mid-cycle: there they
    // sample what has settled, and drive what the design sees from the next edge of clk on.
    wire bus_clk /*verilator public_flat_rw*/;
    assign bus_clk = ~clk;
`ifdef BRIDGED
`include "bus_signals.vh"
`else
    reg [ADDRESS_BITS-1:0] avs_s0_address /*verilator public_flat_rw*/;
    reg avs_s0_read /*verilator public_flat_rw*/;
    reg avs_s0_write /*verilator public_flat_rw*/;
    reg [31:0] avs_s0_writedata /*verilator public_flat_rw*/;
    reg [3:0] avs_s0_byteenable /*verilator public_flat_rw*/;
    wire [31:0] avs_s0_readdata /*verilator public_flat_rw*/;
    wire avs_s0_readdatavalid /*verilator public_flat_rw*/;
    wire avs_s0_waitrequest /*verilator public_flat_rw*/;
`endif

    wire [PIXELS*COLOUR_BITS-1:0] vga_r, vga_g, vga_b;
    wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk;

    ray_caster_module dut (
        .clk(clk),
        .reset(reset),
`ifdef BRIDGED
`include "bus_ports.vh"
`else
        .avs_s0_address(avs_s0_address),
        .avs_s0_read(avs_s0_read),
        .avs_s0_write(avs_s0_write),
        .avs_s0_writedata(avs_s0_writedata),
        .avs_s0_byteenable(avs_s0_byteenable),
        .avs_s0_readdata(avs_s0_readdata),
        .avs_s0_readdatavalid(avs_s0_readdatavalid),
        .avs_s0_waitrequest(avs_s0_waitrequest),
`endif
        .irq(irq),
        .vga_r(vga_r),
        .vga_g(vga_g),
        .vga_b(vga_b),
        .vga_hs(vga_hs),
        .vga_vs(vga_vs),
        .vga_blank_n(vga_blank_n),
        .vga_sync_n(vga_sync_n),
        .vga_clk(vga_clk)
    );

    // Cycles of rendering since the last StartScreen. A netlist does not keep the names, and has none.
    reg [31:0] busy_cycles /*verilator public_flat_rw*/;
    initial busy_cycles = 0;
`ifndef NETLIST
    always @(posedge clk)
        if (dut.progress_start_screen)
            busy_cycles = 0;
        else if (dut.progress_busy)
            busy_cycles = busy_cycles + 1;
`endif

    // A waveform of part of a frame, for who asks for one.
`ifdef WAVE_WINDOW
    wave_window window (
        .clk(clk),
        .start_screen(dut.progress_start_screen)
    );
`endif

    line_sink #(
        .COLOUR_BITS(COLOUR_BITS),
        .H_TOTAL(H_TOTAL),
        .HS_ACTIVE(HS_ACTIVE),
        .CLOCKS_PER_PIXEL(CLOCKS_PER_PIXEL),
        .PIXELS(PIXELS)
    ) sink (
        .clk(clk),
        .reset(reset),
        .vga_r(vga_r),
        .vga_g(vga_g),
        .vga_b(vga_b),
        .vga_hs(vga_hs),
        .vga_vs(vga_vs),
        .vga_blank_n(vga_blank_n),
        .vga_sync_n(vga_sync_n),
        .vga_clk(vga_clk)
    );
endmodule
