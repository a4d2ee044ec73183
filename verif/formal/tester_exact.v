// SPDX-License-Identifier: MIT
// The rectangle test compared with its definition, with a division: the point P = E + D (k - E[a]) / D[a] is ahead of
// the eye, within the bounds, and beyond the mirror on the side that the slope points to, or in its plane if no mirror
// on the rectangle's axis was met there.
//
// Assumed, as the engine guarantees: bounds in order, an axis of 0, 1 or 2, an eye no further away than REFLECTIONS
// mirrors can move it, and a mirror ahead of the eye. The ray and the rectangle may change in every cycle.
//
// [proof]
// claim = "a rectangle is hit if the quotient's point is within it and beyond the mirror, or in a corner with it"
// modules = ["rect_tester", "extent_tester"]
// induction = 4
// reach = 5
// label = "{COORDINATE_BITS} bits, {REFLECTIONS} mirrors"
// quick = ["alone=tester COORDINATE_BITS=1 REFLECTIONS=2", "alone=tester COORDINATE_BITS=2 REFLECTIONS=1"]
// designs = ["alone=tester COORDINATE_BITS=2 REFLECTIONS=2", "alone=tester COORDINATE_BITS=3,4 REFLECTIONS=1"]
// [faults]
// "2 bits, 1 mirrors" = ["rect_tester.seen_1_n edge", "extent_tester.clips and passed_1",
//   "extent_tester.way_to_far_2 edge"]
// "1 bits, 2 mirrors" = ["rect_tester.seen_2_met 0"]

module tester_exact #(
    parameter COORDINATE_BITS = 3, parameter SLOPE_BITS = 3, parameter EYE_BITS = 5, parameter REFLECTIONS = 1
) (
    input clk, input started, input [1:0] axis, input [COORDINATE_BITS-1:0] position, input [COORDINATE_BITS-1:0] u_low,
    input [COORDINATE_BITS-1:0] u_high, input [COORDINATE_BITS-1:0] v_low, input [COORDINATE_BITS-1:0] v_high,
    input signed [EYE_BITS-1:0] x, input signed [EYE_BITS-1:0] y, input signed [EYE_BITS-1:0] z,
    input [SLOPE_BITS-1:0] dx, input [SLOPE_BITS-1:0] dy, input [SLOPE_BITS-1:0] dz, input [2:0] backward,
    input mirrored, input [1:0] mirror_axis, input [COORDINATE_BITS-1:0] mirror, input [2:0] met
);
localparam LAST = (1 << COORDINATE_BITS) - 1, WIDE = EYE_BITS + SLOPE_BITS + 2;
localparam RECT_BITS = 2 + 24 + 5 * COORDINATE_BITS;

wire hit, at_mirror;
wire [EYE_BITS-2:0] numerator;
wire [SLOPE_BITS-1:0] denominator;

