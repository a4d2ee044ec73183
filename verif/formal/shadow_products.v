// SPDX-License-Identifier: MIT
// The shadow ray and the shadow at the engine's own widths, with any function as multiplication. The slope is
// S = (E - L) e + D n on each axis, whatever products are; facing says on which side of the plane the light is; and a
// point is shaded from the cycle after a hit with n e < d until the next shadow ray.
//
// Assumptions: the cycles of aim follow each other, the ray and the light are constant in them and in the cycle before,
// and the hit is constant in them, as shadow-wiring proves; S is within the world's size times e, by the lemma
// shadow-slope-in-range; and a rectangle that is hit is no further from the light than the world is wide.
//
// [proof]
// claim = """the ray from the light leads to the hit point, whose shadow is decided as the definition says, at \
// full width"""
// modules = ["shadow_ray", "hit_component", "shadow_register"]
// any_product = true
// induction = 2
// reach = 10
// quick = ["exact one-unit light reflections=0", "exact one-unit light turn materials patterns reflections=4"]
// designs = [
//   "exact one-unit light reflections=0,1,2,3,4",
//   "exact one-unit light turn materials patterns reflections=0,1,2,3,4",
// ]
// [faults]
// "exact-vga240-u1-r12-m0-c8-light" = ["shadow_ray.difference signed-short",
//   "shadow_ray.camera_light_z as camera_light_y", "shadow_ray.back_2 0", "shadow_ray.negated as inverse",
//   "shadow_ray.found_surface_position edge", "shadow_register.reached edge", "shadow_register.shaded and hit",
//   "shadow_register.reached short"]

module shadow_products #(
    parameter COORDINATE_BITS = 9, parameter LOOK_BITS = 24, parameter SLOPE_BITS = 8, parameter EYE_BITS = 11,
    parameter LIGHT_BITS = 17, parameter CAMERA_BITS = 57
) (
    input clk, input [3:0] aim, input write_shadow, input [1:0] axis, input [COORDINATE_BITS-1:0] position,
    input [LOOK_BITS-1:0] look, input [CAMERA_BITS-3*COORDINATE_BITS-4:0] camera, input [2:0] shade,
    input [COORDINATE_BITS-1:0] light_x, input [COORDINATE_BITS-1:0] light_y, input [COORDINATE_BITS-1:0] light_z,
    input signed [EYE_BITS-1:0] x, input signed [EYE_BITS-1:0] y, input signed [EYE_BITS-1:0] z, input [2:0] signs,
    input [SLOPE_BITS-1:0] dx, input [SLOPE_BITS-1:0] dy, input [SLOPE_BITS-1:0] dz, input [EYE_BITS-2:0] n,
    input [SLOPE_BITS-1:0] e, input hit, input [EYE_BITS-2:0] numerator, input [LIGHT_BITS-1:0] denominator
);
localparam WAY_BITS = EYE_BITS - 1 + SLOPE_BITS > LIGHT_BITS + 1 ? EYE_BITS - 1 + SLOPE_BITS : LIGHT_BITS + 1;
localparam WIDE = EYE_BITS + SLOPE_BITS + 4;

wire [2:0] shadow_signs;
wire [LIGHT_BITS-1:0] shadow_dx, shadow_dy, shadow_dz;
wire facing, shaded;
shadow_ray dut (
    .clk(clk), .steps_aim(aim), .camera_word({camera, light_x, light_y, light_z, shade}), .eye_x(x), .eye_y(y),
    .eye_z(z), .signs_word(signs), .slope_dx(dx), .slope_dy(dy), .slope_dz(dz),
    .found_surface_word({axis, position, look}), .found_distance(n), .found_slope(e), .shadow_signs_word(shadow_signs),
    .shadow_slope_dx(shadow_dx), .shadow_slope_dy(shadow_dy), .shadow_slope_dz(shadow_dz), .facing(facing)
);
shadow_register kept (
    .clk(clk), .steps_aim(aim), .steps_reset_z_buf(1'b0), .steps_write_shadow(write_shadow), .in_question(1'b0),
    .hit(hit), .numerator(numerator), .denominator(denominator), .found_slope(e), .shaded(shaded)
);
(* hierconn *) wire signed [EYE_BITS:0] \dut.difference_1 ;
(* hierconn *) wire [SLOPE_BITS-1:0] \dut.slope_1 ;
(* hierconn *) wire \dut.back_1 ;
(* hierconn *) wire [LIGHT_BITS:0] \dut.sum_2 ;

