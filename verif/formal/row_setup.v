// SPDX-License-Identifier: MIT
// The start of a row at full width, with any function instead of multiplication: after start_line each rectangle is
// fetched once, in order. Four cycles after its fetch its load bit, and no other, marks its outputs: the distances from
// the camera, their products with the slope, and the growth per column of a camera that does not turn.
//
// Assumed, as the renderer guarantees: a start no sooner than the last fetch; an axis is 0, 1 or 2; a rectangle comes
// two cycles after its fetch, with the slope and the camera of that cycle. Reset may come at any time.
//
// For the culler (ADDERS) a bound may be one unit outside the world, and a product replaces each multiplier made of
// adders: its operands are proved here, its digits are tested.
//
// [proof]
// claim = """each rectangle is loaded once, in order, with its distances and their products with the slope, at \
// full width"""
// modules = ["rect_setup"]
// any_product = true
// induction = 5
// reach = 10
// quick = ["beam", "exact culling=1"]
// designs = ["beam two pairs turn"]
// [parameters]  # the culler has multipliers made of adders, wider bounds, and no looks
// ADDERS = "CULLING"
// BOUND_BITS = "WIDE_BITS if CULLING else COORDINATE_BITS"
// TO_BOUND_BITS = "WIDE_BITS if CULLING else DISTANCE_BITS"
// BASIS_BITS = "CAMERA_BITS - 3 * COORDINATE_BITS"
// SLOPE_BITS = "SLOPE_BITS + 1"
// [faults]
// "beam-vga240-s2-u1-r12-m1-c8" = ["rect_setup.number_2 as number_1", "rect_setup.number edge in 24",
//   "rect_setup.slope_a_2 as slope_q_2", "rect_setup.distance negated", "rect_setup.to_high_p signed-short"]
// "exact-vga240-u4-r12-m1-c8-k1" = ["rect_setup.to_low_q_2 as to_high_q_2", "rect_setup.slope_p_2 as slope_q_2"]

module array_multiplier (
    input signed [9:0] multiplicand, input signed [8:0] multiplier, output signed [17:0] product
);
assign product = multiplicand * multiplier;
endmodule

module array_multiplier_1 (
    input signed [10:0] multiplicand, input signed [8:0] multiplier, output signed [17:0] product
);
assign product = multiplicand * multiplier;
endmodule

module row_setup #(
    parameter TURN = 0, parameter ADDERS = 0, parameter RECTANGLES = 12, parameter INDEX_BITS = 4,
    parameter COORDINATE_BITS = 9, parameter BOUND_BITS = 9, parameter TO_BOUND_BITS = 10, parameter LOOK_BITS = 24,
    parameter BASIS_BITS = 0, parameter SLOPE_BITS = 10, parameter WALK_BITS = 19
) (
    input clk, input reset, input start_line, input [RECTANGLES-1:0] usable, input [1:0] axis,
    input [COORDINATE_BITS-1:0] position, input [LOOK_BITS-1:0] look, input [BOUND_BITS-1:0] u_low,
    input [BOUND_BITS-1:0] u_high, input [BOUND_BITS-1:0] v_low, input [BOUND_BITS-1:0] v_high,
    input [COORDINATE_BITS-1:0] x, input [COORDINATE_BITS-1:0] y, input [COORDINATE_BITS-1:0] z,
    input [BASIS_BITS:0] basis, input signed [SLOPE_BITS-1:0] dx, input signed [SLOPE_BITS-1:0] dy,
    input signed [SLOPE_BITS-1:0] dz
);
localparam DISTANCE_BITS = COORDINATE_BITS + 1, WIDE = COORDINATE_BITS + 3;

