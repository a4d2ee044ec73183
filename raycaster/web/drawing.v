// SPDX-License-Identifier: MIT
// Top level of a design that draws whole frames, for a loop in C++ that reads the runs. Between the units and the loop
// there is no monitor: the modules `video_generator` and `frame_list` here take the place of the design's own. So a
// frame takes only the clocks of its drawing. Several machines with the same scene share a frame's rows.
//
// Two parts of the design have clocks of their own, which the loop stops while they would change nothing: registers that
// only the bus and `begins` change have `bus_clk`, and the memory of the rectangles has `fetch_clk`.
//
// ADDRESS_BITS: width of the bus's addresses; ENTRY_BITS: width of a run, its end above its colour; ROWS: rows of a
// frame; COLOUR_BITS: bits per channel.

module machine (
    input  wire                     clk,
    input  wire                     bus_clk,        // rises with clk, except while busy
    input  wire                     fetch_clk,      // rises with clk, except while busy without `fetches`
    input  wire                     reset,
    input  wire                     host_read,      // read and write are held until accepted
    input  wire                     host_write,
    input  wire [`ADDRESS_BITS-1:0] host_address,
    input  wire [31:0]              host_writedata,
    output wire                     host_waitrequest,
    output wire                     host_readdatavalid,
    output wire [31:0]              host_readdata,
    input  wire                     begins,         // strobe; the committed scene goes live, and its frame begins
    input  wire [7:0]               skipped,        // rows above the first one that this machine draws
    input  wire [7:0]               stride,         // from one of its rows to the next
    output wire                     busy,           // drawing, from the clock after `begins` on
    output wire                     working,        // its unit draws a row
    output wire                     fetches,        // a rectangle is read with this clock
    output wire                     run_valid,      // a run is taken with this clock
    output wire [`ENTRY_BITS-1:0]   run,
    output wire [15:0]              row             // row of the run
);

ray_caster_module ray_caster_module_i (
    .clk(clk),
    .reset(reset),
    .avs_s0_address(host_address),
    .avs_s0_read(host_read),
    .avs_s0_write(host_write),
    .avs_s0_writedata(host_writedata),
    .avs_s0_byteenable(4'b1111),
    .avs_s0_readdata(host_readdata),
    .avs_s0_readdatavalid(host_readdatavalid),
    .avs_s0_waitrequest(host_waitrequest),
    .irq(),
    .vga_r(),
    .vga_g(),
    .vga_b(),
    .vga_hs(),
    .vga_vs(),
    .vga_blank_n(),
    .vga_sync_n(),
    .vga_clk()
);

`define LIST ray_caster_module_i.span_renderer_i.frame_list_i
assign fetches = ray_caster_module_i.rects_fetch;
assign busy = `LIST.busy;
assign working = `LIST.working;
assign run_valid = `LIST.valid;
assign run = `LIST.runs;
assign row = `LIST.row;

endmodule

// StartScreen at the loop's command, and no monitor.
module video_generator (
    input  wire                      clk,
    input  wire                      reset,
    output wire                      scan_start_screen,
    output wire                      scan_start_row,
    output wire                      scan_visible_line,
    output wire                      scan_next_column,
    input  wire [3*`COLOUR_BITS-1:0] pixel_word,
    output wire [`COLOUR_BITS-1:0]   vga_r,
    output wire [`COLOUR_BITS-1:0]   vga_g,
    output wire [`COLOUR_BITS-1:0]   vga_b,
    output wire                      vga_hs,
    output wire                      vga_vs,
    output wire                      vga_blank_n,
    output wire                      vga_sync_n,
    output wire                      vga_clk
);

assign scan_start_screen = machine.begins;
assign scan_start_row = 1'b0;
assign scan_visible_line = 1'b0;
assign scan_next_column = 1'b0;
assign {vga_r, vga_g, vga_b} = 0;
assign {vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk} = 0;

endmodule

// Deals rows to one unit as `row_dealer` does, but leaves out those of other machines. It takes each run at once, as the
// design's own list does until it is full.
module frame_list (
    input  wire                   clk,
    input  wire                   reset,
    input  wire                   run,
    output wire                   take_scene,
    output reg                    stop,
    output reg                    first_row,
    output reg                    next_row,
    output reg                    start,
    input  wire                   done,
    input  wire                   valid,
    input  wire [`ENTRY_BITS-1:0] runs,
    output wire                   ready,
    output wire                   busy,
    output wire [3*`COLOUR_BITS-1:0] shown,
    input  wire                   scan_start_screen,
    input  wire                   scan_start_row,
    input  wire                   scan_visible_line,
    input  wire                   scan_next_column,
    output wire                   events_drawn,
    output wire                   events_shown,
    output wire                   events_again,
    output wire                   events_late,
    output wire                   events_list_full,
    output wire [31:0]            events_time
);

reg new_frame, settles, drawing;
reg [7:0] skip;
reg [15:0] next, row;
wire rows_left = next != `ROWS;
wire idle = !drawing || done;
wire deals = rows_left && idle && skip == 0;
wire passes = rows_left && skip != 0;
wire working = deals || (drawing && !done);

assign take_scene = scan_start_screen;
assign ready = 1'b1;
assign busy = new_frame || first_row || settles || rows_left || drawing;
assign shown = 0;
assign {events_drawn, events_shown, events_again, events_late, events_list_full} = 0;
assign events_time = 0;

always @(posedge clk) begin
    stop <= reset;
    if (reset) begin
        new_frame <= 1'b0;
        first_row <= 1'b0;
        settles <= 1'b0;
        drawing <= 1'b0;
        start <= 1'b0;
        next_row <= 1'b0;
        next <= `ROWS;
    end
    else begin
        new_frame <= scan_start_screen;
        first_row <= new_frame && run;
        settles <= first_row;
        drawing <= working;
        start <= deals;
        next_row <= deals || passes;
        if (settles) begin
            next <= 0;
            skip <= machine.skipped;
        end
        else if (deals || passes) begin
            next <= next + 1;
            skip <= skip == 0 ? machine.stride - 1 : skip - 1;
        end
        if (deals)
            row <= next;
    end
end

endmodule
