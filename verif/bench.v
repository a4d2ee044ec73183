// SPDX-License-Identifier: MIT
// The bench: a clock, the design, and a line sink that hands Python a whole video line at once.
//
// Waking Python costs more than simulating a line does, so everything that happens every clock is done here. Python
// touches only the signals marked public.

`timescale 1ns / 1ns

module bench #(
    parameter ADDRESS_BITS = 8,     // of the bus's word address
    parameter COLOUR_BITS = 8,      // of a channel
    parameter H_TOTAL = 800,        // pixels a line, blanking included
    parameter HS_ACTIVE = 0,        // level of HS in its pulse
    parameter CLOCKS_PER_PIXEL = 2  // 1 or 2
) ();
    localparam SAMPLE_BITS = 4 + 3 * COLOUR_BITS;
    localparam CAPACITY = H_TOTAL + 1;      // one more, so that a line that is too long shows

    // 50 MHz
    reg clk /*verilator public_flat_rw*/;
    initial clk = 1'b0;
    always #10 clk = ~clk;

    // What Python drives
    reg reset /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS-1:0] avs_s0_address /*verilator public_flat_rw*/;
    reg avs_s0_read /*verilator public_flat_rw*/;
    reg avs_s0_write /*verilator public_flat_rw*/;
    reg [31:0] avs_s0_writedata /*verilator public_flat_rw*/;
    reg [3:0] avs_s0_byteenable /*verilator public_flat_rw*/;
    initial reset = 1'b1;

    // What Python reads
    wire [31:0] avs_s0_readdata /*verilator public_flat_rw*/;
    wire avs_s0_readdatavalid /*verilator public_flat_rw*/;
    wire avs_s0_waitrequest /*verilator public_flat_rw*/;
    wire irq /*verilator public_flat_rw*/;

    wire [COLOUR_BITS-1:0] vga_r, vga_g, vga_b;
    wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk;

    ray_caster_module dut (
        .clk(clk),
        .reset(reset),
        .avs_s0_address(avs_s0_address),
        .avs_s0_read(avs_s0_read),
        .avs_s0_write(avs_s0_write),
        .avs_s0_writedata(avs_s0_writedata),
        .avs_s0_byteenable(avs_s0_byteenable),
        .avs_s0_readdata(avs_s0_readdata),
        .avs_s0_readdatavalid(avs_s0_readdatavalid),
        .avs_s0_waitrequest(avs_s0_waitrequest),
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

    wire [SAMPLE_BITS-1:0] sample = {vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_r, vga_g, vga_b};

    // Line sink. A line runs from HS's leading edge to the next; its sample number 0 is in the lowest bits.
    reg [CAPACITY*SAMPLE_BITS-1:0] filling;
    integer filled;
    reg hs_was_active;
    reg [CAPACITY*SAMPLE_BITS-1:0] line /*verilator public_flat_rw*/;
    reg [31:0] line_samples /*verilator public_flat_rw*/;     // those beyond CAPACITY are counted but not kept
    reg line_event /*verilator public_flat_rw*/;              // toggles when line and line_samples are new
    initial begin
        filled = 0;
        hs_was_active = 1'b0;
        line_samples = 0;
        line_event = 1'b0;
    end
    wire hs_active = vga_hs == HS_ACTIVE[0];

    // Blocking assignments: nothing else reads these at this edge, and a non-blocking one would copy the whole line.
    always @(posedge vga_clk) begin
        if (hs_active && !hs_was_active) begin
            line = filling;
            line_samples = filled;
            line_event = ~line_event;
            filled = 0;
        end
        hs_was_active = hs_active;
        if (filled < CAPACITY)
            filling[filled*SAMPLE_BITS +: SAMPLE_BITS] = sample;
        filled = filled + 1;
    end

    // Cycles of rendering since the last StartScreen.
    reg [31:0] busy_cycles /*verilator public_flat_rw*/;
    initial busy_cycles = 0;
    always @(posedge clk)
        if (dut.start_screen)
            busy_cycles = 0;
        else if (dut.busy)
            busy_cycles = busy_cycles + 1;

    // A monitor samples at the pixel clock's rising edge, so there the data must not change.
    reg [31:0] unstable_samples /*verilator public_flat_rw*/;
    reg [31:0] clock_faults /*verilator public_flat_rw*/;     // vga_clk must be clk halved, or inverted
    reg [SAMPLE_BITS-1:0] sample_before;
    reg vga_clk_before;
    initial begin
        unstable_samples = 0;
        clock_faults = 0;
    end
    always @(negedge clk) begin
        if (!reset) begin
            if (vga_clk !== (CLOCKS_PER_PIXEL == 1 ? 1'b1 : ~vga_clk_before))
                clock_faults = clock_faults + 1;
            if (CLOCKS_PER_PIXEL == 2 && vga_clk && sample !== sample_before)
                unstable_samples = unstable_samples + 1;
        end
        vga_clk_before = vga_clk;
        sample_before = sample;
    end
    // With a clock a pixel data changes at each clk, so what was taken must still stand just before the next one.
    always @(posedge clk)
        if (!reset && CLOCKS_PER_PIXEL == 1 && sample !== sample_before)
            unstable_samples = unstable_samples + 1;
endmodule
