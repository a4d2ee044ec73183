// SPDX-License-Identifier: MIT
// A unit of the exact engine and its control: each block gets the inputs that its own proof assumes. A test gets the
// current rectangle, the mirrored eye, the slope and the last mirror. Its verdict is offered with the surface of the
// same rectangle. The nearest hit reaches the eye, the colours, and the cells, which need it constant while they
// divide.
//
// Multiplication is any function. Verdicts are read at the tester's outputs; tester-products, nearest-products and
// slope-exact prove that outputs of blocks are right. Assumed: a reset first, an axis of 0, 1 or 2, and a slope that is
// constant from the cycle after its step, as slope-exact proves for a constant pixel. All other inputs may change in
// every cycle.
//
// [proof]
// claim = "each block of a unit gets the inputs that its own proof assumes, and the nearest hit, at full width"
// modules = [
//   "exact_unit", "exact_control", "ray_sequencer", "rect_sequencer", "rect_tester", "nearest_hit", "eye_register",
//   "colour_combiner", "colour_share", "colour_sum", "turned_generator if TURN", "ray_generator if not TURN",
//   "cell_finder if PATTERNS", "divider_step if PATTERNS", "pattern_colour if PATTERNS",
// ]
// cut = ["turned_generator if TURN", "ray_generator if not TURN"]
// any_product = true
// induction = "PASS_LATENCY"
// reach = "2 * PASS_LATENCY + 9"
// quick = ["exact one-unit"]
// designs = ["exact one-unit reflections=2", "exact one-unit turn materials patterns reflections=1,4"]
// [faults]
// "exact-vga240-u1-r12-m1-c8" = ["exact_unit.rect_tester_i.eye_x as eye_y",
//   "exact_unit.rect_tester_i.signs_word as initial_signs_word",
//   "exact_unit.eye_register_i.found_surface_word as offered_word",
//   "exact_unit.eye_register_i.found_distance as numerator",
//   "exact_unit.colour_combiner_i.found_colour as offered_word", "exact_control.second_word as first_word"]
// "exact-vga240-u1-r12-m2-c8" = ["exact_unit.eye_register_i.found_at_mirror as at_mirror"]
// "exact-vga240-u1-r12-m1-c8-turn-materials-patterns" = ["exact_control.steps_store_quotient late in 18",
//   "exact_unit.cell_finder_i.found_slope as denominator in 18"]

module unit_wiring;
localparam DISTANCE_BITS = EYE_BITS - 1, WAY_BITS = DISTANCE_BITS + SLOPE_BITS, WIDE = EYE_BITS + 3;
localparam CORNERS = REFLECTIONS > 1, TRAVEL = PATTERNS ? 9 : 3;

