// SPDX-License-Identifier: MIT
// The rectangle test compared with its definition, with a division: the point P = E + D (k - E[a]) / D[a] is ahead of
// the eye, within the bounds, and beyond the mirror on the side that the slope points to, or in its plane if no mirror
// on the rectangle's axis was met there.
//
// Assumed besides tester_ray.v, as the engine guarantees: bounds in order, and a mirror ahead of the eye.
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

module tester_exact;
localparam WIDE = EYE_BITS + SLOPE_BITS + 2;
`include "tester_ray.v"

(* anyseq *) reg [COORDINATE_BITS-1:0] mirror;
wire [SLOPE_BITS-1:0] mirror_slope = mirror_axis == 0 ? slope_dx : mirror_axis == 1 ? slope_dy : slope_dz;
wire mirror_back = mirror_axis == 0 ? signs_dx : mirror_axis == 1 ? signs_dy : signs_dz;
wire signed [WIDE-1:0] mirror_eye = mirror_axis == 0 ? eye_x : mirror_axis == 1 ? eye_y : eye_z;
wire signed [WIDE-1:0] mirror_place = {1'b0, mirror};
wire signed [WIDE-1:0] distance = mirror_back ? mirror_eye - mirror_place : mirror_place - mirror_eye;
always @* begin
    assume (rect_u_low <= rect_u_high && rect_v_low <= rect_v_high);
    if (mirrored) assume (mirror_slope != 0 && distance > 0 && met[mirror_axis]);
end

// t = n / e, and the whole part and the rest of the way on u and on v.
wire [WIDE-1:0] way_u = slope_u * n, way_v = slope_v * n;
wire signed [WIDE-1:0] whole_u = ahead ? way_u / e : 0, whole_v = ahead ? way_v / e : 0;
wire more_u = ahead && way_u % e != 0, more_v = ahead && way_v % e != 0;

// P is base + more, or base - more, with 0 <= more < 1.
function within(input signed [WIDE-1:0] base, input more, input negative, input signed [WIDE-1:0] low,
                input signed [WIDE-1:0] high);
    if (negative) within = (more ? base > low : base >= low) && base <= high;
    else within = base >= low && (more ? base < high : base <= high);
endfunction
function beyond(input signed [WIDE-1:0] base, input more, input negative, input signed [WIDE-1:0] place);
    beyond = negative ? base < place || base == place && more : base > place || base == place && more;
endfunction
wire signed [WIDE-1:0] base_u = back_u ? eye_u - whole_u : eye_u + whole_u;
wire signed [WIDE-1:0] base_v = back_v ? eye_v - whole_v : eye_v + whole_v;
wire in_mirror = on_u && base_u == mirror_place && !more_u || on_v && base_v == mirror_place && !more_v;
wire allowed = in_mirror ? !met[axis] : (!on_u || beyond(base_u, more_u, back_u, mirror_place))
    && (!on_v || beyond(base_v, more_v, back_v, mirror_place));
wire defined = ahead && within(base_u, more_u, back_u, low_u, high_u) && within(base_v, more_v, back_v, low_v, high_v)
    && (!on_a || beyond(plane, 1'b0, back, mirror_place)) && allowed;
endmodule
