// SPDX-License-Identifier: MIT
// A section of the line buffer is not written in a cycle in which it is read, whichever half is selected.
//
// Assumed, as `render_counters` proves for the renderer: the offsets of reads and writes are below the number of
// groups. No state is involved, so one step covers all steps.
//
// [proof]
// claim = "a section of the line buffer is never read while it is written"
// modules = ["line_buffer"]
// induction = 1
// quick = ["engine=seed", "tiny two"]
// designs = ["reflections=2", "units=16 rectangles=4"]
// [faults]
// "tiny48-u2-r2-m1-f0t-d3-c8" = ["line_buffer.read_address short", "line_buffer.line_buf_sel unless write"]

module line_sections;
line_buffer dut (.*);

always @* begin
    assume (read_offset < GROUPS);
    if (write) assume (write_offset < GROUPS);
end

always @* begin
    assert (dut.read_address < 2 * GROUPS);
    if (write) begin
        assert (dut.write_address < 2 * GROUPS);
        assert (dut.write_address != dut.read_address);
    end
end

// The halves are separate: every offset of either half has its own address.
always @* begin
    assert (dut.write_address == (line_buf_sel ? write_offset + GROUPS : write_offset) || !write);
    assert (dut.read_address == (line_buf_sel ? read_offset : read_offset + GROUPS));
end
endmodule