wire [RECTANGLES-1:0] load;
wire [INDEX_BITS-1:0] index;
wire fetch, facet_usable;
wire [1:0] facet_axis;
wire signed [DISTANCE_BITS-1:0] distance;
wire [LOOK_BITS-1:0] facet_look;
wire [3 + DISTANCE_BITS + WALK_BITS + (ADDERS ? 0 : LOOK_BITS)-1:0] facet;
wire signed [WALK_BITS-1:0] way_p, way_q, low_p, high_p, low_q, high_q;
wire signed [TO_BOUND_BITS-1:0] more_way, more_low_p, more_high_p, more_low_q, more_high_q;
wire [4 * BOUND_BITS - 1:0] bounds = {u_low, u_high, v_low, v_high};
wire [2 + COORDINATE_BITS + LOOK_BITS + 4 * BOUND_BITS - 1:0] rect = {axis, position, look, bounds};
wire [3 * COORDINATE_BITS + BASIS_BITS:0] camera = {x, y, z, basis};
generate
    if (TURN) begin: design
        rect_setup dut (
            .clk(clk), .reset(reset), .start_line(start_line), .load(load), .rects_usable(usable), .rects_index(index),
            .rects_fetch(fetch), .rects_rect_word(rect), .camera_word(camera[3 * COORDINATE_BITS + BASIS_BITS:1]),
            .slope_x(dx), .slope_y(dy), .slope_z(dz),
            .facet_word({facet_usable, facet_axis, distance, facet_look}),
            .start_word({way_p, way_q, low_p, high_p, low_q, high_q})
        );
    end
    else begin: design
        if (ADDERS) begin: bare
            assign {facet_usable, facet_axis, distance, way_q} = facet;
        end
        else begin: bare
            assign {facet_usable, facet_axis, distance, way_q, facet_look} = facet;
        end
        rect_setup dut (
            .clk(clk), .reset(reset), .start_line(start_line), .load(load), .rects_usable(usable), .rects_index(index),
            .rects_fetch(fetch), .rects_rect_word(ADDERS ? {axis, position, bounds} : rect),
            .camera_word(camera[3 * COORDINATE_BITS + BASIS_BITS:1]), .slope_x(dx), .slope_y(dy), .slope_z(dz),
            .facet_word(facet), .start_word({way_p, low_p, high_p, low_q, high_q}),
            .growth_word({more_way, more_low_p, more_high_p, more_low_q, more_high_q})
        );
    end
endgenerate
always @* assume (axis < 3);

