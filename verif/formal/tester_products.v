// SPDX-License-Identifier: MIT
// The rectangle test at the engine's own widths, with any function instead of multiplication: a rectangle is hit if the
// cross-multiplied definition says so, for any products with two known properties, which are lemmas: order-kept,
// assumed below, and passed-bound, by which a near bound behind the eye needs no product.
//
// All differences are computed here in numbers that are wide enough; those that are multiplied are asserted to fit the
// engine's unsigned operands. Assumed, as the engine guarantees: an axis of 0, 1 or 2, and an eye no further away than
// REFLECTIONS mirrors can move it. The ray, the rectangle and the mirror may change in every cycle.
//
// [proof]
// claim = "a rectangle is hit if the cross-multiplied definition says so, and no distance overflows, at full width"
// modules = ["rect_tester", "extent_tester"]
// any_product = true
// parameters = { SLOPE_BITS = "LIGHT_BITS if LIGHT else SLOPE_BITS" }
// induction = 4
// reach = 5
// designs = [
//   "exact one-unit turn=0,1 reflections=0,1,2,3,4", "exact one-unit turn materials patterns reflections=0,1,2,3,4",
//   "exact one-unit light reflections=0,1,2,3,4",
//   "exact one-unit light turn materials patterns reflections=0,1,2,3,4",
// ]
// [faults]
// "exact-vga240-u1-r12-m1-c8" = ["rect_tester.extent_tester_0_i.slope as slope_v", "extent_tester.way_to_far short",
//   "extent_tester.way_to_near_2 edge", "extent_tester.flipped_eye increased", "extent_tester.to_far_1 short"]
// "exact-vga240-u1-r12-m2-c8-turn" = ["rect_tester.by_axis_12_i.on_y as mirror_met_x",
//   "extent_tester.to_near_1 edge"]

module tester_products #(
    parameter COORDINATE_BITS = 9, parameter LOOK_BITS = 24, parameter SLOPE_BITS = 8, parameter EYE_BITS = 11,
    parameter REFLECTIONS = 1
) (
    input clk, input started, input [1:0] axis, input [COORDINATE_BITS-1:0] position, input [LOOK_BITS-1:0] look,
    input [COORDINATE_BITS-1:0] u_low, input [COORDINATE_BITS-1:0] u_high, input [COORDINATE_BITS-1:0] v_low,
    input [COORDINATE_BITS-1:0] v_high, input signed [EYE_BITS-1:0] x, input signed [EYE_BITS-1:0] y,
    input signed [EYE_BITS-1:0] z, input [SLOPE_BITS-1:0] dx, input [SLOPE_BITS-1:0] dy, input [SLOPE_BITS-1:0] dz,
    input [2:0] backward, input mirrored, input [1:0] mirror_axis, input [EYE_BITS-2:0] mirror, input [2:0] met
);
localparam LAST = (1 << COORDINATE_BITS) - 1, DISTANCE_BITS = EYE_BITS - 1, WIDE = EYE_BITS + 2;
localparam WAY_BITS = DISTANCE_BITS + SLOPE_BITS;

wire hit, at_mirror;
wire [DISTANCE_BITS-1:0] numerator;
wire [SLOPE_BITS-1:0] denominator;

wire [2 + LOOK_BITS + 5 * COORDINATE_BITS - 1:0] rect = {axis, position, look, u_low, u_high, v_low, v_high};
wire [2:0] signs = {backward[0], backward[1], backward[2]};
reg [DISTANCE_BITS-1:0] mirror_1;
always @(posedge clk) mirror_1 <= mirror;  // read one cycle after all other inputs
wire [DISTANCE_BITS + 2 + (REFLECTIONS > 1 ? 3 : 0):0] mirror_word =
    {mirrored, mirror_axis, mirror_1, met[0], met[1], met[2]} >> (REFLECTIONS > 1 ? 0 : 3);
rect_tester dut (
    .clk(clk), .steps_find_intersection(started), .rect_word(rect), .eye_x(x), .eye_y(y), .eye_z(z),
    .signs_word(signs), .slope_dx(dx), .slope_dy(dy), .slope_dz(dz),
    .mirror_word(mirror_word), .hit(hit),
    .at_mirror(at_mirror), .numerator(numerator), .denominator(denominator)
);