wire [RECT_BITS-1:0] rect = {axis, position, 24'd0, u_low, u_high, v_low, v_high};
wire [2:0] signs = {backward[0], backward[1], backward[2]};
// The mirror's distance is read one cycle after all other inputs.
wire [SLOPE_BITS-1:0] mirror_slope = mirror_axis == 0 ? dx : mirror_axis == 1 ? dy : dz;
wire mirror_back = mirror_axis == 0 ? backward[0] : mirror_axis == 1 ? backward[1] : backward[2];
wire signed [WIDE-1:0] mirror_eye = mirror_axis == 0 ? x : mirror_axis == 1 ? y : z;
wire signed [WIDE-1:0] mirror_place = {1'b0, mirror};
wire signed [WIDE-1:0] distance = mirror_back ? mirror_eye - mirror_place : mirror_place - mirror_eye;
reg [EYE_BITS-2:0] distance_1;
always @(posedge clk) distance_1 <= distance;
wire [EYE_BITS - 1 + 2 + (REFLECTIONS > 1 ? 3 : 0):0] mirror_word =
    {mirrored, mirror_axis, distance_1, met[0], met[1], met[2]} >> (REFLECTIONS > 1 ? 0 : 3);
rect_tester dut (
    .clk(clk), .steps_find_intersection(started), .rect_word(rect), .eye_x(x), .eye_y(y), .eye_z(z),
    .signs_word(signs), .slope_dx(dx), .slope_dy(dy), .slope_dz(dz),
    .mirror_word(mirror_word), .hit(hit),
    .at_mirror(at_mirror), .numerator(numerator), .denominator(denominator)
);

function in_reach(input signed [EYE_BITS-1:0] place);
    in_reach = place >= -LAST * REFLECTIONS && place <= LAST * (REFLECTIONS + 1);
endfunction
always @* begin
    assume (axis < 3 && mirror_axis < 3 && u_low <= u_high && v_low <= v_high);
    assume (in_reach(x) && in_reach(y) && in_reach(z));
    if (mirrored) assume (mirror_slope != 0 && distance > 0);
    if (mirrored) assume (REFLECTIONS > 1 ? met[mirror_axis] : met == 1 << mirror_axis);
end

// The axes from the rectangle's point of view; all numbers below are wide enough for any value.
wire signed [WIDE-1:0] eye_a = axis == 0 ? x : axis == 1 ? y : z;
wire signed [WIDE-1:0] eye_u = axis == 0 ? y : x;
wire signed [WIDE-1:0] eye_v = axis == 2 ? y : z;
wire [WIDE-1:0] e = axis == 0 ? dx : axis == 1 ? dy : dz;
wire [WIDE-1:0] slope_u = axis == 0 ? dy : dx;
wire [WIDE-1:0] slope_v = axis == 2 ? dy : dz;
wire back = axis == 0 ? backward[0] : axis == 1 ? backward[1] : backward[2];
wire back_u = axis == 0 ? backward[1] : backward[0];
wire back_v = axis == 2 ? backward[1] : backward[2];
wire on_a = mirrored && mirror_axis == axis;
wire on_u = mirrored && mirror_axis == (axis == 0 ? 1 : 0);
wire on_v = mirrored && mirror_axis == (axis == 2 ? 1 : 2);

// t = n / e, and the whole part and the rest of the way on u and on v.
wire signed [WIDE-1:0] plane = {1'b0, position};
wire signed [WIDE-1:0] n = back ? eye_a - plane : plane - eye_a;
wire ahead = e != 0 && n > 0;
wire [WIDE-1:0] way_u = slope_u * n, way_v = slope_v * n;
wire signed [WIDE-1:0] whole_u = ahead ? way_u / e : 0, whole_v = ahead ? way_v / e : 0;
wire more_u = ahead && way_u % e != 0, more_v = ahead && way_v % e != 0;

`include "quotient_point.v"
wire signed [WIDE-1:0] base_u = back_u ? eye_u - whole_u : eye_u + whole_u;
wire signed [WIDE-1:0] base_v = back_v ? eye_v - whole_v : eye_v + whole_v;
wire signed [WIDE-1:0] low_u = {1'b0, u_low}, high_u = {1'b0, u_high}, low_v = {1'b0, v_low}, high_v = {1'b0, v_high};
wire in_mirror = on_u && base_u == mirror_place && !more_u || on_v && base_v == mirror_place && !more_v;
wire allowed = in_mirror ? !met[axis] : (!on_u || beyond(base_u, more_u, back_u, mirror_place))
    && (!on_v || beyond(base_v, more_v, back_v, mirror_place));
wire defined = ahead && within(base_u, more_u, back_u, low_u, high_u) && within(base_v, more_v, back_v, low_v, high_v)
    && (!on_a || beyond(plane, 1'b0, back, mirror_place)) && allowed;

// The result comes three cycles later.
reg [2:0] valid = 3'b000, hits, in_mirrors;
reg [WIDE-1:0] n_1, n_2, n_3, e_1, e_2, e_3;
`include "tester_result.v"
endmodule
