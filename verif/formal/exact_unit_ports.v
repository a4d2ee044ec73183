// SPDX-License-Identifier: MIT
// A unit of the exact engine and its control, for unit_wiring and shadow_wiring.
//
// The generator is cut: assumed is a slope that is constant from the cycle after its step, as slope-exact proves.
exact_control control (.*);
exact_unit unit (.*);
wire reset = reset_ray_caster, screen_to_ray = steps_screen_to_ray, find = steps_find_intersection,
    add = steps_add_colour, reset_nearest = steps_reset_z_buf, write = steps_write_z_buf, reflect = steps_store_ray;
wire [RECT_BITS-1:0] rect = rects_rect_word;
assign rect_word = rect;

wire [3*SLOPE_BITS-1:0] slope = {unit.slope_dx, unit.slope_dy, unit.slope_dz};
wire [3*SLOPE_BITS+2:0] generated = {unit.initial_signs_word, slope};
reg known = 1'b0, loaded = 1'b0, settled = 1'b0;
always @(posedge clk) begin
    known <= known || reset;
    loaded <= loaded || screen_to_ray;
    settled <= loaded && !screen_to_ray;
end

// The control's states: 1 generates a slope, 2 traces, 3 blends, 4 is done.
wire [2:0] state = control.ray_sequencer_i.state;
always @* begin
    assume (known || reset);
    if (settled) assume ($stable(generated));
    if (known && state > 1) assert (loaded);
end
