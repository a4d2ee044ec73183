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

module render_counters;
ray_caster_renderer dut (.*);

reg last_restart;
always @(posedge clk) last_restart <= reset || progress_start_screen || dut.scan_start_row;
always @* if (known && !$past(progress_start_screen) && !$past(reset)) assume ($stable(picture_run));

// Conditions that the line buffer relies on.
always @* if (known) begin
    assert (dut.read_offset < GROUPS);
    assert (dut.read_unit < UNITS);
    if (dut.done) assert (dut.place_column_offset < GROUPS);
end

// Counters in range. A group is written only while its row has room, and the half changes only between rows.
always @* if (known) begin
    assert (dut.place_column_offset <= GROUPS);
    assert (dut.place_row <= ROWS);
    if (dut.rendering) assert (dut.place_row < ROWS);
    if (dut.done) assert (dut.rendering && dut.enable);
    assert (progress_busy == (picture_run && dut.rendering && dut.place_column_offset != GROUPS));
    assert (progress_underrun == (dut.scan_start_row && progress_busy));
    if (!last_restart) begin
        assert ($stable(dut.place_row));
        assert (dut.place_column_offset == $past(dut.place_column_offset) + $past(dut.done));
    end
end

// A group is written once: the strobe lasts one cycle, and the control is reset before it may give another one.
always @* if (known && $past(dut.done)) assert (!dut.done);

// Invariants: the control is active or done only while the renderer needs a group; its reset is over when it is done
// for the first time.
wire [2:0] state = dut.ray_caster_i.ray_control_i.ray_sequencer_i.state;
always @* if (known && state != 0) assert (dut.enable && !dut.reset_delay);

// Covers two written groups and a finished row.
reg groups_seen = 0;
always @(posedge clk) groups_seen <= !reset && (groups_seen || (dut.done && dut.place_column_offset == 1));
always @* cover (groups_seen && dut.place_row == 1);
endmodule