assign fate_may_hit = {RECTANGLES{1'b1}};
`include "exact_unit_ports.v"
always @* assume (rects_rect_axis < 3);

reg found_known = 1'b0;
always @(posedge clk) found_known <= found_known || reset_nearest;
always @* begin
    if (loaded) assert (found_known);
    if (find) assert (state == 2);
    if (screen_to_ray) assert (state == 1);
    if (add) assert (state == 3);
end

// Tests in flight, the latest first, and the surfaces of their rectangles.
reg [TRAVEL-1:0] starts;
reg [3*SURFACE_BITS-1:0] tested;
always @(posedge clk) begin
    starts <= reset ? 0 : {starts, find};
    tested <= {tested, rect[RECT_BITS-1 -: SURFACE_BITS]};
end
always @* if (known) begin
    assert (write == starts[2]);
    if (write) assert (offered_word == tested[3*SURFACE_BITS-1 -: SURFACE_BITS]);
    if (state != 2) assert (starts == 0);
    assert (reset_nearest == (screen_to_ray || add) && (add || !reflect));
end

// The nearest of the hits at the tester's outputs.
wire in_mirror;
wire [DISTANCE_BITS-1:0] n = unit.rect_tester_i.numerator;
wire [SLOPE_BITS-1:0] e = unit.rect_tester_i.denominator;
reg found, corner;
reg [DISTANCE_BITS-1:0] distance;
reg [SLOPE_BITS-1:0] divisor;
reg [SURFACE_BITS-1:0] surface;
wire [WAY_BITS-1:0] way = n * divisor, nearest_way = distance * e;
always @(posedge clk) begin
    if (reset_nearest) found <= 1'b0;
    else if (write && unit.rect_tester_i.hit && (!found || way < nearest_way)) begin
        {found, corner, distance, divisor} <= {1'b1, in_mirror, n, e};
        surface <= tested[3*SURFACE_BITS-1 -: SURFACE_BITS];
    end
end
wire [1:0] axis = surface[SURFACE_BITS-1 -: 2];

// The eye, its signs and the last mirror, as eye-exact defines them; don't care after a ray that hit nothing.
reg signed [EYE_BITS-1:0] x, y, z;
reg [2:0] turned;
reg [MIRROR_BITS-1:0] mirror;
reg counts = 1'b0;
wire [2:0] signs = generated[3*SLOPE_BITS +: 3] ^ turned, on_axis = 3'b100 >> axis;
wire signed [WIDE-1:0] plane = {1'b0, surface[SURFACE_BITS-3 -: COORDINATE_BITS]};
generate
    if (CORNERS) begin: corners
        assign in_mirror = unit.rect_tester_i.at_mirror;
        wire [2:0] met = corner ? mirror[2:0] | on_axis : on_axis;
        wire [MIRROR_BITS-1:0] next_mirror = {1'b1, axis, distance, met};
    end
    else begin: corners
        assign in_mirror = 0;
        wire [MIRROR_BITS-1:0] next_mirror = {1'b1, axis, distance};
    end
endgenerate
always @(posedge clk) begin
    if (screen_to_ray) begin
        x <= {1'b0, camera_x};
        y <= {1'b0, camera_y};
        z <= {1'b0, camera_z};
        {turned, mirror, counts} <= 1;
    end
    else if (reflect) begin
        if (axis == 0) x <= 2 * plane - x;
        if (axis == 1) y <= 2 * plane - y;
        if (axis == 2) z <= 2 * plane - z;
        turned <= turned ^ on_axis;
        mirror <= corners.next_mirror;
        counts <= counts && found;
    end
end

// Inputs of blocks.
always @* if (found_known) begin
    assert (unit.nearest_hit_i.found == found && unit.colour_combiner_i.found == found);
    if (found) begin
        assert (unit.eye_register_i.found_distance == distance);
        assert (unit.eye_register_i.found_surface_word == surface);
        assert (unit.nearest_hit_i.found_slope == divisor && axis < 3);
    end
end
always @* if (known && counts && state > 1) begin
    assert (unit.rect_tester_i.eye_x == x && unit.rect_tester_i.eye_y == y);
    assert (unit.rect_tester_i.eye_z == z && unit.rect_tester_i.signs_word == signs);
    assert (unit.rect_tester_i.mirror_word == mirror);
    assert ({unit.rect_tester_i.slope_dx, unit.rect_tester_i.slope_dy, unit.rect_tester_i.slope_dz} == slope);
    if (find) assert (unit.rect_tester_i.rect_word == rect);
end
generate
    if (CORNERS) begin: corner_known
        always @* if (found_known && found) assert (unit.eye_register_i.found_at_mirror == corner);
    end
    if (PATTERNS) begin: cells
        // cell-products assumes three cycles for each of P[u] and P[v], in which the hit is constant.
        wire [DISTANCE_BITS+SLOPE_BITS+SURFACE_BITS-1:0] hit = {distance, divisor, surface};
        reg [DISTANCE_BITS+SLOPE_BITS+SURFACE_BITS-1:0] last_hit;
        reg [5:0] loads, stores;
        always @(posedge clk) begin
            last_hit <= hit;
            loads <= reset ? 0 : {loads, steps_load_divider};
            stores <= reset ? 0 : {stores, steps_store_quotient};
        end
        wire [23:0] painted;
        pattern_colour painter (.odd_u(unit.cell_finder_i.odd_u), .odd_v(unit.cell_finder_i.odd_v), .colour(painted),
            .look_word(surface));
        always @* if (known && counts && state > 1) begin
            assert (unit.cell_finder_i.eye_x == x && unit.cell_finder_i.eye_y == y);
            assert (unit.cell_finder_i.eye_z == z && unit.cell_finder_i.signs_word == signs);
            assert ({unit.cell_finder_i.slope_dx, unit.cell_finder_i.slope_dy, unit.cell_finder_i.slope_dz} == slope);
            if (found) assert ({unit.cell_finder_i.found_distance, unit.cell_finder_i.found_slope,
                                unit.cell_finder_i.found_surface_word} == hit);
            if (steps_store_quotient) assert (loads[2:0] == 3'b100 && stores[2:0] == 0);
            if (steps_load_divider) assert (!steps_store_quotient);
            if ((loads[2:0] || stores[2:0]) && !steps_load_divider) assert (hit == last_hit);
            if (add && found) assert (stores[2:0] == 3'b100 && loads[2:0] == 0);
            if (add && found) assert (unit.colour_combiner_i.found_colour == painted);
            if (add && found) assert (unit.colour_combiner_i.found_mirror == surface[LOOK_BITS-25 -: 3]);
        end
    end
    else begin: cells
        always @* if (found_known && add && found)
            assert (unit.colour_combiner_i.found_colour == surface[23:0]);
    end
endgenerate

always @* cover (known && add && counts && mirror != 0 && found);
endmodule
