// SPDX-License-Identifier: MIT
// The nearest hit at the engine's own widths, with any function instead of multiplication: of all hits offered since
// the last reset, the nearest by cross-multiplication is kept, or the first one of a tie. `picked` is an arbitrary one
// of these hits, so what is asserted for it holds for all.
//
// Assumed about products is the lemma kept-is-nearest. Assumed about the engine: a hit's denominator is not 0, and
// nothing is offered in the cycle of a reset. All other inputs may change in every cycle.
//
// [proof]
// claim = "the first of the nearest hits is kept, in the order of cross-multiplication, at full width"
// modules = ["nearest_hit"]
// any_product = true
// parameters = { DISTANCE_BITS = "EYE_BITS - 1" }
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

module nearest_products #(
    parameter SURFACE_BITS = 35, parameter SLOPE_BITS = 8, parameter DISTANCE_BITS = 10
) (
    input clk, input reset, input write, input hit, input corner, input [DISTANCE_BITS-1:0] n,
    input [SLOPE_BITS-1:0] e, input [SURFACE_BITS-1:0] surface, input pick
);
localparam WAY_BITS = DISTANCE_BITS + SLOPE_BITS, HIT_BITS = 1 + WAY_BITS + SURFACE_BITS;

wire found, found_corner;
wire [DISTANCE_BITS-1:0] found_n;
wire [SLOPE_BITS-1:0] found_e;
wire [SURFACE_BITS-1:0] found_surface;
nearest_hit dut (
    .clk(clk), .hit(hit), .at_mirror(corner), .numerator(n), .denominator(e), .found(found), .found_distance(found_n),
    .found_slope(found_e), .found_at_mirror(found_corner), .steps_reset_z_buf(reset), .steps_write_z_buf(write),
    .offered_word(surface), .found_surface_word(found_surface)
);

wire offered = write && hit;
wire [HIT_BITS-1:0] now = {corner, n, e, surface};
wire [HIT_BITS-1:0] kept = {found_corner, found_n, found_e, found_surface};
always @* begin
    assume (!(reset && write));
    if (hit) assume (e != 0);
end

// The kept hit was offered, and is kept unchanged.
reg running = 1'b0, ready = 1'b0, was_found, was_offered, was_reset;
reg [HIT_BITS-1:0] was_now, was_kept;
always @(posedge clk) begin
    ready <= ready || reset;  // from the first reset on
    running <= ready;
    was_found <= found;
    was_offered <= offered;
    was_reset <= reset;
    was_now <= now;
    was_kept <= kept;
end
always @* if (running) begin
    assert (found == (!was_reset && (was_found || was_offered)));
    if (found) assert (was_found && kept == was_kept || was_offered && kept == was_now);
    if (found && !was_found) assert (kept == was_now);
end

// The picked hit; whether the kept hit came before it, came after it, or is the same.
reg picked = 1'b0, later, same;
reg [DISTANCE_BITS-1:0] picked_n;
reg [SLOPE_BITS-1:0] picked_e;
wire [WAY_BITS-1:0] way_now = n * found_e, way_kept = found_n * e;
wire nearer = offered && (!found || way_now < way_kept);
always @(posedge clk) begin
    if (reset) picked <= 1'b0;
    else if (offered && pick && !picked && ready) begin
        picked <= 1'b1;
        picked_n <= n;
        picked_e <= e;
        same <= nearer;
        later <= 1'b0;
    end
    else if (nearer) begin
        same <= 1'b0;
        later <= 1'b1;
    end
end

wire [WAY_BITS-1:0] kept_way = found_n * picked_e, picked_way = picked_n * found_e;
wire [WAY_BITS-1:0] now_way = n * picked_e, picked_way_now = picked_n * e;
always @* if (offered && picked && way_now < way_kept && kept_way <= picked_way)
    assume (now_way < picked_way_now);  // kept-is-nearest

always @* if (picked) begin
    assert (ready && found && picked_e != 0 && found_e != 0);
    assert (!(same && later));
    if (same) assert (found_n == picked_n && found_e == picked_e);
    else if (later) assert (kept_way < picked_way);
    else assert (kept_way <= picked_way);
end
always @* if (ready && found) assert (found_e != 0);

always @* cover (picked && later);
always @* cover (picked && same);
always @* cover (picked && !same && !later);
endmodule