function in_reach(input signed [WIDE-1:0] place);
    in_reach = place >= -LAST * REFLECTIONS && place <= LAST * (REFLECTIONS + 1);
endfunction
always @* begin
    assume (axis < 3 && mirror_axis < 3);
    assume (in_reach(x) && in_reach(y) && in_reach(z));
    if (mirrored && REFLECTIONS < 2) assume (met == 1 << mirror_axis);
end

// The axes from the rectangle's point of view, and the distances of its plane and bounds in the ray's direction.
wire signed [WIDE-1:0] eye_a = axis == 0 ? x : axis == 1 ? y : z;
wire signed [WIDE-1:0] eye_u = axis == 0 ? y : x;
wire signed [WIDE-1:0] eye_v = axis == 2 ? y : z;
wire [SLOPE_BITS-1:0] e = axis == 0 ? dx : axis == 1 ? dy : dz;
wire [SLOPE_BITS-1:0] slope_u = axis == 0 ? dy : dx;
wire [SLOPE_BITS-1:0] slope_v = axis == 2 ? dy : dz;
wire back = axis == 0 ? backward[0] : axis == 1 ? backward[1] : backward[2];
wire back_u = axis == 0 ? backward[1] : backward[0];
wire back_v = axis == 2 ? backward[1] : backward[2];
wire on_a = mirrored && mirror_axis == axis;
wire on_u = mirrored && mirror_axis == (axis == 0 ? 1 : 0);
wire on_v = mirrored && mirror_axis == (axis == 2 ? 1 : 2);
wire signed [WIDE-1:0] plane = {1'b0, position}, low_u = {1'b0, u_low}, high_u = {1'b0, u_high};
wire signed [WIDE-1:0] low_v = {1'b0, v_low}, high_v = {1'b0, v_high}, place = {1'b0, mirror};
wire signed [WIDE-1:0] n = back ? eye_a - plane : plane - eye_a;
wire signed [WIDE-1:0] near_u = back_u ? eye_u - high_u : low_u - eye_u;
wire signed [WIDE-1:0] near_v = back_v ? eye_v - high_v : low_v - eye_v;
wire signed [WIDE-1:0] far_u = back_u ? eye_u - low_u : high_u - eye_u;
wire signed [WIDE-1:0] far_v = back_v ? eye_v - low_v : high_v - eye_v;

function fits(input signed [WIDE-1:0] distance);
    fits = distance < 1 << DISTANCE_BITS;
endfunction
always @* assert (fits(n) && fits(near_u) && fits(near_v) && fits(far_u) && fits(far_v));

// Products of distances that are not negative; those of others are not read.
wire [DISTANCE_BITS-1:0] n_part = n, near_u_part = near_u, near_v_part = near_v, far_u_part = far_u;
wire [DISTANCE_BITS-1:0] far_v_part = far_v;
wire [WAY_BITS-1:0] way_u = n_part * slope_u, way_v = n_part * slope_v;
wire [WAY_BITS-1:0] to_near_u = near_u_part * e, to_near_v = near_v_part * e;
wire [WAY_BITS-1:0] to_far_u = far_u_part * e, to_far_v = far_v_part * e, to_mirror = mirror * e;
always @* if (e != 0) begin  // order-kept
    if (near_u >= 0) assume ((near_u < place) == (to_near_u < to_mirror) && (near_u == place) == (to_near_u == to_mirror));
    if (near_v >= 0) assume ((near_v < place) == (to_near_v < to_mirror) && (near_v == place) == (to_near_v == to_mirror));
end

wire ahead = e != 0 && n > 0;
wire within_u = (near_u < 0 || to_near_u <= way_u) && far_u >= 0 && way_u <= to_far_u;
wire within_v = (near_v < 0 || to_near_v <= way_v) && far_v >= 0 && way_v <= to_far_v;
wire in_mirror = on_u && way_u == to_mirror || on_v && way_v == to_mirror;
wire beyond = (!on_a || n > place) && (!on_u || way_u > to_mirror) && (!on_v || way_v > to_mirror);
wire defined = ahead && within_u && within_v && (beyond || in_mirror && !met[axis]);

// The result comes three cycles later.
reg [2:0] valid = 3'b000, hits, in_mirrors;
reg [DISTANCE_BITS-1:0] n_1, n_2, n_3;
reg [SLOPE_BITS-1:0] e_1, e_2, e_3;
`include "tester_result.v"
endmodule
