// SPDX-License-Identifier: MIT
// A line sink: hands Python a whole video line at once, and watches the monitor's clock.
//
// Waking Python costs more than simulating a line does, so all work of every clock is done here. Python
// touches only the signals marked public.

`timescale 1ns / 1ns

module line_sink #(
    parameter COLOUR_BITS = 8,      // bits per channel
    parameter H_TOTAL = 800,        // pixels per line, blanking included
    parameter HS_ACTIVE = 0,        // level of HS during its pulse
    parameter CLOCKS_PER_PIXEL = 2, // 1 or 2
    parameter PIXELS = 1            // pixels per pixel clock, 1 or 2: the left one in the low half of each colour
) (
    input wire clk,
    input wire reset,
    input wire [PIXELS*COLOUR_BITS-1:0] vga_r, vga_g, vga_b,
    input wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk
);
    localparam SAMPLE_BITS = 4 + 3 * COLOUR_BITS;
    localparam CAPACITY = H_TOTAL + PIXELS;     // one clock more, so that a line that is too long shows

    // Samples of one pixel clock, one per pixel, with the left pixel in the lowest bits.
    wire [PIXELS*SAMPLE_BITS-1:0] sample;
    genvar pixel;
    generate
        for (pixel = 0; pixel < PIXELS; pixel = pixel + 1) begin : pixels
            assign sample[pixel*SAMPLE_BITS +: SAMPLE_BITS] = {
                vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_r[pixel*COLOUR_BITS +: COLOUR_BITS],
                vga_g[pixel*COLOUR_BITS +: COLOUR_BITS], vga_b[pixel*COLOUR_BITS +: COLOUR_BITS]
            };
        end
    endgenerate

    // A line runs from HS's leading edge to the next; its sample number 0 is in the lowest bits.
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
            filling[filled*SAMPLE_BITS +: PIXELS*SAMPLE_BITS] = sample;
        filled = filled + PIXELS;
    end

    // A monitor samples at the pixel clock's rising edge, so there the data must not change.
    reg [31:0] unstable_samples /*verilator public_flat_rw*/;
    reg [31:0] clock_faults /*verilator public_flat_rw*/;     // vga_clk must be clk halved, or inverted
    reg [PIXELS*SAMPLE_BITS-1:0] sample_before;
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
    // With one clock per pixel, data changes at each edge, so sampled data must still be there just before the next.
    always @(posedge clk)
        if (!reset && CLOCKS_PER_PIXEL == 1 && sample !== sample_before)
            unstable_samples = unstable_samples + 1;
endmodule
