// SPDX-License-Identifier: MIT
// The beam engine's folded ray compared with the definition, with a division: P = E' + D' t, on the ray from the
// mirrored eye, is ahead, within the bounds, and beyond the last mirror on the side that the slope points to: strictly,
// or in the mirror's plane if the ray has met no mirror on the rectangle's axis there.
//
// One ray, one rectangle and up to two mirrors are constant, and after a few cycles have passed the pipeline. Assumed,
// as the engine guarantees: bounds in order, axes 0 to 2, and mirrors that the ray meets one after the other, or in one
// point if they are on different axes. VIEW_DISTANCE is the slope along x; 0 means any slope, as with a camera that
// turns.
//
// [proof]
// claim = "a ray hits a rectangle if the ray from the mirrored eye, by a division, is within it and beyond the mirror"
// modules = ["ray_fold", "ray_tester", "fold_tester", "bound_tester"]
// induction = 8
// reach = 9
// label = "{COORDINATE_BITS} and {SLOPE_BITS} bits, {MIRRORS} mirrors{'' if VIEW_DISTANCE else ', turned'}"
// quick = ["alone=fold COORDINATE_BITS=2 SLOPE_BITS=1 VIEW_DISTANCE=1 MIRRORS=1"]
// designs = [
//   "alone=fold COORDINATE_BITS=2 SLOPE_BITS=1 VIEW_DISTANCE=0 MIRRORS=1",
//   "alone=fold COORDINATE_BITS=2 SLOPE_BITS=1 VIEW_DISTANCE=1 MIRRORS=2",
//   "alone=fold COORDINATE_BITS=2 SLOPE_BITS=2 VIEW_DISTANCE=2 MIRRORS=1,2",
//   "alone=fold COORDINATE_BITS=3 SLOPE_BITS=2 VIEW_DISTANCE=3 MIRRORS=1",
// ]
// [faults]
// "2 and 1 bits, 1 mirrors" = ["fold_tester.met_2 1", "fold_tester.plane_fold_distance edge",
//   "ray_fold.sum_xz_1 increased", "bound_tester.back_1 0", "bound_tester.low_edge as twice_low"]

module fold_exact #(
    parameter COORDINATE_BITS = 2, parameter SLOPE_BITS = 2, parameter VIEW_DISTANCE = 2, parameter MIRRORS = 1,
    parameter WALK_BITS = 6, parameter FOLD_BITS = 7, parameter NUMERATOR_BITS = 4
) (
    input clk
);
localparam SHIFT_BITS = COORDINATE_BITS + 2, WIDE = 2 * (COORDINATE_BITS + SLOPE_BITS + 4);

(* anyconst *) reg [COORDINATE_BITS-1:0] x, y, z, position, u_low, u_high, v_low, v_high, plane_1, plane_2;
(* anyconst *) reg signed [SLOPE_BITS:0] any_dx, dy, dz;
wire signed [SLOPE_BITS:0] dx = VIEW_DISTANCE == 0 ? any_dx : VIEW_DISTANCE;
(* anyconst *) reg [1:0] axis, axis_1, axis_2, count;

// All numbers are wide enough for any value; 0, 1, 2 are x, y, z.
function signed [WIDE-1:0] of_three(input [1:0] which, input signed [WIDE-1:0] first, input signed [WIDE-1:0] second,
                                    input signed [WIDE-1:0] third);
    of_three = which == 0 ? first : which == 1 ? second : third;
endfunction
function signed [WIDE-1:0] magnitude(input signed [WIDE-1:0] value);
    magnitude = value < 0 ? -value : value;
