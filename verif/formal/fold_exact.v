// SPDX-License-Identifier: MIT
// The beam engine's folded ray against the definition, with a division: the ray from the mirrored eye, P = E' + D' t, is
// ahead, within the bounds, and strictly beyond the last mirror on the side that the slope points to.
//
// One ray, one rectangle and up to two mirrors hold still; the pipeline is long enough after a few cycles. Assumed, as the
// engine has it: bounds in order, axes of three, and mirrors that the ray meets, one after the other.

module fold_exact #(
    parameter COORDINATE_BITS = 2, parameter SLOPE_BITS = 2, parameter VIEW_DISTANCE = 2, parameter MIRRORS = 1,
    parameter WALK_BITS = 6, parameter FOLD_BITS = 7, parameter NUMERATOR_BITS = 4
) (
    input clk
);
localparam TURN_BITS = COORDINATE_BITS + 2, WIDE = 2 * (COORDINATE_BITS + SLOPE_BITS + 4);

(* anyconst *) reg [COORDINATE_BITS-1:0] x, y, z, position, u_low, u_high, v_low, v_high, plane_1, plane_2;
(* anyconst *) reg signed [SLOPE_BITS:0] dy, dz;
(* anyconst *) reg [1:0] axis, axis_1, axis_2, count;

// Everything wide enough for any value; 0, 1, 2 are x, y, z.
function signed [WIDE-1:0] of_three(input [1:0] which, input signed [WIDE-1:0] first, input signed [WIDE-1:0] second,
                                    input signed [WIDE-1:0] third);
    of_three = which == 0 ? first : which == 1 ? second : third;
endfunction
function signed [WIDE-1:0] magnitude(input signed [WIDE-1:0] value);
    magnitude = value < 0 ? -value : value;
