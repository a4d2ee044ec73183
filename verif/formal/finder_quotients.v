// SPDX-License-Identifier: MIT
// The seed engine's intersection at full width, with any function instead of multiplication and division: hit, depth
// and point are the golden model's a + b * (c - d) / e within the bounds, for any products and quotients. divider-exact
// proves the quotient and its timing. With patterns, a hit's parities on u and on v are those of the point's cell.
//
// Assumed, as the control guarantees: a division starts two cycles after its plane was taken, with none taken in
// between, lasts STEPS cycles, and starts at least as many after the previous one; it may be abandoned at its start.
// The ray is constant while a rectangle is in progress. `offered` is the rectangle that has left the dividers.
//
// [proof]
// claim = "hit, depth and point are those of the golden model's a + b * (c - d) / e, at full width"
// modules = ["intersection_finder", "intersection_helper", "magnitude", "cell_parity if PATTERNS", "divider"]
// cut = ["divider"]
// any_product = true
// parameters = { STEPS = "DIVIDER_STEPS" }
// induction = 1
// reach = "STEPS + 5"
// quick = ["one-unit"]
// designs = ["one-unit patterns materials", "one-unit fraction_bits=8 rounding=nearest divider_bits=2"]
// [faults]
// "vga240-u1-r12-m1-f0t-d3-c8" = ["intersection_finder.u_value edge",
//   "intersection_finder.by_axis_8_i.on_z as ray_z", "intersection_helper.stored_negative inverted",
//   "intersection_helper.e_negative inverted", "intersection_helper.away short",
//   "intersection_helper.loaded_word as started_word"]
// "vga240-u1-r12-m1-f0t-d3-c8-materials-patterns" = ["intersection_finder.cell_parity_1_i.value as u_value"]

// A product of a width used nowhere else, so it is any function; overflow and quotient are bits of it.
module any_division #(parameter POSITION_BITS = 9) (
    input [POSITION_BITS+8:0] dividend, input [8:0] divisor, output [POSITION_BITS:0] result);
wire [47:0] value = dividend * divisor;
assign result = value;
endmodule

module finder_quotients;
localparam P = POSITION_BITS, RECT_BITS = LOOK_BITS + 47, RAY_BITS = 3 * P + 30;

// Planes taken and divisions started in the previous cycles, one bit per cycle.
reg [1:0] found = 0;
reg [STEPS+1:0] loaded = 0;
wire steps_store_quotient = loaded[STEPS-1], verdict = loaded[STEPS+1];
wire [P-1:0] x = ray_x, y = ray_y, z = ray_z;
wire [RAY_BITS-1:0] ray = {ray_word, slope_dx, slope_dy, slope_dz};
(* anyseq *) reg give_up;
always @(posedge clk) begin
    found <= {found, steps_find_intersection};
    loaded <= {loaded, steps_load_divider && !give_up};
end
always @* begin
    if (steps_load_divider) assume (found[1] && !found[0] && loaded[STEPS-2:0] == 0);
    if (found != 0 || loaded != 0) assume ($stable(ray));
end
generate
    genvar apart;
    for (apart = 1; apart < STEPS; apart = apart + 1) begin: spaced
        always @* assert ((loaded & loaded << apart) == 0);
    end
endgenerate

// c - d: the distance of the plane.
function signed [P:0] numerator(
    input [RECT_BITS-1:0] of, input signed [P:0] from_x, input signed [P:0] from_y, input signed [P:0] from_z);
    reg signed [P:0] plane;
    begin
        plane = of[RECT_BITS-3 -: 9] << FRACTION_BITS;
        numerator = plane - (of[RECT_BITS-1 -: 2] == 0 ? from_x : of[RECT_BITS-1 -: 2] == 1 ? from_y : from_z);
    end
endfunction
function [P-1:0] size(input signed [P:0] number);
    size = number < 0 ? -number : number;
endfunction

// The golden model's operands: e and d are those of the plane's axis; u is x, or y if the plane is on x.
wire [1:0] axis = rect_axis;
wire signed [P:0] n = numerator(rect_word, x, y, z);
wire [8:0] e = axis == 0 ? slope_dx : axis == 1 ? slope_dy : slope_dz;
wire [8:0] b_u = axis == 0 ? slope_dy : slope_dx, b_v = axis < 2 ? slope_dz : slope_dy;
wire e_negative = axis == 0 ? ray_dx : axis == 1 ? ray_dy : ray_dz;
wire u_negative = axis == 0 ? ray_dy : ray_dx, v_negative = axis < 2 ? ray_dz : ray_dy;
wire runs_towards = e != 0 && (e_negative ? n < 0 : n > 0);
wire [P-1:0] distance = size(n);
wire [P+8:0] product_u = b_u * distance, product_v = b_v * distance;
wire [P:0] result_u, result_v;
any_division #(P) golden_u (.dividend(product_u), .divisor(e), .result(result_u));
any_division #(P) golden_v (.dividend(product_v), .divisor(e), .result(result_v));

