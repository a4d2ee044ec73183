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

module cell_products #(
    parameter COORDINATE_BITS = 9, parameter LOOK_BITS = 56, parameter SLOPE_BITS = 8, parameter EYE_BITS = 11
) (
    input clk, input load, input store, input [1:0] axis, input [COORDINATE_BITS-1:0] position,
    input [LOOK_BITS-28:0] look, input [2:0] cell_size, input [23:0] colour_2, input signed [EYE_BITS-1:0] x,
    input signed [EYE_BITS-1:0] y, input signed [EYE_BITS-1:0] z, input [2:0] signs, input [SLOPE_BITS-1:0] dx,
    input [SLOPE_BITS-1:0] dy, input [SLOPE_BITS-1:0] dz, input [EYE_BITS-2:0] n, input [SLOPE_BITS-1:0] e
);
localparam POINT_BITS = SLOPE_BITS + COORDINATE_BITS, DIGITS = COORDINATE_BITS - 3;
localparam WAY_BITS = EYE_BITS - 1 > COORDINATE_BITS ? EYE_BITS - 1 + SLOPE_BITS : POINT_BITS;
localparam WIDE = EYE_BITS + SLOPE_BITS + 3;

wire odd_u, odd_v;
cell_finder dut (
    .clk(clk), .steps_load_divider(load), .steps_store_quotient(store), .eye_x(x), .eye_y(y), .eye_z(z),
    .signs_word(signs), .slope_dx(dx), .slope_dy(dy), .slope_dz(dz),
    .found_surface_word({axis, position, look, cell_size, colour_2}), .found_distance(n), .found_slope(e),
    .odd_u(odd_u), .odd_v(odd_v)
);
(* hierconn *) wire signed [EYE_BITS-1:0] \dut.eye_q ;
(* hierconn *) wire [SLOPE_BITS-1:0] \dut.slope_q , \dut.remainder , \dut.remainder_2 ;
(* hierconn *) wire [DIGITS-1:0] \dut.digits , \dut.digits_2 ;

// Cycles since a point was started; 0: none is in progress.
reg [1:0] age = 0;
reg on_v = 1'b0;
wire [3*EYE_BITS+4*SLOPE_BITS+EYE_BITS+7:0] still = {x, y, z, signs, dx, dy, dz, n, e, axis, cell_size};
reg [3*EYE_BITS+4*SLOPE_BITS+EYE_BITS+7:0] last_still;
always @(posedge clk) begin
    age <= load || store ? 1 : age == 0 || age == 3 ? 0 : age + 1;
    on_v <= store || on_v && !load;
    last_still <= still;
end
always @* begin
    assume (axis < 3 && !(load && store));
    if (store) assume (age == 3 && !on_v);
    if (age != 0 && !load) assume (still == last_still);
end

// The definition of w. The operands of its products are signals of the design, which are asserted to be right.
wire signed [EYE_BITS-1:0] eye = store ? (axis == 2 ? y : z) : axis == 0 ? y : x;
wire [SLOPE_BITS-1:0] slope = store ? (axis == 2 ? dy : dz) : axis == 0 ? dy : dx;
wire back = store ? (axis == 2 ? signs[1] : signs[0]) : axis == 0 ? signs[1] : signs[2];
wire signed [SLOPE_BITS:0] divisor = {1'b0, e};
wire signed [EYE_BITS+SLOPE_BITS:0] from_eye = \dut.eye_q * divisor;
wire [WAY_BITS-1:0] way = n * \dut.slope_q ;
wire signed [WIDE-1:0] way_part = {1'b0, way};
wire signed [WIDE-1:0] w = back ? from_eye - way_part : from_eye + way_part;
wire signed [WIDE-1:0] most = (divisor <<< COORDINATE_BITS) - divisor;
always @* if (load || store) begin
    assert (\dut.eye_q == eye && \dut.slope_q == slope);
    assume (e != 0 && w >= 0 && w <= most);
end

// Long division, two digits per cycle: the digits of w so far are e * quotient + remainder.
reg [POINT_BITS-1:0] point;
reg [DIGITS-1:0] quotient;
reg [POINT_BITS-1:0] multiple;
wire [POINT_BITS-1:0] twice = {e, 1'b0};
wire [POINT_BITS-1:0] next_multiple = (multiple << 2) + (\dut.digits_2 [1] ? twice : 0) + (\dut.digits_2 [0] ? e : 0);
always @(posedge clk) begin
    point <= load || store ? w : point;
    quotient <= load || store ? 0 : {quotient, \dut.digits_2 [1:0]};
    multiple <= load || store ? 0 : next_multiple;
end
wire [POINT_BITS-1:0] taken = point >> (COORDINATE_BITS + 2 - 2 * age), next_taken = point >> (COORDINATE_BITS - 2 * age);
wire [DIGITS-1:0] next_quotient = {quotient, \dut.digits_2 [1:0]};
reg expected_u;
always @(posedge clk) if (store) expected_u <= cell_size < DIGITS && next_quotient[cell_size];
always @* if (age != 0) begin
    assert (taken == multiple + \dut.remainder && \dut.remainder < last_still[SLOPE_BITS+4:5]);
    if (age == 1) assert (quotient == 0 && multiple == 0 && \dut.digits == point[COORDINATE_BITS-1:3]);
    if (age == 2) assert (\dut.digits == {point[COORDINATE_BITS-3:3], quotient[1:0]});
    if (age == 3) assert (\dut.digits == {point[COORDINATE_BITS-5:3], quotient[3:0]});
    if (!load) assert (next_taken == next_multiple + \dut.remainder_2 && \dut.remainder_2 < e);
end
always @* if (age == 3 && !load) assert (odd_v == (cell_size < DIGITS && next_quotient[cell_size]));
always @* if (age != 0 && on_v) assert (odd_u == expected_u);

always @* cover (age == 3 && on_v && odd_u && odd_v && cell_size == 2);
endmodule
