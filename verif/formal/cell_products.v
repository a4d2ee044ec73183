// SPDX-License-Identifier: MIT
// The cell of a pattern at the engine's own widths, with any function instead of multiplication. With w = E e + D n,
// which is P e, the finder's digits and remainder satisfy w / 8 = e * digits + remainder, with the remainder below e.
// So by the lemma division the digits are those of P, down to the smallest cell, and one of them is the cell's parity.
// e * digits is summed up digit by digit.
//
// Assumed, as the control guarantees: P[v] starts three cycles after P[u], and all inputs are constant meanwhile. The
// hit is assumed to be within the world, 0 <= P <= 511.
//
// [proof]
// claim = "the digits that give a pattern's cell are those of the quotient, by long division, at full width"
// modules = ["cell_finder", "divider_step"]
// any_product = true
// induction = 2
// reach = 8
// designs = ["exact one-unit turn materials patterns reflections=0,1,2,3,4", "exact one-unit patterns"]
// [faults]
// "exact-vga240-u1-r12-m1-c8-patterns" = ["divider_step.difference edge", "hit_component.along[0] 0",
//   "cell_finder.point short", "hit_component.flipped_way as way", "cell_finder.odd_v as digits_1"]

module cell_products;
localparam POINT_BITS = SLOPE_BITS + COORDINATE_BITS, DIGITS = COORDINATE_BITS - 3;
localparam WAY_BITS = EYE_BITS - 1 > COORDINATE_BITS ? EYE_BITS - 1 + SLOPE_BITS : POINT_BITS;
localparam WIDE = EYE_BITS + SLOPE_BITS + 3;

cell_finder dut (.*);

wire load = steps_load_divider, store = steps_store_quotient;
wire [1:0] axis = found_surface_axis;
wire [SLOPE_BITS-1:0] e = found_slope;
wire [EYE_BITS-2:0] n = found_distance;
wire [2:0] cell_size = found_surface_cell;

// Cycles since a point was started; 0: none is in progress.
reg [1:0] age = 0;
reg on_v = 1'b0;
localparam STILL_BITS = 4 * EYE_BITS + 4 * SLOPE_BITS + 7;
wire [STILL_BITS-1:0] still = {eye_x, eye_y, eye_z, signs_word, slope_dx, slope_dy, slope_dz, n, e, axis, cell_size};
always @(posedge clk) begin
    age <= load || store ? 1 : age == 0 || age == 3 ? 0 : age + 1;
    on_v <= store || on_v && !load;
end
always @* begin
    assume (axis < 3 && !(load && store));
    if (store) assume (age == 3 && !on_v);
    if (age != 0 && !load) assume ($stable(still));
end

// The definition of w. The operands of its products are signals of the design, which are asserted to be right.
wire signed [EYE_BITS-1:0] eye = store ? (axis == 2 ? eye_y : eye_z) : axis == 0 ? eye_y : eye_x;
wire [SLOPE_BITS-1:0] slope = store ? (axis == 2 ? slope_dy : slope_dz) : axis == 0 ? slope_dy : slope_dx;
wire back = store ? (axis == 2 ? signs_dy : signs_dz) : axis == 0 ? signs_dy : signs_dx;
wire signed [SLOPE_BITS:0] divisor = {1'b0, e};
wire signed [EYE_BITS+SLOPE_BITS:0] from_eye = dut.eye_q * divisor;
wire [WAY_BITS-1:0] way = n * dut.slope_q;
wire signed [WIDE-1:0] way_part = {1'b0, way};
wire signed [WIDE-1:0] w = back ? from_eye - way_part : from_eye + way_part;
wire signed [WIDE-1:0] most = (divisor <<< COORDINATE_BITS) - divisor;
always @* if (load || store) begin
    assert (dut.eye_q == eye && dut.slope_q == slope);
    assume (e != 0 && w >= 0 && w <= most);
end

// Long division, two digits per cycle: the digits of w so far are e * quotient + remainder.
reg [POINT_BITS-1:0] point;
reg [DIGITS-1:0] quotient;
reg [POINT_BITS-1:0] multiple;
wire [POINT_BITS-1:0] twice = {e, 1'b0};
wire [POINT_BITS-1:0] next_multiple = (multiple << 2) + (dut.digits_2[1] ? twice : 0) + (dut.digits_2[0] ? e : 0);
always @(posedge clk) begin
    point <= load || store ? w : point;
    quotient <= load || store ? 0 : {quotient, dut.digits_2[1:0]};
    multiple <= load || store ? 0 : next_multiple;
end
wire [POINT_BITS-1:0] taken = point >> (COORDINATE_BITS + 2 - 2 * age);
wire [POINT_BITS-1:0] next_taken = point >> (COORDINATE_BITS - 2 * age);
wire [DIGITS-1:0] next_quotient = {quotient, dut.digits_2[1:0]};
reg expected_u;
always @(posedge clk) if (store) expected_u <= cell_size < DIGITS && next_quotient[cell_size];
always @* if (age != 0) begin
    assert (taken == multiple + dut.remainder && dut.remainder < $past(still)[SLOPE_BITS+4:5]);
    if (age == 1) assert (quotient == 0 && multiple == 0 && dut.digits == point[COORDINATE_BITS-1:3]);
    if (age == 2) assert (dut.digits == {point[COORDINATE_BITS-3:3], quotient[1:0]});
    if (age == 3) assert (dut.digits == {point[COORDINATE_BITS-5:3], quotient[3:0]});
    if (!load) assert (next_taken == next_multiple + dut.remainder_2 && dut.remainder_2 < e);
end
always @* if (age == 3 && !load) assert (odd_v == (cell_size < DIGITS && next_quotient[cell_size]));
always @* if (age != 0 && on_v) assert (odd_u == expected_u);

always @* cover (age == 3 && on_v && odd_u && odd_v && cell_size == 2);
endmodule