wire [3*COORDINATE_BITS+3*EYE_BITS+3*SLOPE_BITS+2:0] ray = {light_x, light_y, light_z, x, y, z, signs, dx, dy, dz};
wire [EYE_BITS+SLOPE_BITS+COORDINATE_BITS:0] target = {n, e, axis, position};
reg [3*COORDINATE_BITS+3*EYE_BITS+3*SLOPE_BITS+2:0] last_ray;
reg [EYE_BITS+SLOPE_BITS+COORDINATE_BITS:0] last_target;
reg [3:0] last_aim = 4'b0000;
reg begun = 1'b0;
always @(posedge clk) begin
    last_ray <= ray;
    last_target <= target;
    last_aim <= aim;
    begun <= 1'b1;
end
always @* begin
    assume (aim[3:1] == last_aim[2:0] && (aim[3:1] == 0 || !aim[0]) && (begun || !aim[0]));
    assume (last_aim[2:0] != 0 || aim <= 1);
    assume (axis < 3 && e != 0);
    if (aim != 0) assume (ray == last_ray);
    if (aim[3:1] != 0) assume (target == last_target);
    if (hit) assume (numerator < 1 << COORDINATE_BITS);
end

// The definition of S; the products' operands are the design's own, which are what they should be.
wire signed [EYE_BITS+1:0] to_x = x - $signed({1'b0, light_x}), to_y = y - $signed({1'b0, light_y});
wire signed [EYE_BITS+1:0] to_z = z - $signed({1'b0, light_z});
wire signed [SLOPE_BITS:0] divisor = {1'b0, e};
wire signed [EYE_BITS+SLOPE_BITS+1:0] from_light = \dut.difference_1 * divisor;
wire [WAY_BITS-1:0] way = n * \dut.slope_1 ;
wire signed [WIDE-1:0] way_part = {1'b0, way};
wire signed [WIDE-1:0] s = \dut.back_1 ? from_light - way_part : from_light + way_part;
wire signed [WIDE-1:0] most = (divisor <<< COORDINATE_BITS) - divisor;
always @* begin
    if (aim[0]) assert (\dut.difference_1 == to_x && \dut.slope_1 == dx && \dut.back_1 == signs[2]);
    if (aim[1]) assert (\dut.difference_1 == to_y && \dut.slope_1 == dy && \dut.back_1 == signs[1]);
    if (aim[2]) assert (\dut.difference_1 == to_z && \dut.slope_1 == dz && \dut.back_1 == signs[0]);
    if (aim[2:0] != 0) assume (s >= -most && s <= most);
end

reg signed [WIDE-1:0] s_x, s_y, s_z;
reg known_x = 1'b0, known_y = 1'b0, known_z = 1'b0;
always @(posedge clk) begin
    if (aim[0]) s_x <= s;
    if (aim[1]) s_y <= s;
    if (aim[2]) s_z <= s;
    known_x <= aim[1] || known_x && !aim[0];
    known_y <= aim[2] || known_y && !aim[1];
    known_z <= aim[3] || known_z && !aim[2];
end
wire [WIDE-1:0] far_x = s_x < 0 ? -s_x : s_x, far_y = s_y < 0 ? -s_y : s_y, far_z = s_z < 0 ? -s_z : s_z;
always @* begin
    if (aim[1]) assert (\dut.sum_2 == s_x[LIGHT_BITS:0] && far_x[WIDE-1:LIGHT_BITS] == 0);
    if (aim[2]) assert (\dut.sum_2 == s_y[LIGHT_BITS:0] && far_y[WIDE-1:LIGHT_BITS] == 0);
    if (aim[3]) assert (\dut.sum_2 == s_z[LIGHT_BITS:0] && far_z[WIDE-1:LIGHT_BITS] == 0);
    if (known_x) assert (shadow_dx == far_x && shadow_signs[2] == (s_x < 0));
    if (known_y) assert (shadow_dy == far_y && shadow_signs[1] == (s_y < 0));
    if (known_z) assert (shadow_dz == far_z && shadow_signs[0] == (s_z < 0));
end

// The side of the plane, by the lemma lit-side.
wire [COORDINATE_BITS-1:0] light_a = axis == 0 ? light_x : axis == 1 ? light_y : light_z;
wire back_a = axis == 0 ? signs[2] : axis == 1 ? signs[1] : signs[0];
reg expected_facing;
always @(posedge clk) expected_facing <= back_a ? position < light_a : light_a < position;
always @* if (begun) assert (facing == expected_facing);

// The shadow, by the lemma before-the-point.
wire [COORDINATE_BITS-1:0] distance = numerator[COORDINATE_BITS-1:0];
wire [COORDINATE_BITS+SLOPE_BITS-1:0] reached = distance * e;
reg dark, looked = 1'b0;
always @(posedge clk) begin
    dark <= !aim[0] && (dark || write_shadow && hit && reached < denominator);
    looked <= looked || aim[0];
end
always @* if (looked) assert (shaded == dark);

always @* cover (known_z && shaded && facing && shadow_signs == 5);
endmodule