endfunction
wire signed [WIDE-1:0] eye_x = {1'b0, x}, eye_y = {1'b0, y}, eye_z = {1'b0, z}, view = VIEW_DISTANCE, wide_dy = dy, wide_dz = dz;
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

// How far each mirror is, over the slope along its axis: it must be met, and the second after the first.
wire signed [WIDE-1:0] n_1 = k_1 - of_three(axis_1, eye_x, eye_y, eye_z), e_1 = of_three(axis_1, view, wide_dy, wide_dz);
wire signed [WIDE-1:0] n_2 = k_2 - of_three(axis_2, x_1, y_1, z_1), e_2 = of_three(axis_2, dx_1, dy_1, dz_1);
wire met_1 = n_1 * e_1 > 0;
wire met_2 = n_2 * e_2 > 0 && magnitude(n_2) * magnitude(e_1) > magnitude(n_1) * magnitude(e_2);
always @* begin
    assume (axis < 3 && axis_1 < 3 && axis_2 < 3 && count <= MIRRORS && u_low <= u_high && v_low <= v_high);
    assume (dy != -(1 << SLOPE_BITS) && dz != -(1 << SLOPE_BITS));
    if (one) assume (met_1);
    if (two) assume (met_2);
end

// What the engine feeds its blocks: distances from the camera, and their products with the slope. Its u is y unless the
// plane is on y, then x; its v is z unless the plane is on z, then x. The rectangle's bounds are in the order x, y, z.
wire signed [WIDE-1:0] low_0 = {1'b0, u_low}, high_0 = {1'b0, u_high}, low_1 = {1'b0, v_low}, high_1 = {1'b0, v_high};
wire swapped = axis == 2;
wire [1:0] on_u = axis == 1 ? 0 : 1, on_v = axis == 2 ? 0 : 2;
wire signed [WIDE-1:0] low_u = swapped ? low_1 : low_0, high_u = swapped ? high_1 : high_0;
wire signed [WIDE-1:0] low_v = swapped ? low_0 : low_1, high_v = swapped ? high_0 : high_1;
wire signed [WIDE-1:0] camera_u = of_three(on_u, eye_x, eye_y, eye_z), camera_v = of_three(on_v, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] slope_a = of_three(axis, view, wide_dy, wide_dz), distance = k - of_three(axis, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] way_u = distance * of_three(on_u, view, wide_dy, wide_dz);
wire signed [WIDE-1:0] way_v = distance * of_three(on_v, view, wide_dy, wide_dz);
wire signed [WIDE-1:0] walk_low_u = (low_u - camera_u) * slope_a, walk_high_u = (high_u - camera_u) * slope_a;
wire signed [WIDE-1:0] walk_low_v = (low_v - camera_v) * slope_a, walk_high_v = (high_v - camera_v) * slope_a;

wire [1:0] last_axis = two ? axis_2 : axis_1;
wire signed [WIDE-1:0] last_plane = two ? k_2 : k_1;
wire signed [WIDE-1:0] last_distance = last_plane - of_three(last_axis, eye_x, eye_y, eye_z);
wire back_x, back_y, back_z, mirror_back;
wire signed [TURN_BITS-1:0] turn_x, turn_y, turn_z;
wire signed [FOLD_BITS-1:0] fold_u_x, fold_u_y, fold_u_z, fold_v_x, fold_v_y, fold_v_z;
wire signed [WALK_BITS-1:0] border_x, border_y, border_z;
wire [1:0] fold_axis;
wire signed [COORDINATE_BITS:0] fold_distance;

ray_fold folder (
    .clk(clk), .earlier_active(two), .earlier_axis(axis_1), .earlier_distance(n_1[COORDINATE_BITS:0]), .last_axis(last_axis),
    .last_distance(last_distance[COORDINATE_BITS:0]), .column_slope(dy), .row_slope(dz), .fold_back_x(back_x),
    .fold_back_y(back_y), .fold_back_z(back_z), .fold_mirror_back(mirror_back), .fold_turn_x(turn_x), .fold_turn_y(turn_y),
    .fold_turn_z(turn_z), .fold_u_x(fold_u_x), .fold_u_y(fold_u_y), .fold_u_z(fold_u_z), .fold_v_x(fold_v_x),
    .fold_v_y(fold_v_y), .fold_v_z(fold_v_z), .fold_border_x(border_x), .fold_border_y(border_y), .fold_border_z(border_z),
    .fold_axis(fold_axis), .fold_distance(fold_distance)
);

wire hit;
wire [NUMERATOR_BITS-1:0] numerator;
wire [SLOPE_BITS-1:0] denominator;
wire signed [WIDE-1:0] size_y = magnitude(wide_dy), size_z = magnitude(wide_dz);

// Without a mirror all of the fold is 0.
fold_tester tester (
    .clk(clk), .facet_usable(1'b1), .facet_axis(axis), .facet_distance(distance[COORDINATE_BITS:0]),
    .facet_way_v(way_v[WALK_BITS-1:0]), .walk_way_u(way_u[WALK_BITS-1:0]), .walk_low_u(walk_low_u[WALK_BITS-1:0]),
    .walk_high_u(walk_high_u[WALK_BITS-1:0]), .walk_low_v(walk_low_v[WALK_BITS-1:0]),
    .walk_high_v(walk_high_v[WALK_BITS-1:0]), .column_slope(dy), .row_slope(dz), .slope_dy(size_y[SLOPE_BITS-1:0]),
    .slope_dz(size_z[SLOPE_BITS-1:0]), .fold_back_x(back_x && one), .fold_back_y(back_y && one),
    .fold_back_z(back_z && one), .fold_mirror_back(mirror_back && one), .fold_turn_x(one ? turn_x : 0),
    .fold_turn_y(one ? turn_y : 0), .fold_turn_z(one ? turn_z : 0), .fold_u_x(one ? fold_u_x : 0),
    .fold_u_y(one ? fold_u_y : 0), .fold_u_z(one ? fold_u_z : 0), .fold_v_x(one ? fold_v_x : 0),
    .fold_v_y(one ? fold_v_y : 0), .fold_v_z(one ? fold_v_z : 0), .fold_border_x(one ? border_x : 0),
    .fold_border_y(one ? border_y : 0), .fold_border_z(one ? border_z : 0), .fold_active(one),
    .fold_axis(one ? fold_axis : 2'd0), .fold_distance(one ? fold_distance : 0), .hit_valid(hit),
    .hit_numerator(numerator), .hit_denominator(denominator)
);

// By the definition: t = n / e, and the whole part and the rest of the way on u and on v from the mirrored eye.
wire signed [WIDE-1:0] eye_a = of_three(axis, x_2, y_2, z_2), slope = of_three(axis, dx_2, dy_2, dz_2);
wire signed [WIDE-1:0] eye_u = of_three(on_u, x_2, y_2, z_2), slope_u = of_three(on_u, dx_2, dy_2, dz_2);
wire signed [WIDE-1:0] eye_v = of_three(on_v, x_2, y_2, z_2), slope_v = of_three(on_v, dx_2, dy_2, dz_2);
wire signed [WIDE-1:0] n = slope < 0 ? eye_a - k : k - eye_a;
wire [WIDE-1:0] e = magnitude(slope), length_u = magnitude(slope_u) * n, length_v = magnitude(slope_v) * n;
wire ahead = slope != 0 && n > 0;
wire signed [WIDE-1:0] whole_u = ahead ? length_u / e : 0, whole_v = ahead ? length_v / e : 0;
wire more_u = ahead && length_u % e != 0, more_v = ahead && length_v % e != 0;
wire signed [WIDE-1:0] base_u = slope_u < 0 ? eye_u - whole_u : eye_u + whole_u;
wire signed [WIDE-1:0] base_v = slope_v < 0 ? eye_v - whole_v : eye_v + whole_v;

// P is base + more, or base - more, with 0 <= more < 1.
function within(input signed [WIDE-1:0] base, input more, input negative, input signed [WIDE-1:0] low,
                input signed [WIDE-1:0] high);
    if (negative) within = (more ? base > low : base >= low) && base <= high;
    else within = base >= low && (more ? base < high : base <= high);
endfunction
function beyond(input signed [WIDE-1:0] base, input more, input negative, input signed [WIDE-1:0] place);
    beyond = negative ? base < place || base == place && more : base > place || base == place && more;
endfunction
wire clear = !one || (last_axis == axis ? beyond(k, 1'b0, slope < 0, last_plane)
    : last_axis == on_u ? beyond(base_u, more_u, slope_u < 0, last_plane) : beyond(base_v, more_v, slope_v < 0, last_plane));
wire defined = ahead && clear && within(base_u, more_u, slope_u < 0, low_u, high_u)
    && within(base_v, more_v, slope_v < 0, low_v, high_v);

// Six cycles through both blocks.
reg [2:0] age = 3'd0;
always @(posedge clk) if (age != 7) age <= age + 1;
always @* if (age == 7) begin
    assert (hit == defined);
    if (hit) assert (numerator == n && denominator == e);
end

// Hits with as many mirrors as there are.
always @* cover (age == 7 && hit && count == MIRRORS);
endmodule