endfunction
wire signed [WIDE-1:0] eye_x = {1'b0, x}, eye_y = {1'b0, y}, eye_z = {1'b0, z}, view = dx, wide_dy = dy, wide_dz = dz;
wire signed [WIDE-1:0] k = {1'b0, position}, k_1 = {1'b0, plane_1}, k_2 = {1'b0, plane_2};

// The eye and the slope, mirrored once and twice.
wire one = count >= 1, two = count == 2;
wire signed [WIDE-1:0] x_1 = one && axis_1 == 0 ? 2 * k_1 - eye_x : eye_x, y_1 = one && axis_1 == 1 ? 2 * k_1 - eye_y : eye_y;
wire signed [WIDE-1:0] z_1 = one && axis_1 == 2 ? 2 * k_1 - eye_z : eye_z;
wire signed [WIDE-1:0] dx_1 = one && axis_1 == 0 ? -view : view, dy_1 = one && axis_1 == 1 ? -wide_dy : wide_dy;
wire signed [WIDE-1:0] dz_1 = one && axis_1 == 2 ? -wide_dz : wide_dz;
wire signed [WIDE-1:0] x_2 = two && axis_2 == 0 ? 2 * k_2 - x_1 : x_1, y_2 = two && axis_2 == 1 ? 2 * k_2 - y_1 : y_1;
wire signed [WIDE-1:0] z_2 = two && axis_2 == 2 ? 2 * k_2 - z_1 : z_1;
wire signed [WIDE-1:0] dx_2 = two && axis_2 == 0 ? -dx_1 : dx_1, dy_2 = two && axis_2 == 1 ? -dy_1 : dy_1;
wire signed [WIDE-1:0] dz_2 = two && axis_2 == 2 ? -dz_1 : dz_1;

// The distance of each mirror, and the slope along its axis: the ray must meet it, and the second after the first.
wire signed [WIDE-1:0] n_1 = k_1 - of_three(axis_1, eye_x, eye_y, eye_z), e_1 = of_three(axis_1, view, wide_dy, wide_dz);
wire signed [WIDE-1:0] n_2 = k_2 - of_three(axis_2, x_1, y_1, z_1), e_2 = of_three(axis_2, dx_1, dy_1, dz_1);
wire met_1 = n_1 * e_1 > 0;
wire later = magnitude(n_2) * magnitude(e_1) > magnitude(n_1) * magnitude(e_2);
wire together = magnitude(n_2) * magnitude(e_1) == magnitude(n_1) * magnitude(e_2);
wire met_2 = n_2 * e_2 > 0 && (later || together && axis_2 != axis_1);
always @* begin
    assume (axis < 3 && axis_1 < 3 && axis_2 < 3 && count <= MIRRORS && u_low <= u_high && v_low <= v_high);
    assume (dx != -(1 << SLOPE_BITS) && dy != -(1 << SLOPE_BITS) && dz != -(1 << SLOPE_BITS));
    if (one) assume (met_1);
    if (two) assume (met_2);
end

// Inputs of the engine's blocks: distances from the camera, and their products with the slope. p is y unless the plane
// is on y, then x; q is z unless the plane is on z, then x. The rectangle's bounds are in the order x, y, z.
wire signed [WIDE-1:0] low_0 = {1'b0, u_low}, high_0 = {1'b0, u_high}, low_1 = {1'b0, v_low}, high_1 = {1'b0, v_high};
wire swapped = axis == 2;
wire [1:0] on_p = axis == 1 ? 0 : 1, on_q = axis == 2 ? 0 : 2;
wire signed [WIDE-1:0] low_p = swapped ? low_1 : low_0, high_p = swapped ? high_1 : high_0;
wire signed [WIDE-1:0] low_q = swapped ? low_0 : low_1, high_q = swapped ? high_0 : high_1;
wire signed [WIDE-1:0] camera_p = of_three(on_p, eye_x, eye_y, eye_z), camera_q = of_three(on_q, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] slope_a = of_three(axis, view, wide_dy, wide_dz), distance = k - of_three(axis, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] way_p = distance * of_three(on_p, view, wide_dy, wide_dz);
wire signed [WIDE-1:0] way_q = distance * of_three(on_q, view, wide_dy, wide_dz);
wire signed [WIDE-1:0] walk_low_p = (low_p - camera_p) * slope_a, walk_high_p = (high_p - camera_p) * slope_a;
wire signed [WIDE-1:0] walk_low_q = (low_q - camera_q) * slope_a, walk_high_q = (high_q - camera_q) * slope_a;

wire [1:0] last_axis = two ? axis_2 : axis_1;
wire signed [WIDE-1:0] last_plane = two ? k_2 : k_1;
wire signed [WIDE-1:0] last_distance = last_plane - of_three(last_axis, eye_x, eye_y, eye_z);
localparam FOLD_WORD = 7 + 3 * SHIFT_BITS + 6 * FOLD_BITS + 3 * WALK_BITS + 2 + COORDINATE_BITS + 1;
wire [FOLD_WORD-1:0] fold;

// Words of records, the first field in the highest bits: see `raycaster.rtl.common.records`. Before the second mirror the
// ray has met the first one, which moves the image of the room as it moves the eye.
wire [2:0] before = two ? 3'b100 >> axis_1 : 3'b000;
wire signed [WIDE-1:0] moved_x = two ? x_1 - eye_x : 0, moved_y = two ? y_1 - eye_y : 0, moved_z = two ? z_1 - eye_z : 0;
ray_fold folder (
    .clk(clk),
    .before_word({before, before, moved_x[SHIFT_BITS-1:0], moved_y[SHIFT_BITS-1:0], moved_z[SHIFT_BITS-1:0]}),
    .last_word({two && together, last_axis, last_distance[COORDINATE_BITS:0]}),
    .slope_x(dx), .slope_y(dy), .slope_z(dz), .fold_word(fold)
);

localparam HIT_WORD = 2 + NUMERATOR_BITS + SLOPE_BITS + 1;
wire [HIT_WORD-1:0] seen_at_once, seen_folded;
wire hit, hit_at_mirror, hit_index;
wire [NUMERATOR_BITS-1:0] numerator;
wire [SLOPE_BITS-1:0] denominator;
wire signed [WIDE-1:0] size_x = magnitude(view), size_y = magnitude(wide_dy), size_z = magnitude(wide_dz);

// A colour has 24 bits.
wire [28+COORDINATE_BITS+WALK_BITS-1:0] facet = {1'b1, axis, distance[COORDINATE_BITS:0], way_q[WALK_BITS-1:0], 24'd0};
wire [5*WALK_BITS-1:0] walk = {way_p[WALK_BITS-1:0], walk_low_p[WALK_BITS-1:0], walk_high_p[WALK_BITS-1:0],
                               walk_low_q[WALK_BITS-1:0], walk_high_q[WALK_BITS-1:0]};
wire [2:0] signs = {dx < 0, dy < 0, dz < 0};
ray_tester at_once (
    .clk(clk), .step_way(1'b1), .step_bounds(1'b1), .step_slope(1'b1), .facet_word(facet), .walk_word(walk),
    .signs_word(signs), .slope_dx(size_x[SLOPE_BITS-1:0]), .slope_dy(size_y[SLOPE_BITS-1:0]),
    .slope_dz(size_z[SLOPE_BITS-1:0]), .index(1'b1), .hit_word(seen_at_once)
);
fold_tester folded (
    .clk(clk), .step_way(1'b1), .step_bounds(1'b1), .step_slope(1'b1), .facet_word(facet), .walk_word(walk),
    .signs_word(signs), .slope_dx(size_x[SLOPE_BITS-1:0]), .slope_dy(size_y[SLOPE_BITS-1:0]),
    .slope_dz(size_z[SLOPE_BITS-1:0]), .fold_word(fold), .index(1'b1), .hit_word(seen_folded)
);
assign {hit, hit_at_mirror, numerator, denominator, hit_index} = one ? seen_folded : seen_at_once;

// The definition: t = n / e, and the whole part and the rest of the way on p and on q from the mirrored eye.
wire signed [WIDE-1:0] eye_a = of_three(axis, x_2, y_2, z_2), slope = of_three(axis, dx_2, dy_2, dz_2);
wire signed [WIDE-1:0] eye_p = of_three(on_p, x_2, y_2, z_2), slope_p = of_three(on_p, dx_2, dy_2, dz_2);
wire signed [WIDE-1:0] eye_q = of_three(on_q, x_2, y_2, z_2), slope_q = of_three(on_q, dx_2, dy_2, dz_2);
wire signed [WIDE-1:0] n = slope < 0 ? eye_a - k : k - eye_a;
wire [WIDE-1:0] e = magnitude(slope), length_p = magnitude(slope_p) * n, length_q = magnitude(slope_q) * n;
wire ahead = slope != 0 && n > 0;
wire signed [WIDE-1:0] whole_p = ahead ? length_p / e : 0, whole_q = ahead ? length_q / e : 0;
wire more_p = ahead && length_p % e != 0, more_q = ahead && length_q % e != 0;
wire signed [WIDE-1:0] base_p = slope_p < 0 ? eye_p - whole_p : eye_p + whole_p;
wire signed [WIDE-1:0] base_q = slope_q < 0 ? eye_q - whole_q : eye_q + whole_q;

`include "quotient_point.v"
wire met = two && together && axis == axis_1;
wire at_mirror = one && last_axis != axis
    && (last_axis == on_p ? base_p == last_plane && !more_p : base_q == last_plane && !more_q);
wire clear = !one || at_mirror && !met || (last_axis == axis ? beyond(k, 1'b0, slope < 0, last_plane)
    : last_axis == on_p ? beyond(base_p, more_p, slope_p < 0, last_plane) : beyond(base_q, more_q, slope_q < 0, last_plane));
wire defined = ahead && clear && within(base_p, more_p, slope_p < 0, low_p, high_p)
    && within(base_q, more_q, slope_q < 0, low_q, high_q);

// Six cycles through both blocks.
reg [2:0] age = 3'd0;
always @(posedge clk) if (age != 7) age <= age + 1;
always @* if (age == 7) begin
    assert (hit == defined);
    if (hit) assert (numerator == n && denominator == e && hit_index && hit_at_mirror == at_mirror);
end

// Covers a hit after all the mirrors.
always @* cover (age == 7 && hit && count == MIRRORS);
endmodule
