// SPDX-License-Identifier: MIT
// A unit of the exact engine with a light, and its control: the tester gets the unit's own ray, or in a shadow pass the
// shadow ray and no mirror. The shadow ray gets the nearest hit and the ray that found it, constant while it is
// computed, as shadow-products assumes. The shadow is decided by the tests of its own pass alone, which change no hit,
// and a pixel gets the colour of its hit in this light.
//
// Multiplication is any function, and verdicts are read at the tester's outputs. Assumed: a reset first, a slope that
// is constant from the cycle after its step, as slope-exact proves, and a camera that is constant from there to the
// end. All other inputs may change in every cycle.
//
// [proof]
// claim = "the test gets the ray or its shadow ray, which gets the nearest hit, and a pixel its colour in this light"
// modules = [
//   "exact_unit", "exact_control", "ray_sequencer", "rect_sequencer", "shadow_sequencer", "rect_tester", "nearest_hit",
//   "eye_register", "shadow_ray", "shadow_register", "ray_switch", "shade_colour", "quarters_of",
//   "turned_generator if TURN", "ray_generator if not TURN", "cell_finder if PATTERNS", "divider_step if PATTERNS",
//   "pattern_colour if PATTERNS",
// ]
// cut = ["turned_generator if TURN", "ray_generator if not TURN"]
// any_product = true
// induction = 4
// reach = 30
// quick = ["exact one-unit light"]
// designs = ["exact one-unit light turn materials patterns reflections=1,4", "exact one-unit light reflections=2"]
// [faults]
// "exact-vga240-u1-r12-m1-c8-light" = ["exact_control.steps_write_z_buf as in_flight[2] in 24",
//   "ray_switch.tested_mirror_word as mirror_word in 30", "exact_unit.shadow_ray_i.found_slope as denominator",
//   "exact_unit.camera_light_on 1", "shadow_sequencer.shadow_pass_awaited 0"]

