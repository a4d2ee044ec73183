// SPDX-License-Identifier: MIT
// The renderer's counters: rows, columns, and the place in the line buffer. The control of the rays is part of the
// proof; the ray units, the culler, the line buffers and the video generator are cut out, and their outputs are
// arbitrary.
//
// So nothing is assumed about the video generator's strobes. Assumed otherwise: one cycle of reset at first, and `run`
// changes only in the cycle after StartScreen or reset, as the scene's live words do.
//
// [proof]
// claim = "the renderer's counters stay in range, and each group is written once, into its row"
// modules = [
//   "ray_caster_renderer", "clock_gate", "ray_caster", "ray_control", "ray_sequencer", "rect_sequencer",
//   "ray_unit", "line_buffer", "video_generator", "group_culler if CULLING",
// ]
// cut = ["ray_unit", "line_buffer", "video_generator", "group_culler if CULLING"]
// parameters = { COLUMN_BITS = "OFFSET_BITS", OFFSET_BITS = "GROUP_BITS" }
// induction = 1
// reach = "20 if RECTANGLES == 2 else 0"
// quick = ["engine=seed", "tiny two"]
// designs = [
//   "rows=200 reflections=2", "reflections=4", "tiny two culling=0", "units=16 rectangles=4",
//   "rows=60 units=16 two reflections=0",
// ]
// [faults]
// "vga60-u16-r2-m0-f0t-d1-c8" = ["ray_caster_renderer.enable or rendering in 100",
//   "ray_caster_renderer.place_row edge in 70", "ray_caster_renderer.restart unless scan_start_row",
//   "ray_caster_renderer.read_offset edge in 90", "ray_caster_renderer.progress_underrun unless done"]

module render_counters #(
    parameter RECTANGLES = 2, parameter INDEX_BITS = 1, parameter COLOUR_BITS = 8, parameter GROUPS = 10,
    parameter UNITS = 32, parameter ROWS = 240, parameter ROW_BITS = 8, parameter COLUMN_BITS = 4,
    parameter OFFSET_BITS = 4, parameter UNIT_BITS = 5
) (
    input clk, input reset, input run, input [2:0] reflections, input [23:0] background, input [26:0] camera,
    input [RECTANGLES-1:0] usable, input [70:0] rect
);
wire start_screen, busy, underrun;
wire [15:0] row_cycles, group_cycles;

ray_caster_renderer dut (
    .clk(clk), .reset(reset), .picture_run(run), .picture_reflections(reflections), .picture_background(background),
    .progress_start_screen(start_screen), .progress_busy(busy), .progress_underrun(underrun),
    .progress_row_cycles(row_cycles), .progress_group_cycles(group_cycles), .vga_r(), .vga_g(), .vga_b(), .vga_hs(),
    .vga_vs(), .vga_blank_n(), .vga_sync_n(), .vga_clk(), .camera_word(camera), .rects_usable(usable), .rects_index(),
    .rects_fetch(), .rects_rect_word(rect)
);

(* hierconn *) wire \dut.done , \dut.enable , \dut.rendering , \dut.scan_start_row , \dut.reset_delay ;
(* hierconn *) wire [ROW_BITS-1:0] \dut.place_row ;
(* hierconn *) wire [COLUMN_BITS-1:0] \dut.place_column_offset ;
(* hierconn *) wire [OFFSET_BITS-1:0] \dut.read_offset ;
(* hierconn *) wire [UNIT_BITS-1:0] \dut.read_unit ;

reg known = 0;
reg last_run, last_start, last_reset;
reg last_done, last_restart;
reg [ROW_BITS-1:0] last_row;
reg [COLUMN_BITS-1:0] last_column;
always @(posedge clk) begin
    known <= 1;
    last_run <= run;
    last_start <= start_screen;
    last_reset <= reset;
    last_done <= \dut.done ;
    last_restart <= reset || start_screen || \dut.scan_start_row ;
    last_row <= \dut.place_row ;
    last_column <= \dut.place_column_offset ;
end
always @* begin
    if (!known) assume (reset);
    if (known && !last_start && !last_reset) assume (run == last_run);
end

// Conditions that the line buffer relies on.
always @* if (known) begin
    assert (\dut.read_offset < GROUPS);
    assert (\dut.read_unit < UNITS);
    if (\dut.done ) assert (\dut.place_column_offset < GROUPS);
end

// Counters in range. A group is written only while its row has room, and the half changes only between rows.
always @* if (known) begin
    assert (\dut.place_column_offset <= GROUPS);
    assert (\dut.place_row <= ROWS);
    if (\dut.rendering ) assert (\dut.place_row < ROWS);
    if (\dut.done ) assert (\dut.rendering && \dut.enable );
    assert (busy == (run && \dut.rendering && \dut.place_column_offset != GROUPS));
    assert (underrun == (\dut.scan_start_row && busy));
    if (!last_restart) begin
        assert (\dut.place_row == last_row);
        assert (\dut.place_column_offset == last_column + last_done);
    end
end

// A group is written once: the strobe lasts one cycle, and the control is reset before it may give another one.
always @* if (known && last_done) assert (!\dut.done );

// Invariants: the control is active or done only while the renderer needs a group; its reset is over when it is done
// for the first time.
(* hierconn *) wire [2:0] \dut.ray_caster_i.ray_control_i.ray_sequencer_i.state ;
always @* if (known && \dut.ray_caster_i.ray_control_i.ray_sequencer_i.state != 0) assert (\dut.enable && !\dut.reset_delay );

// Covers two written groups and a finished row.
reg groups_seen = 0;
always @(posedge clk) groups_seen <= !reset && (groups_seen || (\dut.done && \dut.place_column_offset == 1));
always @* cover (groups_seen && \dut.place_row == 1);
endmodule
