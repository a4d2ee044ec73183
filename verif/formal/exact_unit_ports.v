// SPDX-License-Identifier: MIT
// A unit of the exact engine and its control, connected to signals of the property that includes this file. With LIGHT,
// they have the ports of a light.
//
// The generator is cut: assumed is a slope that is constant from the cycle after its step, as slope-exact proves.
`ifdef LIGHT
`define LIGHT_STEPS .steps_aim(aim), .steps_write_shadow(write_shadow),
`define LIGHT_CONTROL .fate_any_in_question(in_question || other_in_question),
`define LIGHT_UNIT .fate_in_question(in_question),
`else
`define LIGHT_STEPS
`define LIGHT_CONTROL
`define LIGHT_UNIT
`endif
`define STEPS .clk(clk), .steps_screen_to_ray(screen_to_ray), .steps_find_intersection(find), \
    .steps_reset_z_buf(reset_nearest), .steps_write_z_buf(write), .steps_reset_colour(reset_colour), \
    .steps_add_colour(add), .steps_store_ray(reflect), `LIGHT_STEPS .offered_word(offered)
`define CONTROL `STEPS, `LIGHT_CONTROL .reset_ray_caster(reset), .enable(enable), .done(done), \
    .picture_reflections(reflections), .rects_usable(usable), .rects_index(index), .rects_fetch(fetch), \
    .rects_rect_word(rect), .steps_initial_ray(initial_ray), .fate_may_hit(may_hit)
`define UNIT `STEPS, `LIGHT_UNIT .column_base(1'b0), .place_row(row), .place_column_offset(offset), \
    .camera_word(camera), .rect_word(rect), .picture_background(background)
`define DIVISION .steps_load_divider(load), .steps_store_quotient(store)
wire [INDEX_BITS-1:0] index;
wire fetch, done, screen_to_ray, initial_ray, find, reset_nearest, write, reset_colour, add, reflect;
wire [SURFACE_BITS-1:0] offered;
generate
    if (PATTERNS) begin: design
        wire load, store, alive;
        exact_control control (`CONTROL, `DIVISION, .fate_any_alive(alive || other_alive));
        exact_unit unit (`UNIT, `DIVISION, .fate_alive(alive));
    end
    else begin: design
        exact_control control (`CONTROL, .fate_any_alive(other_alive));
        exact_unit unit (`UNIT);
    end
endgenerate

(* hierconn *) wire [2:0] \design.unit.initial_signs_word ;
(* hierconn *) wire [SLOPE_BITS-1:0] \design.unit.slope_dx , \design.unit.slope_dy , \design.unit.slope_dz ;
wire [3*SLOPE_BITS+2:0] generated = {\design.unit.initial_signs_word , \design.unit.slope_dx , \design.unit.slope_dy ,
                                     \design.unit.slope_dz };
wire [3*SLOPE_BITS-1:0] slope = generated[3*SLOPE_BITS-1:0];
reg known = 1'b0, loaded = 1'b0, settled = 1'b0;
reg [3*SLOPE_BITS+2:0] last_generated;
always @(posedge clk) begin
    known <= known || reset;
    loaded <= loaded || screen_to_ray;
    settled <= loaded && !screen_to_ray;
    last_generated <= generated;
end

// The control's states: 1 generates a slope, 2 traces, 3 blends, 4 is done.
(* hierconn *) wire [2:0] \design.control.ray_sequencer_i.state ;
wire [2:0] state = \design.control.ray_sequencer_i.state ;
always @* begin
    assume (known || reset);
    if (settled) assume (generated == last_generated);
    if (known && state > 1) assert (loaded);
end
