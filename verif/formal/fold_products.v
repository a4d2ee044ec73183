// SPDX-License-Identifier: MIT
// A fold at the engine's own widths, with any function instead of multiplication: after each mirror the camera plus T
// is the mirrored eye, 2 k - E' on the mirror's axis, and the offsets are T[p] D[a] -+ T[a] D[p] as in the lemma
// folded-way, plus one if the ray is reversed on exactly one of the two axes.
//
// Assumed about products: the lemma product-in-range, and that a product with 0 is 0. Assumed about the image before
// the mirror is what is proved about the image after it: its range, by the number of mirrors so far. Assumed, as the
// lane guarantees: an axis is 0, 1 or 2, and the slope is read in the cycle after the mirror. All inputs except the
// number of the mirror may change in every cycle.
//
// [proof]
// claim = "at each mirror the ray is folded like the mirrored eye and slope, and no number overflows, at full width"
// modules = ["ray_fold"]
// any_product = true
// induction = 4
// reach = 5
// quick = ["beam two"]
// designs = [
//   "beam two reflections=2", "beam two pairs", "beam two pairs turn", "beam two turn patterns reflections=4",
// ]
// [faults]
// "beam-vga240-s2-u1-r2-m1-c8" = ["ray_fold.sum_xz_1 increased", "ray_fold.slope_z as slope_y",
//   "ray_fold.distance_1 as last_distance", "ray_fold.shift_y signed-short", "ray_fold.folds_y as y_back"]
// "beam-vga240-s2-u1-r2-m2-c8" = ["ray_fold.shift negated", "ray_fold.back_y_2 or back_z_2",
//   "ray_fold.before_met_x 0"]

module fold_products #(
    parameter COORDINATE_BITS = 9, parameter SLOPE_BITS = 9, parameter STEEPEST = 320, parameter REFLECTIONS = 1,
    parameter WALK_BITS = 19, parameter SHIFT_BITS = 11, parameter FOLD_BITS = 21
) (
    input clk, input [COORDINATE_BITS-1:0] x, input [COORDINATE_BITS-1:0] y, input [COORDINATE_BITS-1:0] z,
    input signed [SHIFT_BITS:0] mirrored_x, input signed [SHIFT_BITS:0] mirrored_y,
    input signed [SHIFT_BITS:0] mirrored_z, input [2:0] back, input [2:0] met, input at_mirror, input [1:0] axis,
    input [COORDINATE_BITS-1:0] plane, input signed [SLOPE_BITS:0] dx, input signed [SLOPE_BITS:0] dy,
    input signed [SLOPE_BITS:0] dz
);
localparam LAST = (1 << COORDINATE_BITS) - 1, WIDE = SHIFT_BITS + 3, DISTANCE_BITS = COORDINATE_BITS + 1;
localparam FIELDS = 6, SUM = FOLD_BITS + 2;

