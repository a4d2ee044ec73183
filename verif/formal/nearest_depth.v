// SPDX-License-Identifier: MIT
// The seed engine's nearest hit at full width: of all hits offered since the last reset, the nearest along x is kept
// with all its fields, or the first one of a tie. `picked` is an arbitrary one of these hits, so what is asserted for
// it holds for all.
//
// Assumed, as the control guarantees: nothing is offered in the cycle of a reset. All other inputs may change in every
// cycle.
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

module nearest_depth #(parameter POSITION_BITS = 9, parameter LOOK_BITS = 24, parameter MATERIALS = 0) (
    input clk, input reset, input write, input hit, input [POSITION_BITS-1:0] depth, input [3*POSITION_BITS-1:0] point,
    input [LOOK_BITS+46:0] rect, input [23:0] colour, input pick
);
localparam P = POSITION_BITS, HIT_BITS = 3 * P + 29;

wire found;
wire [1:0] found_axis;
wire [2:0] found_mirror;
wire [23:0] found_colour;
wire [3*P-1:0] found_point;
generate
    if (MATERIALS) begin: design
        z_buffer dut (
            .clk(clk), .colour(colour), .hit(hit), .depth(depth), .found(found), .found_axis(found_axis),
            .found_colour(found_colour), .found_mirror(found_mirror), .steps_reset_z_buf(reset),
            .steps_write_z_buf(write), .offered_word(rect), .point_word(point), .found_point_word(found_point)
        );
    end
    else begin: design
        z_buffer dut (
            .clk(clk), .colour(colour), .hit(hit), .depth(depth), .found(found), .found_axis(found_axis),
            .found_colour(found_colour), .steps_reset_z_buf(reset), .steps_write_z_buf(write), .offered_word(rect),
            .point_word(point), .found_point_word(found_point)
        );
        assign found_mirror = 0;
    end
endgenerate

wire offered = write && hit;
wire [1:0] axis = rect[LOOK_BITS+46 -: 2];
wire [2:0] mirror = MATERIALS ? rect[LOOK_BITS+11 -: 3] : 3'd0;
wire [HIT_BITS-1:0] now = {axis, mirror, colour, point};
wire [HIT_BITS-1:0] kept = {found_axis, found_mirror, found_colour, found_point};
always @* assume (!(reset && write));

// The picked hit, and the depth of the kept hit, which came before it, came after it, or is the same.
reg ready = 1'b0, picked = 1'b0, before, same;
reg [P-1:0] picked_depth, kept_depth;
reg [HIT_BITS-1:0] kept_hit;
wire nearer = offered && (!found || depth < kept_depth);
always @(posedge clk) begin
    ready <= ready || reset;  // from the first reset on
    if (nearer) {kept_depth, kept_hit} <= {depth, now};
    if (reset) picked <= 1'b0;
    else if (offered && pick && !picked && ready) begin
        picked <= 1'b1;
        picked_depth <= depth;
        same <= nearer;
        before <= !nearer;
    end
    else if (nearer) {same, before} <= 2'b00;
end
always @* if (ready && found) assert (kept == kept_hit && kept_depth == \design.dut.nearest );
always @* if (picked) begin
    assert (ready && found);
    if (same) assert (kept_depth == picked_depth);
    else if (before) assert (kept_depth <= picked_depth);
    else assert (kept_depth < picked_depth);
end
(* hierconn *) wire [P-1:0] \design.dut.nearest ;

reg was_found, was_offered, was_reset, running = 1'b0;
always @(posedge clk) begin
    running <= ready;
    was_found <= found;
    was_offered <= offered;
    was_reset <= reset;
end
always @* if (running) assert (found == (!was_reset && (was_found || was_offered)));

always @* cover (picked && same);
always @* cover (picked && before);
always @* cover (picked && !same && !before && found_axis == 2);
endmodule
