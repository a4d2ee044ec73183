// SPDX-License-Identifier: MIT
// The nearest hit at the engine's own widths: nearest_kept.v, with cross-multiplication as the order, and any function
// instead of multiplication.
//
// Assumed about products is the lemma kept-is-nearest. Assumed about the engine: a hit's denominator is not 0.
//
// [proof]
// claim = "the first of the nearest hits is kept, in the order of cross-multiplication, at full width"
// modules = ["nearest_hit"]
// any_product = true
// induction = 2
// reach = 6
// quick = ["exact one-unit reflections=0"]
// designs = [
//   "exact one-unit turn=0,1 reflections=0,1,2,3,4", "exact one-unit turn materials patterns reflections=0,1,2,3,4",
// ]
// [faults]
// "exact-vga240-u1-r12-m1-c8" = ["nearest_hit.nearest_product edge", "nearest_hit.found_slope as denominator",
//   "nearest_hit.found_slope short"]
// "exact-vga240-u1-r12-m2-c8-turn-materials-patterns" = ["nearest_hit.nearer and found",
//   "nearest_hit.found_at_mirror as at_mirror"]

module nearest_products;
localparam DISTANCE_BITS = EYE_BITS - 1, WAY_BITS = DISTANCE_BITS + SLOPE_BITS, HIT_BITS = 1 + WAY_BITS + SURFACE_BITS;
nearest_hit dut (.*);
always @* if (hit) assume (denominator != 0);
wire [HIT_BITS-1:0] now = {at_mirror, numerator, denominator, offered_word};
wire [HIT_BITS-1:0] kept = {found_at_mirror, found_distance, found_slope, found_surface_word};
wire [WAY_BITS-1:0] way_now = numerator * found_slope, way_kept = found_distance * denominator;
wire nearer = offered && (!found || way_now < way_kept);
`include "nearest_kept.v"

wire [DISTANCE_BITS-1:0] picked_n = picked_hit >> SURFACE_BITS + SLOPE_BITS;
wire [SLOPE_BITS-1:0] picked_e = picked_hit >> SURFACE_BITS;
wire [WAY_BITS-1:0] kept_way = found_distance * picked_e, picked_way = picked_n * found_slope;
wire [WAY_BITS-1:0] now_way = numerator * picked_e, picked_way_now = picked_n * denominator;
always @* if (offered && picked && way_now < way_kept && kept_way <= picked_way)
    assume (now_way < picked_way_now);  // kept-is-nearest

always @* begin
    if (ready && found) assert (found_slope != 0);
    if (picked) assert (picked_e != 0);
    if (picked && before) assert (kept_way <= picked_way);
    if (picked && later) assert (kept_way < picked_way);
end
endmodule