module shadow_wiring;
localparam DISTANCE_BITS = EYE_BITS - 1, TRAVEL = PASS_LATENCY - 1;
`include "exact_unit_ports.v"
wire write_shadow = steps_write_shadow, in_question = fate_in_question;
wire [3:0] aim = steps_aim;
wire [CAMERA_BITS-1:0] camera = camera_word;
(* anyseq *) reg other_in_question;
assign fate_any_in_question = in_question || other_in_question;

reg last_known = 1'b0;
always @(posedge clk) last_known <= known;
always @* if (known) begin
    if (loaded && state > 1) assume ($stable(camera));
    assert (state <= 4);
end

// The order of the steps. A test is in flight for three cycles; a shadow pass that stops drops those in flight.
reg [3:0] last_aim = 4'b0000;
reg last_from_light = 1'b0;
reg [TRAVEL-1:0] starts;
wire from_light = control.from_light;
wire [1:0] shadow_state = control.shadow_sequencer_i.state;
wire [3:0] cycle = control.shadow_sequencer_i.cycle;
always @(posedge clk) begin
    last_aim <= reset ? 0 : aim;
    last_from_light <= from_light;
    starts <= control.ray_sequencer_i.stop ? 0 : {starts, find};
end
always @* if (known) begin
    assert (shadow_state <= 2 && control.in_flight == starts);
    if (shadow_state == 1) assert (cycle == 1 || cycle == 2 || cycle == 4 || cycle == 8);
    if (shadow_state != 0) assert (state == 2);
    if (shadow_state == 1) assert (starts[TRAVEL-2:0] == 0 && (cycle == 1 || starts == 0));
    if (shadow_state == 1) assert (!control.ray_sequencer_i.fetched);
    if (state != 2) assert (starts == 0);
    if (find) assert (state == 2 && aim == 0);
    // One cycle of aim follows the other.
    assert (aim[3:1] == last_aim[2:0] && (aim[3:1] == 0 || !aim[0]));
    // A verdict counts for the ray, or for the shadow of its own pass.
    assert (write == (starts[2] && !from_light) && write_shadow == (starts[2] && from_light));
    if (aim != 0) assert (!from_light && !write_shadow && !reset_nearest && !reflect && !screen_to_ray);
    if (aim[3:1] != 0) assert (!write);
    if (from_light) assert (!write && !reset_nearest && !reflect && !screen_to_ray);
    if (from_light && !last_from_light) assert (starts == 0);
    if (add) assert (!from_light && aim == 0);
end

// The ray that is tested.
wire [3*EYE_BITS-1:0] eye = {unit.eye_x, unit.eye_y, unit.eye_z};
wire [3*EYE_BITS-1:0] tested_eye = {unit.rect_tester_i.eye_x, unit.rect_tester_i.eye_y, unit.rect_tester_i.eye_z};
wire [3*LIGHT_BITS-1:0] tested_slope = {unit.rect_tester_i.slope_dx, unit.rect_tester_i.slope_dy,
                                        unit.rect_tester_i.slope_dz};
wire [LIGHT_BITS-1:0] dx = slope[3*SLOPE_BITS-1 -: SLOPE_BITS], dy = slope[2*SLOPE_BITS-1 -: SLOPE_BITS];
wire [LIGHT_BITS-1:0] dz = slope[SLOPE_BITS-1:0];
wire [EYE_BITS-1:0] from_x = camera_light_x, from_y = camera_light_y, from_z = camera_light_z;
wire looking = unit.looking;
reg asked;
always @(posedge clk) if (aim[3]) asked <= in_question;
always @* if (known && state == 2) assert (looking == (from_light && asked));
always @* if (known) begin
    if (looking) begin
        assert (tested_eye == {from_x, from_y, from_z} && !unit.rect_tester_i.mirror_word[MIRROR_BITS-1]);
        assert (unit.rect_tester_i.signs_word == unit.shadow_signs_word);
        assert (tested_slope == {unit.shadow_slope_dx, unit.shadow_slope_dy, unit.shadow_slope_dz});
    end
    else begin
        assert (tested_eye == eye && unit.rect_tester_i.mirror_word == unit.mirror_word);
        assert (unit.rect_tester_i.signs_word == unit.signs_word && tested_slope == {dx, dy, dz});
    end
end

// The shadow ray's inputs, and how long they are constant.
wire [3*EYE_BITS+3*SLOPE_BITS+CAMERA_BITS+2:0] ray = {
    unit.shadow_ray_i.eye_x, unit.shadow_ray_i.eye_y, unit.shadow_ray_i.eye_z,
    unit.shadow_ray_i.signs_word, unit.shadow_ray_i.slope_dx, unit.shadow_ray_i.slope_dy,
    unit.shadow_ray_i.slope_dz, unit.shadow_ray_i.camera_word};
wire [DISTANCE_BITS+SLOPE_BITS+SURFACE_BITS-1:0] target = {
    unit.shadow_ray_i.found_distance, unit.shadow_ray_i.found_slope, unit.shadow_ray_i.found_surface_word};
always @* if (known) begin
    assert (ray == {eye, unit.signs_word, slope, camera});
    assert (target == {unit.nearest_hit_i.found_distance, unit.nearest_hit_i.found_slope,
                       unit.nearest_hit_i.found_surface_word});
    if (aim != 0) assert ($stable(ray));
    if (last_known && (aim[3:1] != 0 || from_light || last_from_light))
        assert ($stable(target) && $stable(unit.nearest_hit_i.found));
end

// The shadow: any of its pass's verdicts that comes before the point.
wire [COORDINATE_BITS-1:0] distance = unit.rect_tester_i.numerator[COORDINATE_BITS-1:0];
wire [COORDINATE_BITS+SLOPE_BITS-1:0] reached = distance * unit.nearest_hit_i.found_slope;
reg dark = 1'b0, aimed = 1'b0;
always @(posedge clk) begin
    aimed <= aimed || aim[0];
    dark <= !aim[0] && (dark || starts[2] && from_light && unit.rect_tester_i.hit
                        && reached < unit.rect_tester_i.denominator);
end
always @* if (known && aimed) assert (unit.shadow_register_i.shaded == dark);

// A pixel's light.
wire light_on = camera[0], lit = unit.shadow_ray_i.facing && !dark;
wire [23:0] own = unit.lit_colour_word;
function [7:0] dim(input [7:0] channel);
    reg [9:0] sum;
    begin
        sum = (camera[1] ? channel : 0) + (camera[2] ? 2 * channel : 0);
        dim = sum[9:2];
    end
endfunction
wire [23:0] dimmed = {dim(own[23:16]), dim(own[15:8]), dim(own[7:0])};
always @* if (known && aimed) begin
    assert (unit.colour_combiner_i.found_colour == (light_on && !lit ? dimmed : own));
    assert (in_question == (light_on && lit && unit.nearest_hit_i.found && !unit.missed));
    if (!PATTERNS) assert (own == unit.nearest_hit_i.found_surface_word[23:0]);
end

always @* cover (known && add && dark && aimed);
always @* cover (known && add && last_from_light && !dark);
endmodule