// A bound, and the assumption about bounds in the culler: at most one unit outside the world.
function signed [WIDE-1:0] place(input [BOUND_BITS-1:0] bound);
    place = ADDERS ? $signed(bound) : $signed({1'b0, bound});
endfunction
function near_world(input signed [WIDE-1:0] value);
    near_world = value >= -1 && value <= 1 << COORDINATE_BITS;
endfunction
always @* if (ADDERS) begin
    assume (near_world(first_low) && near_world(first_high) && near_world(then_low) && near_world(then_high));
    assume (look == 0);
end

// The rectangles that are fetched now and were in the previous cycles; the state is known from the first reset on.
reg ready = 1'b0, busy;
reg [INDEX_BITS-1:0] number, number_1, number_2, number_3, number_4;
reg [3:0] fetched;
always @(posedge clk) begin
    ready <= ready || reset;
    busy <= !reset && (start_line || busy && number != RECTANGLES - 1);
    number <= start_line && !reset ? 0 : number + (busy && number != RECTANGLES - 1);
    fetched <= reset ? 0 : {fetched[2:0], busy};
    number_1 <= number;
    number_2 <= number_1;
    number_3 <= number_2;
    number_4 <= number_3;
end
always @* begin
    if (busy) assume (!start_line || number == RECTANGLES - 1);
    assume (ready || reset);
    if (ready) begin
        assert (fetch == busy);
        if (busy) assert (index == number && number < RECTANGLES);
        assert (load == (fetched[3] ? 1 << number_4 : 0));
    end
end

// The definition, in numbers wide enough for any distance. p is y unless the plane is on y, then x; q is z unless the
// plane is on z, then x.
wire on_y = axis == 1, on_z = axis == 2;
wire signed [WIDE-1:0] wide_x = {1'b0, x}, wide_y = {1'b0, y}, wide_z = {1'b0, z}, plane = {1'b0, position};
wire signed [WIDE-1:0] first_low = place(u_low), first_high = place(u_high), then_low = place(v_low);
wire signed [WIDE-1:0] then_high = place(v_high);
wire signed [WIDE-1:0] to_plane = plane - (axis == 0 ? wide_x : on_y ? wide_y : wide_z);
wire signed [WIDE-1:0] eye_p = on_y ? wide_x : wide_y, eye_q = on_z ? wide_x : wide_z;
wire signed [WIDE-1:0] to_low_p = (on_z ? then_low : first_low) - eye_p;
wire signed [WIDE-1:0] to_high_p = (on_z ? then_high : first_high) - eye_p;
wire signed [WIDE-1:0] to_low_q = (on_z ? first_low : then_low) - eye_q;
wire signed [WIDE-1:0] to_high_q = (on_z ? first_high : then_high) - eye_q;
reg was_usable_3, was_usable_2, was_usable_1, was_usable;
reg [1:0] axis_1, axis_2;
reg [LOOK_BITS-1:0] look_1, look_2;
reg signed [WIDE-1:0] n_1, n_2, low_p_1, low_p_2, high_p_1, high_p_2, low_q_1, low_q_2, high_q_1, high_q_2;
reg signed [SLOPE_BITS-1:0] slope_a, slope_p, slope_q;
always @(posedge clk) begin
    {was_usable_3, was_usable_2, was_usable_1} <= {usable[number], was_usable_3, was_usable_2};
    was_usable <= was_usable_1;
    axis_1 <= axis;
    look_1 <= look;
    n_1 <= to_plane;
    low_p_1 <= to_low_p;
    high_p_1 <= to_high_p;
    low_q_1 <= to_low_q;
    high_q_1 <= to_high_q;
    slope_a <= axis == 0 ? dx : on_y ? dy : dz;
    slope_p <= on_y ? dx : dy;
    slope_q <= on_z ? dx : dz;
end
function fits(input signed [WIDE-1:0] value, input [3:0] bits);
    fits = value > -(1 << bits - 1) && value < 1 << bits - 1;
endfunction
always @* assert (fits(to_plane, DISTANCE_BITS));
always @* assert (fits(to_low_p, TO_BOUND_BITS) && fits(to_high_p, TO_BOUND_BITS));
always @* assert (fits(to_low_q, TO_BOUND_BITS) && fits(to_high_q, TO_BOUND_BITS));

wire signed [DISTANCE_BITS-1:0] n = n_1;
wire signed [TO_BOUND_BITS-1:0] low_p_part = low_p_1, high_p_part = high_p_1, low_q_part = low_q_1;
wire signed [TO_BOUND_BITS-1:0] high_q_part = high_q_1;
wire signed [WALK_BITS-1:0] product_p = n * slope_p, product_q = n * slope_q;
wire signed [WALK_BITS-1:0] product_low_p = low_p_part * slope_a, product_high_p = high_p_part * slope_a;
wire signed [WALK_BITS-1:0] product_low_q = low_q_part * slope_a, product_high_q = high_q_part * slope_a;
reg signed [WALK_BITS-1:0] is_p, is_q, is_low_p, is_high_p, is_low_q, is_high_q;
always @(posedge clk) begin
    axis_2 <= axis_1;
    look_2 <= look_1;
    n_2 <= n_1;
    low_p_2 <= low_p_1;
    high_p_2 <= high_p_1;
    low_q_2 <= low_q_1;
    high_q_2 <= high_q_1;
    {is_p, is_q} <= {product_p, product_q};
    {is_low_p, is_high_p, is_low_q, is_high_q} <= {product_low_p, product_high_p, product_low_q, product_high_q};
end
always @* if (ready && load != 0) begin
    assert (facet_usable == was_usable && facet_axis == axis_2 && distance == n_2);
    if (!ADDERS) assert (facet_look == look_2);
    assert (way_p == is_p && way_q == is_q);
    assert (low_p == is_low_p && high_p == is_high_p && low_q == is_low_q && high_q == is_high_q);
    if (!TURN) begin
        assert (more_way == (axis_2 == 1 ? 0 : n_2));
        assert (more_low_p == (axis_2 == 1 ? low_p_2 : 0) && more_high_p == (axis_2 == 1 ? high_p_2 : 0));
        assert (more_low_q == (axis_2 == 1 ? low_q_2 : 0) && more_high_q == (axis_2 == 1 ? high_q_2 : 0));
    end
end

always @* cover (ready && load == 2 && facet_usable);
endmodule
