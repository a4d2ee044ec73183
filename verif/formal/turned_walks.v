// SPDX-License-Identifier: MIT
// The walkers of a beam engine whose camera turns, at their own widths, with any function instead of multiplication:
// whichever steps add up to a slope, a rectangle's registers are the products of its distances with that slope. The
// first step of a row adds its first slope to 0, all others add the growth per column. The ways, the bounds and the
// slope may be stepped in different cycles.
//
// Assumed about products are the lemma next-column, and that a product with 0 is 0. Assumed about a step, as row-setup
// proves: it adds a distance times the growth of the slope. By slope-in-range no slope along a row is too steep.
//
// [proof]
// claim = "with a turning camera, a rectangle's registers are its distances times the slope, at full width"
// modules = ["rect_walker", "slope_walker"]
// any_product = true
// parameters = { SLOPE_BITS = "SLOPE_BITS + 1" }
// induction = 1
// reach = 5
// quick = ["beam two turn"]
// designs = ["beam two pairs turn"]
// [faults]
// "beam-vga240-s2-u1-r2-m1-c8-turn" = ["rect_walker.low_q signed-short", "rect_walker.growth_way_q negated",
//   "slope_walker.slope_z late"]

module turned_walks;
localparam WIDE = SLOPE_BITS + 1, FIELDS = 6;

// A rectangle: its axis, and n and the distances to the four bounds, n in the lowest bits.
(* anyseq *) reg start_line, step_slope;
(* anyseq *) reg [1:0] any_axis;
(* anyseq *) reg [5*DISTANCE_BITS-1:0] any_distances;
reg started = 1'b0;
reg [1:0] axis;
reg [5*DISTANCE_BITS-1:0] distances;
always @(posedge clk) begin
    started <= started || start_line;
    if (start_line) {axis, distances} <= {any_axis, any_distances};
end
always @* assume (any_axis < 3);

// The sums of all steps, x in the lowest bits.
wire [3*SLOPE_BITS-1:0] aim = {aim_z, aim_y, aim_x};
wire [3*WIDE-1:0] way_slope, bounds_slope, slope;
slope_sum #(SLOPE_BITS, STEEPEST) ways (clk, start_line, started, step_way, aim, way_slope);
slope_sum #(SLOPE_BITS, STEEPEST) bounds (clk, start_line, started, step_bounds, aim, bounds_slope);
slope_sum #(SLOPE_BITS, STEEPEST) slopes (clk, start_line, started, step_slope, aim, slope);

// p is y unless the plane is on y, then x; q is z unless the plane is on z, then x.
function [1:0] along(input integer field, input [1:0] plane);
    along = field == 0 ? (plane == 1 ? 0 : 1) : field == 1 ? (plane == 2 ? 0 : 2) : plane;
endfunction
rect_walker walker (.*, .load(start_line));
assign start_word = 0;
generate
    genvar field;
    for (field = 0; field < FIELDS; field = field + 1) begin: fields
        localparam AT = field < 2 ? 0 : field - 1;
        wire signed [DISTANCE_BITS-1:0] distance = distances[AT*DISTANCE_BITS +: DISTANCE_BITS];
        wire [1:0] which = along(field, axis);
        wire signed [WIDE-1:0] here = (field < 2 ? way_slope : bounds_slope) >> which * WIDE;
        wire signed [SLOPE_BITS-1:0] grows = aim >> which * SLOPE_BITS;
        wire signed [WIDE-1:0] step = grows, there = here + grows;
        wire signed [WALK_BITS-1:0] product = distance * here, stride = distance * step;
        wire signed [WALK_BITS-1:0] next_product = distance * there;
        assign growth_word[(FIELDS-1-field)*WALK_BITS +: WALK_BITS] = stride;
        always @* begin
            assume (next_product == product + stride);  // next-column
            if (here == 0) assume (product == 0);
        end
        wire signed [WALK_BITS-1:0] value = walk_word[(FIELDS-1-field)*WALK_BITS +: WALK_BITS];
        always @* if (started) assert (value == product);
    end

    // By product-in-range no product is further from 0 than this.
    localparam [63:0] FARTHEST = STEEPEST * ((64'd1 << DISTANCE_BITS - 1) - 1);
    always @* assert (FARTHEST < 64'd1 << WALK_BITS - 1);
endgenerate

slope_walker slope_dut (.*, .step(step_slope));
always @* if (started) begin
    assert (slope_x == $signed(slope[0 +: WIDE]));
    assert (slope_y == $signed(slope[WIDE +: WIDE]));
    assert (slope_z == $signed(slope[2*WIDE +: WIDE]));
end

always @* cover (started && way_slope != bounds_slope && bounds_slope != 0 && slope != way_slope);
endmodule

// The sum of all steps, no steeper than STEEPEST.
module slope_sum #(parameter SLOPE_BITS = 20, parameter STEEPEST = 400000) (
    input clk, input start, input started, input step, input [3*SLOPE_BITS-1:0] aim, output [3*(SLOPE_BITS+1)-1:0] slope
);
localparam WIDE = SLOPE_BITS + 1;
generate
    genvar axis;
    for (axis = 0; axis < 3; axis = axis + 1) begin: each
        reg signed [WIDE-1:0] now;
        wire signed [SLOPE_BITS-1:0] grows = aim[axis*SLOPE_BITS +: SLOPE_BITS];
        wire signed [WIDE:0] then = now + grows;
        always @(posedge clk) begin
            if (start) now <= 0;
            else if (step) now <= then;
        end
        assign slope[axis*WIDE +: WIDE] = now;
        always @* begin
            if (step && !start) assume (started && then >= -STEEPEST && then <= STEEPEST);
            if (started) assert (now >= -STEEPEST && now <= STEEPEST);
        end
    end
endgenerate
endmodule
