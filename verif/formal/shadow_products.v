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

module shadow_products;
localparam WAY_BITS = EYE_BITS - 1 + SLOPE_BITS > LIGHT_BITS + 1 ? EYE_BITS - 1 + SLOPE_BITS : LIGHT_BITS + 1;
localparam WIDE = EYE_BITS + SLOPE_BITS + 4;

shadow_ray dut (.*);
shadow_register kept (.*, .steps_reset_z_buf(1'b0), .in_question(1'b0));

wire [3:0] aim = steps_aim;
wire [COORDINATE_BITS-1:0] light_x = camera_light_x, light_y = camera_light_y, light_z = camera_light_z;
wire [COORDINATE_BITS-1:0] position = found_surface_position;
wire [1:0] axis = found_surface_axis;

localparam RAY_BITS = 3 * (COORDINATE_BITS + EYE_BITS + SLOPE_BITS + 1);
localparam TARGET_BITS = EYE_BITS + SLOPE_BITS + COORDINATE_BITS + 1;
wire [RAY_BITS-1:0] ray = {light_x, light_y, light_z, eye_x, eye_y, eye_z, signs_word, slope_dx, slope_dy, slope_dz};
wire [TARGET_BITS-1:0] target = {found_distance, found_slope, axis, position};
reg [3:0] last_aim = 4'b0000;
reg begun = 1'b0;
always @(posedge clk) {last_aim, begun} <= {aim, 1'b1};
always @* begin
    assume (aim[3:1] == last_aim[2:0] && (aim[3:1] == 0 || !aim[0]) && (begun || !aim[0]));
    assume (last_aim[2:0] != 0 || aim <= 1);
    assume (axis < 3 && found_slope != 0);
    if (aim != 0) assume ($stable(ray));
    if (aim[3:1] != 0) assume ($stable(target));
    if (hit) assume (numerator < 1 << COORDINATE_BITS);
end

// The definition of S; the products' operands are the design's own, which are what they should be.
wire signed [EYE_BITS+1:0] to_x = eye_x - $signed({1'b0, light_x}), to_y = eye_y - $signed({1'b0, light_y});
wire signed [EYE_BITS+1:0] to_z = eye_z - $signed({1'b0, light_z});
wire signed [SLOPE_BITS:0] divisor = {1'b0, found_slope};
wire signed [EYE_BITS+SLOPE_BITS+1:0] from_light = dut.difference_1 * divisor;
wire [WAY_BITS-1:0] way = found_distance * dut.slope_1;
wire signed [WIDE-1:0] way_part = {1'b0, way};
wire signed [WIDE-1:0] s = dut.back_1 ? from_light - way_part : from_light + way_part;
wire signed [WIDE-1:0] most = (divisor <<< COORDINATE_BITS) - divisor;
always @* begin
    if (aim[0]) assert (dut.difference_1 == to_x && dut.slope_1 == slope_dx && dut.back_1 == signs_dx);
    if (aim[1]) assert (dut.difference_1 == to_y && dut.slope_1 == slope_dy && dut.back_1 == signs_dy);
    if (aim[2]) assert (dut.difference_1 == to_z && dut.slope_1 == slope_dz && dut.back_1 == signs_dz);
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
    if (aim[1]) assert (dut.sum_2 == s_x[LIGHT_BITS:0] && far_x[WIDE-1:LIGHT_BITS] == 0);
    if (aim[2]) assert (dut.sum_2 == s_y[LIGHT_BITS:0] && far_y[WIDE-1:LIGHT_BITS] == 0);
    if (aim[3]) assert (dut.sum_2 == s_z[LIGHT_BITS:0] && far_z[WIDE-1:LIGHT_BITS] == 0);
    if (known_x) assert (shadow_slope_dx == far_x && shadow_signs_dx == (s_x < 0));
    if (known_y) assert (shadow_slope_dy == far_y && shadow_signs_dy == (s_y < 0));
    if (known_z) assert (shadow_slope_dz == far_z && shadow_signs_dz == (s_z < 0));
end

// The side of the plane, by the lemma lit-side.
wire [COORDINATE_BITS-1:0] light_a = axis == 0 ? light_x : axis == 1 ? light_y : light_z;
wire back_a = axis == 0 ? signs_dx : axis == 1 ? signs_dy : signs_dz;
reg expected_facing;
always @(posedge clk) expected_facing <= back_a ? position < light_a : light_a < position;
always @* if (begun) assert (facing == expected_facing);

// The shadow, by the lemma before-the-point.
wire [COORDINATE_BITS-1:0] distance = numerator[COORDINATE_BITS-1:0];
wire [COORDINATE_BITS+SLOPE_BITS-1:0] reached = distance * found_slope;
reg dark, looked = 1'b0;
always @(posedge clk) begin
    dark <= !aim[0] && (dark || steps_write_shadow && hit && reached < denominator);
    looked <= looked || aim[0];
end
always @* if (looked) assert (shaded == dark);

always @* cover (known_z && shaded && facing && shadow_signs_word == 5);
endmodule
