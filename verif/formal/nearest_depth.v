// SPDX-License-Identifier: MIT
// The seed engine's nearest hit at full width: nearest_kept.v, with the distance along x as the order.
//
// [proof]
// claim = "the first of the hits that are nearest along x is kept, with all its data, at full width"
// modules = ["z_buffer"]
// induction = 2
// reach = 6
// quick = ["one-unit"]
// designs = ["one-unit materials patterns fraction_bits=8"]
// [faults]
// "vga240-u1-r12-m1-f0t-d3-c8" = ["z_buffer.nearest edge", "z_buffer.nearest short",
//   "z_buffer.found_point_word late"]

module nearest_depth;
localparam HIT_BITS = 4 * POSITION_BITS + 29;
z_buffer dut (.*);
wire [HIT_BITS-1:0] now, kept;
generate
    if (MATERIALS) begin: hits
        assign now = {depth, offered_mirror, offered_axis, colour, point_word};
        assign kept = {dut.nearest, found_mirror, found_axis, found_colour, found_point_word};
    end
    else begin: hits
        assign now = {depth, offered_axis, colour, point_word};
        assign kept = {dut.nearest, found_axis, found_colour, found_point_word};
    end
endgenerate
wire nearer = offered && (!found || depth < dut.nearest);
`include "nearest_kept.v"

wire [POSITION_BITS-1:0] picked_depth = picked_hit >> (MATERIALS ? 3 : 0) + 26 + 3 * POSITION_BITS;
always @* if (picked) begin
    assert (dut.nearest <= picked_depth);
    if (later) assert (dut.nearest < picked_depth);
end
endmodule
