// SPDX-License-Identifier: MIT
// The start of a group at full width: after start_line each rectangle is fetched once, in order. Four cycles after its
// fetch its load bit, and no other, marks its outputs: the distances from the camera, their products with the slope, and
// the growth per column.
//
// Assumed, as the culler guarantees: a start no sooner than the last fetch; an axis is 0, 1 or 2; a bound is at most one
// unit outside the world; a rectangle comes two cycles after its fetch, with the slope and the camera of that cycle.
// Reset may come at any time. A product replaces each multiplier made of adders: its operands are proved here, its
// digits are tested.
//
// [proof]
// claim = """each rectangle is loaded once, in order, with its distances and their products with the slope, at \
// full width"""
// modules = ["rect_setup"]
// any_product = true
// induction = 5
// reach = 10
// quick = ["exact culling=1"]
// designs = ["seed units=16 rectangles=4 allow_underrun"]
// [parameters]
// SLOPE_BITS = "SLOPE_BITS + 1"
// [faults]
// "exact-vga240-u4-r12-m1-c8-k1" = ["rect_setup.number_2 as number_1", "rect_setup.number edge in 24",
//   "rect_setup.slope_a_2 as slope_q_2", "rect_setup.distance negated", "rect_setup.to_high_p signed-short",
//   "rect_setup.to_low_q_2 as to_high_q_2", "rect_setup.slope_p_2 as slope_q_2"]

module array_multiplier (
    input signed [9:0] multiplicand, input signed [8:0] multiplier, output signed [17:0] product);
assign product = multiplicand * multiplier;
endmodule

module array_multiplier_1 (
    input signed [10:0] multiplicand, input signed [8:0] multiplier, output signed [17:0] product);
assign product = multiplicand * multiplier;
endmodule

module row_setup;
localparam DISTANCE_BITS = COORDINATE_BITS + 1, WIDE = COORDINATE_BITS + 3;
rect_setup dut (.*);
wire [1:0] axis = rects_rect_axis;

// The rectangles that are fetched now and were in the previous cycles; the state is known from the first reset on.
reg ready = 1'b0, busy;
reg [INDEX_BITS-1:0] number;
reg [4*INDEX_BITS-1:0] numbers;
reg [3:0] fetched, usables;
always @(posedge clk) begin
    ready <= ready || reset;
    busy <= !reset && (start_line || busy && number != RECTANGLES - 1);
    number <= start_line && !reset ? 0 : number + (busy && number != RECTANGLES - 1);
    fetched <= reset ? 0 : {fetched, busy};
    {numbers, usables} <= {numbers[3*INDEX_BITS-1:0], number, usables[2:0], rects_usable[number]};
end
always @* begin
    if (busy) assume (!start_line || number == RECTANGLES - 1);
    assume (ready || reset);
    if (ready) begin
        assert (rects_fetch == busy);
        if (busy) assert (rects_index == number && number < RECTANGLES);
        assert (load == (fetched[3] ? 1 << numbers[4*INDEX_BITS-1 -: INDEX_BITS] : 0));
    end
end

function near_world(input signed [WIDE-1:0] value);
    near_world = value >= -1 && value <= 1 << COORDINATE_BITS;
endfunction
wire signed [WIDE-1:0] low_u = $signed(rects_rect_u_low), high_u = $signed(rects_rect_u_high);
wire signed [WIDE-1:0] low_v = $signed(rects_rect_v_low), high_v = $signed(rects_rect_v_high);
always @* begin
    assume (axis < 3);
    assume (near_world(low_u) && near_world(high_u) && near_world(low_v) && near_world(high_v));
end

// The definition, in numbers wide enough for any distance. p is y unless the plane is on y, then x; q is z unless the
// plane is on z, then x.
wire on_y = axis == 1, on_z = axis == 2;
wire signed [WIDE-1:0] x = {1'b0, camera_x}, y = {1'b0, camera_y}, z = {1'b0, camera_z};
wire signed [WIDE-1:0] plane = {1'b0, rects_rect_position};
wire signed [WIDE-1:0] eye_p = on_y ? x : y, eye_q = on_z ? x : z, to_plane = plane - (axis == 0 ? x : on_y ? y : z);
wire signed [WIDE-1:0] to_low_p = (on_z ? low_v : low_u) - eye_p, to_high_p = (on_z ? high_v : high_u) - eye_p;
wire signed [WIDE-1:0] to_low_q = (on_z ? low_u : low_v) - eye_q, to_high_q = (on_z ? high_u : high_v) - eye_q;
function fits(input signed [WIDE-1:0] value, input [3:0] bits);
    fits = value > -(1 << bits - 1) && value < 1 << bits - 1;
endfunction
always @* begin
    assert (fits(to_plane, DISTANCE_BITS));
    assert (fits(to_low_p, WIDE_BITS) && fits(to_high_p, WIDE_BITS));
    assert (fits(to_low_q, WIDE_BITS) && fits(to_high_q, WIDE_BITS));
end

// The distances, in bits in which they fit, and their products with the slope, one and two cycles later.
reg signed [WIDE_BITS-1:0] n, low_p, high_p, low_q, high_q;
reg signed [SLOPE_BITS-1:0] slope_a, slope_p, slope_q;
wire signed [WALK_BITS-1:0] product_p = n * slope_p, product_q = n * slope_q;
wire signed [WALK_BITS-1:0] product_low_p = low_p * slope_a, product_high_p = high_p * slope_a;
wire signed [WALK_BITS-1:0] product_low_q = low_q * slope_a, product_high_q = high_q * slope_a;
reg signed [WALK_BITS-1:0] way_p, way_q;
reg [4*WALK_BITS-1:0] bounds;
reg [WIDE_BITS-1:0] distance;
reg [4*WIDE_BITS-1:0] to_bounds;
always @(posedge clk) begin
    n <= to_plane;
    low_p <= to_low_p;
    high_p <= to_high_p;
    low_q <= to_low_q;
    high_q <= to_high_q;
    slope_a <= axis == 0 ? slope_x : on_y ? slope_y : slope_z;
    slope_p <= on_y ? slope_x : slope_y;
    slope_q <= on_z ? slope_x : slope_z;
    {distance, to_bounds} <= {n, low_p, high_p, low_q, high_q};
    {way_p, way_q} <= {product_p, product_q};
    bounds <= {product_low_p, product_high_p, product_low_q, product_high_q};
end
always @* if (ready && load != 0) begin
    assert (facet_usable == usables[3] && facet_axis == $past(axis, 2));
    assert (facet_distance == distance[DISTANCE_BITS-1:0]);
end
always @* if (ready && load != 0) begin
    assert (start_word == {way_p, bounds} && facet_way_q == way_q);
    if ($past(axis, 2) == 1) assert (growth_word == to_bounds);
    else assert (growth_word == {distance, {4*WIDE_BITS{1'b0}}});
end

always @* cover (ready && load == 2 && facet_usable);
endmodule