// Vectors have x in the lowest bits; words of the design have it in the highest.
wire [3*WIDE-1:0] eye, mirrored, moved, reflected;
wire [3*SHIFT_BITS-1:0] shift;
wire [2:0] on_axis = 1 << axis, back_after = back ^ on_axis, met_after = at_mirror ? met | on_axis : on_axis;
wire signed [WIDE-1:0] k = {1'b0, plane}, distance = k - $signed(eye[axis*WIDE +: WIDE]);
(* anyconst *) reg [2:0] number;
always @* assume (axis < 3 && number >= 1 && number <= REFLECTIONS);

// An even number of mirrors on an axis moves the eye by twice a distance for each pair; an odd number is one mirror
// more, which turns the axis. So T fits its bits, and the eye is in the range of the lemma eye-in-range.
function in_reach(input signed [WIDE-1:0] camera, input signed [WIDE-1:0] place, input turned, input [2:0] mirrors);
    reg signed [WIDE-1:0] even, odd;
    begin
        even = LAST * {mirrors[2:1], 1'b0};
        odd = LAST * (mirrors[0] ? mirrors : mirrors - 1);
        in_reach = turned ? mirrors != 0 && place + camera >= LAST - odd && place + camera <= LAST + odd
            : place - camera >= -even && place - camera <= even;
    end
endfunction
assign eye = {{WIDE-COORDINATE_BITS{1'b0}}, z, {WIDE-COORDINATE_BITS{1'b0}}, y, {WIDE-COORDINATE_BITS{1'b0}}, x};
wire signed [WIDE-1:0] wide_x = mirrored_x, wide_y = mirrored_y, wide_z = mirrored_z;
assign mirrored = {wide_z, wide_y, wide_x};
generate
    genvar i;
    for (i = 0; i < 3; i = i + 1) begin: axes
        wire signed [WIDE-1:0] from = eye[i*WIDE +: WIDE], at = mirrored[i*WIDE +: WIDE], by = at - from;
        wire signed [WIDE-1:0] after = axis == i ? 2 * k - at : at, by_after = after - from;
        assign shift[i*SHIFT_BITS +: SHIFT_BITS] = by;
        assign moved[i*WIDE +: WIDE] = by_after;
        always @* begin
            assume (in_reach(from, at, back[i], number - 1));
            assert (in_reach(from, after, back_after[i], number));
            assert (by_after >= -(1 << SHIFT_BITS - 1) && by_after < 1 << SHIFT_BITS - 1);
            assert (after >= -LAST * $signed({1'b0, number}) && after <= LAST * ($signed({1'b0, number}) + 1));
        end
    end
endgenerate

localparam SIDES = 6, FOLD_WORD = SIDES + 3 * SHIFT_BITS + 1 + FIELDS * FOLD_BITS + 3 * WALK_BITS + 2 + DISTANCE_BITS;
wire [2:0] fold_met, fold_back;
wire [3*SHIFT_BITS-1:0] fold_shift;
wire fold_mirror_back;
wire [FIELDS*FOLD_BITS-1:0] offsets;
wire [3*WALK_BITS-1:0] borders;
wire [1:0] fold_axis;
wire signed [DISTANCE_BITS-1:0] fold_distance;
ray_fold dut (
    .clk(clk),
    .before_word({met[0], met[1], met[2], back[0], back[1], back[2], shift[0 +: SHIFT_BITS],
        shift[SHIFT_BITS +: SHIFT_BITS], shift[2*SHIFT_BITS +: SHIFT_BITS]}),
    .last_word({at_mirror, axis, distance[DISTANCE_BITS-1:0]}),
    .slope_x(dx), .slope_y(dy), .slope_z(dz),
    .fold_word({fold_met[0], fold_met[1], fold_met[2], fold_back[0], fold_back[1], fold_back[2],
        fold_shift[0 +: SHIFT_BITS], fold_shift[SHIFT_BITS +: SHIFT_BITS], fold_shift[2*SHIFT_BITS +: SHIFT_BITS],
        fold_mirror_back, offsets[0 +: FOLD_BITS], offsets[FOLD_BITS +: FOLD_BITS], offsets[2*FOLD_BITS +: FOLD_BITS],
        offsets[3*FOLD_BITS +: FOLD_BITS], offsets[4*FOLD_BITS +: FOLD_BITS], offsets[5*FOLD_BITS +: FOLD_BITS],
        borders[0 +: WALK_BITS], borders[WALK_BITS +: WALK_BITS], borders[2*WALK_BITS +: WALK_BITS], fold_axis,
        fold_distance})
);

// The fold follows three cycles after the mirror.
localparam signed [63:0] STEEP = STEEPEST, FARTHEST = STEEP << SHIFT_BITS - 1;
reg [2:0] age = 0;
reg [3*WIDE-1:0] moved_1, moved_2, moved_3;
reg [2:0] back_1, back_2, back_3, met_1, met_2, met_3;
reg [1:0] axis_1, axis_2, axis_3;
reg signed [WIDE-1:0] distance_1, distance_2, distance_3;
reg runs_back_2, runs_back_3;
wire [3*(SLOPE_BITS+1)-1:0] slope = {dz, dy, dx};
wire [2:0] down = {dz < 0, dy < 0, dx < 0};
always @(posedge clk) begin
    age <= {age, 1'b1};
    {moved_3, moved_2, moved_1} <= {moved_2, moved_1, moved};
    {back_3, back_2, back_1} <= {back_2, back_1, back_after};
    {met_3, met_2, met_1} <= {met_2, met_1, met_after};
    {axis_3, axis_2, axis_1} <= {axis_2, axis_1, axis};
    {distance_3, distance_2, distance_1} <= {distance_2, distance_1, distance};
    {runs_back_3, runs_back_2} <= {runs_back_2, back_1[axis_1] != down[axis_1]};
end
always @* if (age[2]) begin
    assert (fold_met == met_3 && fold_back == back_3 && fold_axis == axis_3 && fold_distance == distance_3);
    assert (fold_mirror_back == runs_back_3);
end

// p is y unless the plane is on y, then x; q is z unless the plane is on z, then x: first p for all three axes, then q.
function [1:0] along(input integer field);
    along = field == 1 || field == 5 ? 0 : field < 3 ? 1 : 2;
endfunction
generate
    genvar field;
    for (i = 0; i < 3; i = i + 1) begin: turns
        wire signed [SLOPE_BITS:0] component = slope[i*(SLOPE_BITS+1) +: SLOPE_BITS+1];
        wire signed [DISTANCE_BITS-1:0] narrow = distance_1;
        wire signed [WALK_BITS-1:0] border = narrow * component;
        reg signed [WALK_BITS-1:0] border_2, border_3;
        always @(posedge clk) {border_3, border_2} <= {border_2, border};
        always @* begin
            assume (component >= -STEEP && component <= STEEP);
            if (age[2]) begin
                assert ($signed(fold_shift[i*SHIFT_BITS +: SHIFT_BITS]) == $signed(moved_3[i*WIDE +: WIDE]));
                assert (borders[i*WALK_BITS +: WALK_BITS] == border_3);
            end
        end
    end
    for (field = 0; field < FIELDS; field = field + 1) begin: fields
        localparam A = field % 3, P = along(field);
        wire signed [SHIFT_BITS-1:0] shift_a = moved_1[A*WIDE +: SHIFT_BITS], shift_p = moved_1[P*WIDE +: SHIFT_BITS];
        wire signed [SLOPE_BITS:0] slope_a = slope[A*(SLOPE_BITS+1) +: SLOPE_BITS+1];
        wire signed [SLOPE_BITS:0] slope_p = slope[P*(SLOPE_BITS+1) +: SLOPE_BITS+1];
        wire signed [FOLD_BITS-1:0] p_by_a = shift_p * slope_a, a_by_p = shift_a * slope_p;
        wire signed [SUM-1:0] wide_p_by_a = p_by_a, wide_a_by_p = a_by_p;
        wire differ = back_1[A] != back_1[P];
        wire signed [SUM-1:0] offset = differ ? wide_p_by_a + wide_a_by_p + 1 : wide_p_by_a - wide_a_by_p;
        reg signed [SUM-1:0] offset_2, offset_3;
        always @(posedge clk) {offset_3, offset_2} <= {offset_2, offset};
        always @* begin
            // product-in-range
            assume (p_by_a >= -FARTHEST && p_by_a <= FARTHEST && a_by_p >= -FARTHEST && a_by_p <= FARTHEST);
            if (shift_p == 0) assume (p_by_a == 0);
            if (shift_a == 0) assume (a_by_p == 0);
            if (age[2]) assert ($signed(offsets[field*FOLD_BITS +: FOLD_BITS]) == offset_3);
        end
    end
endgenerate

always @* cover (age[2] && fold_met == 3 && number == REFLECTIONS);
always @* cover (age[2] && offsets[0 +: FOLD_BITS] == 3 && fold_mirror_back && fold_back != 0);
endmodule