// Values that follow a rectangle into the dividers and out of them.
localparam WAY_BITS = 2 * P + 5;
wire [WAY_BITS-1:0] ways = {runs_towards, u_negative, v_negative, result_u, result_v};
reg [RECT_BITS-1:0] taken_rect, divided_rect, offered_word;
reg [WAY_BITS-1:0] taken_ways, divided_ways, offered_ways;
wire [P-1:0] taken_distance = size(numerator(taken_rect, x, y, z));
wire [P-1:0] divided_distance = size(numerator(divided_rect, x, y, z));
wire [P-1:0] offered_distance = size(numerator(offered_word, x, y, z));
reg [P+8:0] taken_product_u, taken_product_v;
reg [8:0] taken_b_u, taken_b_v, taken_e;
always @(posedge clk) begin
    if (steps_find_intersection) begin
        {taken_rect, taken_ways} <= {rect_word, ways};
        {taken_product_u, taken_product_v} <= {product_u, product_v};
        {taken_b_u, taken_b_v, taken_e} <= {b_u, b_v, e};
    end
    if (steps_load_divider) {divided_rect, divided_ways} <= {taken_rect, taken_ways};
    if (steps_store_quotient) {offered_word, offered_ways} <= {divided_rect, divided_ways};
end

// The golden model's verdict.
wire ahead, back_u, back_v;
wire [P:0] far_u, far_v;
assign {ahead, back_u, back_v, far_u, far_v} = offered_ways;
wire [1:0] across = offered_axis;
wire [P-1:0] depth_there = offered_position << FRACTION_BITS;
wire signed [P+1:0] low_u = offered_u_low << FRACTION_BITS, high_u = offered_u_high << FRACTION_BITS;
wire signed [P+1:0] low_v = offered_v_low << FRACTION_BITS, high_v = offered_v_high << FRACTION_BITS;
wire signed [P+1:0] a_u = across == 0 ? y : x, a_v = across < 2 ? z : y;
wire signed [P+1:0] way_u = far_u[P-1:0], way_v = far_v[P-1:0];
wire signed [P+1:0] at_u = back_u ? a_u - way_u : a_u + way_u, at_v = back_v ? a_v - way_v : a_v + way_v;
wire golden_hit = ahead && !far_u[P] && !far_v[P] && low_u <= at_u && at_u <= high_u && low_v <= at_v && at_v <= high_v;
wire [P-1:0] golden_x = across == 0 ? depth_there : at_u, golden_z = across < 2 ? at_v : depth_there;
wire [P-1:0] golden_y = across == 0 ? at_u : across == 1 ? depth_there : at_v;
wire [P-1:0] golden_depth = golden_x < x ? x - golden_x : golden_x - x;

intersection_finder dut (.*);
generate
    if (PATTERNS) begin: patterns
        wire [8:0] cell_u = at_u >> FRACTION_BITS + 3 + offered_cell, cell_v = at_v >> FRACTION_BITS + 3 + offered_cell;
        always @* if (verdict && hit) assert (odd_u == cell_u[0] && odd_v == cell_v[0]);
    end
endgenerate
always @* if (found != 0) assert (towards == taken_ways[WAY_BITS-1]);
always @* if (verdict) begin
    assert (hit == golden_hit);
    if (hit) assert (depth == golden_depth && point_word == {golden_x, golden_y, golden_z});
end

// The units of both axes, and the dividers' contract: a result belongs to the operands at load_divider, and is valid
// from the cycle after its store.
generate
    genvar unit;
    for (unit = 0; unit < 2; unit = unit + 1) begin: units
        wire [8:0] started_b = dut.intersection_helper{unit}_i.started_b;
        wire [8:0] started_e = dut.intersection_helper{unit}_i.started_e;
        wire [P+1:0] started = dut.intersection_helper{unit}_i.started_word;
        wire [P+1:0] in_divider = dut.intersection_helper{unit}_i.loaded_word;
        wire [P+1:0] stored = dut.intersection_helper{unit}_i.stored_word;
        wire [P+8:0] product = dut.intersection_helper{unit}_i.product;
        wire overflow = dut.intersection_helper{unit}_i.overflow;
        wire [P-1:0] quotient = dut.intersection_helper{unit}_i.quotient;

        wire [P:0] result;
        reg [P:0] result_held, result_stored;
        any_division #(P) division (.dividend(product), .divisor(started_e), .result(result));
        always @(posedge clk) begin
            if (steps_load_divider) result_held <= result;
            if (steps_store_quotient) result_stored <= result_held;
        end
        always @* assume ({overflow, quotient} == result_stored);

        // Invariants: values in flight belong to the rectangle that came in.
        wire [P:0] far_taken = unit ? taken_ways[P:0] : taken_ways[2*P+1 -: P+1];
        wire [P:0] far_divided = unit ? divided_ways[P:0] : divided_ways[2*P+1 -: P+1];
        wire [P+8:0] product_taken = unit ? taken_product_v : taken_product_u;
        wire [8:0] b_taken = unit ? taken_b_v : taken_b_u;
        wire [P+8:0] way = b_taken * taken_distance;
        wire [P:0] quotient_taken;
        any_division #(P) again (.dividend(product_taken), .divisor(taken_e), .result(quotient_taken));
        always @* if (found != 0) begin
            assert (started_b == b_taken && started_e == taken_e && product_taken == way);
            assert (started == {taken_distance, taken_ways[WAY_BITS-2-unit], taken_ways[WAY_BITS-1]});
            assert (far_taken == quotient_taken);
        end
        always @* if (found == 2) assert (product == product_taken);
        always @* if (loaded[STEPS-1:0] != 0) begin
            assert (in_divider == {divided_distance, divided_ways[WAY_BITS-2-unit], divided_ways[WAY_BITS-1]});
            assert (result_held == far_divided);
        end
        always @* if (loaded[STEPS+1:STEPS] != 0) begin
            assert (stored == {offered_distance, offered_ways[WAY_BITS-2-unit], offered_ways[WAY_BITS-1]});
            assert (result_stored == (unit ? far_v : far_u));
        end
    end
endgenerate

always @* cover (verdict && hit && depth == 7);
always @* cover (loaded[STEPS] && found != 0);
endmodule
