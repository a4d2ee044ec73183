// SPDX-License-Identifier: MIT
// The bench: a clock, the design, and a line sink that hands Python a whole video line at once.
//
// Python touches only the signals marked public.

`timescale 1ns / 1ns

module bench #(
    parameter ADDRESS_BITS = 8,     // bits of the bus's word address
    parameter COLOUR_BITS = 8,      // bits per channel
    parameter H_TOTAL = 800,        // pixels per line, blanking included
    parameter HS_ACTIVE = 0,        // level of HS during its pulse
    parameter CLOCKS_PER_PIXEL = 2, // 1 or 2
    parameter PIXELS = 1            // pixels per pixel clock, 1 or 2
) (`CLOCK_PORT);
    `OWN_CLOCK

    // Driven by Python
    reg reset /*verilator public_flat_rw*/;
    initial reset = 1'b1;

    // Read by Python
    wire irq /*verilator public_flat_rw*/;

    // The bus, with the names that its drivers expect. In Verilator, Python that waits for an edge of clk runs after
    // all registers have changed. So drivers of a bus with a bridge use bus_clk, which rises in mid-cycle: there they
    // sample settled signals, and drive signals that the design sees from the next edge of clk on.
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
`ifdef BRIDGED
`include "bus_ports.vh"
`endif
        .*
    );

    // Rendering cycles since the last StartScreen; stays 0 in a netlist, which does not keep the names.
    reg [31:0] busy_cycles /*verilator public_flat_rw*/;
    initial busy_cycles = 0;
`ifndef NETLIST
    always @(posedge clk)
        if (dut.progress_start_screen)
            busy_cycles = 0;
        else if (dut.progress_busy)
            busy_cycles = busy_cycles + 1;
`endif

    // Optional waveform of part of a frame
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
        .*
    );
endmodule
