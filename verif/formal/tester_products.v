// SPDX-License-Identifier: MIT
// The rectangle test at the engine's own widths, with any function instead of multiplication: a rectangle is hit if the
// cross-multiplied definition says so, for any products with two known properties, which are lemmas: order-kept,
// assumed below, and passed-bound, by which a near bound behind the eye needs no product.
//
// All differences are computed here in numbers that are wide enough; those that are multiplied are asserted to fit the
// engine's unsigned operands. All other assumptions are in tester_ray.v.
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

module tester_products;
localparam DISTANCE_BITS = EYE_BITS - 1, WIDE = EYE_BITS + 2, WAY_BITS = DISTANCE_BITS + SLOPE_BITS;
`include "tester_ray.v"

(* anyseq *) reg [DISTANCE_BITS-1:0] distance;
wire signed [WIDE-1:0] place = {1'b0, distance};
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
wire [WAY_BITS-1:0] to_far_u = far_u_part * e, to_far_v = far_v_part * e, to_mirror = distance * e;
always @* if (e != 0) begin  // order-kept
    if (near_u >= 0) assume ((near_u < place) == (to_near_u < to_mirror));
    if (near_u >= 0) assume ((near_u == place) == (to_near_u == to_mirror));
    if (near_v >= 0) assume ((near_v < place) == (to_near_v < to_mirror));
    if (near_v >= 0) assume ((near_v == place) == (to_near_v == to_mirror));
end

wire within_u = (near_u < 0 || to_near_u <= way_u) && far_u >= 0 && way_u <= to_far_u;
wire within_v = (near_v < 0 || to_near_v <= way_v) && far_v >= 0 && way_v <= to_far_v;
wire in_mirror = on_u && way_u == to_mirror || on_v && way_v == to_mirror;
wire beyond = (!on_a || n > place) && (!on_u || way_u > to_mirror) && (!on_v || way_v > to_mirror);
wire defined = ahead && within_u && within_v && (beyond || in_mirror && !met[axis]);
endmodule
