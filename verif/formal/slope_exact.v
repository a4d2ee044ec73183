// SPDX-License-Identifier: MIT
// The primary ray's slope at the engine's own widths, in sign and magnitude: view distance * forward + (column -
// centre) * right + (horizon - row) * up, or without a basis only its factors. With a basis, multiplication is any
// function with two known properties, which are the lemmas next-column and slope-in-range.
//
// Assumed, as the renderer guarantees: the pixel is on the screen, and its place and the basis are constant from the
// cycle before the ray is loaded.
//
// [proof]
// claim = "a pixel's slope in the exact engine has the definition's sign and magnitude, and fits, at full width"
// modules = ["turned_generator if TURN", "slope_component if TURN", "ray_generator if not TURN", "magnitude"]
// any_product = "TURN"
// parameters = { COLUMN_BITS = "(COLUMNS + UNITS).bit_length() + 1" }
// induction = 2
// reach = 4
// quick = ["exact turn"]
// designs = ["exact", "exact rows=200", "exact turn reflections=2"]
// [faults]
// "exact-vga240-u4-r12-m1-c8" = ["ray_generator.place_row increased", "ray_generator.dy edge"]
// "exact-vga240-u4-r12-m1-c8-turn" = ["slope_component.component_size short",
//   "turned_generator.camera_up_y as camera_up_x", "slope_component.upward negated"]

module slope_exact #(
    parameter TURN = 0, parameter SLOPE_BITS = 8, parameter COORDINATE_BITS = 9, parameter BASIS_BITS = 10,
    parameter VIEW_DISTANCE = 100, parameter CENTRE = 160, parameter HORIZON = 190, parameter COLUMNS = 320,
    parameter ROWS = 240, parameter UNITS = 4, parameter UNIT_BITS = 2, parameter OFFSET_BITS = 7,
    parameter ROW_BITS = 8, parameter COLUMN_BITS = 10
) (
    input clk, input load, input [ROW_BITS-1:0] row, input [OFFSET_BITS-1:0] offset, input [UNIT_BITS-1:0] base,
    input [3*COORDINATE_BITS-1:0] position, input [9*BASIS_BITS-1:0] basis
);
localparam WIDE = SLOPE_BITS + 4;

wire [2:0] negative;
wire [SLOPE_BITS-1:0] dx, dy, dz;
// In numbers that are wide enough: from the centre to the first unit's column, and to that of this unit; from the
// horizon up.
wire signed [WIDE-1:0] first = offset * UNITS - CENTRE, column = first + base, level = HORIZON - row;
wire [3*WIDE-1:0] slope;
wire signed [WIDE-1:0] x = slope[0 +: WIDE], y = slope[WIDE +: WIDE], z = slope[2*WIDE +: WIDE];

reg running = 1'b0, loaded = 1'b0;
reg [ROW_BITS-1:0] last_row;
reg [OFFSET_BITS-1:0] last_offset;
reg [UNIT_BITS-1:0] last_base;
reg [9*BASIS_BITS-1:0] last_basis;
reg signed [WIDE-1:0] last_x, last_y, last_z;
always @(posedge clk) begin
    running <= 1'b1;
    loaded <= load;
    last_row <= row;
    last_offset <= offset;
    last_base <= base;
    last_basis <= basis;
    last_x <= x;
    last_y <= y;
    last_z <= z;
end
wire still = row == last_row && offset == last_offset && base == last_base && basis == last_basis;
always @* begin
    assume (row < ROWS && base < UNITS && offset < COLUMNS / UNITS);
    if (load) assume (running && still);
end

generate
    genvar axis;
    if (TURN) begin: design
        turned_generator dut (
            .clk(clk), .column_base(base), .steps_screen_to_ray(load), .place_row(row), .place_column_offset(offset),
            .camera_word({position, basis}), .initial_signs_word(negative), .slope_dx(dx), .slope_dy(dy), .slope_dz(dz)
        );
        (* hierconn *) wire signed [COLUMN_BITS-1:0] \dut.column ;
        (* hierconn *) wire signed [ROW_BITS:0] \dut.row ;
        for (axis = 0; axis < 3; axis = axis + 1) begin: along
            slope_along #(
                .BASIS_BITS(BASIS_BITS), .PRODUCT_BITS(SLOPE_BITS + 2), .WIDE(WIDE), .VIEW_DISTANCE(VIEW_DISTANCE),
                .CENTRE(CENTRE), .HORIZON(HORIZON), .UNIT_BITS(UNIT_BITS), .COLUMN_BITS(COLUMN_BITS),
                .ROW_BITS(ROW_BITS)
            ) component (
                .clk(clk), .load(load), .forward(basis[(8-axis)*BASIS_BITS +: BASIS_BITS]),
                .right(basis[(5-axis)*BASIS_BITS +: BASIS_BITS]), .up(basis[(2-axis)*BASIS_BITS +: BASIS_BITS]), .first(\dut.column ), .base(base),
                .row(\dut.row ), .slope(slope[axis*WIDE +: WIDE])
            );
        end
        always @* begin
            assert (\dut.column  == first && \dut.row  == level);
            assert (column >= -CENTRE && column <= CENTRE && level >= -HORIZON && level <= HORIZON);
        end
    end
    else begin: design
        ray_generator dut (
            .clk(clk), .column_base(base), .steps_screen_to_ray(load), .place_row(row), .place_column_offset(offset),
            .initial_signs_word(negative), .slope_dx(dx), .slope_dy(dy), .slope_dz(dz)
        );
        wire signed [WIDE-1:0] ahead = VIEW_DISTANCE;
        assign slope = {level, column, ahead};
    end
endgenerate

wire signed [WIDE-1:0] size_x = {1'b0, dx}, size_y = {1'b0, dy}, size_z = {1'b0, dz};
always @* if (loaded) begin
    assert ((negative[2] ? -size_x : size_x) == last_x && negative[2] == (last_x < 0));
    assert ((negative[1] ? -size_y : size_y) == last_y && negative[1] == (last_y < 0));
    assert ((negative[0] ? -size_z : size_z) == last_z && negative[0] == (last_z < 0));
end

always @* cover (loaded && negative == (TURN ? 7 : 3) && dy > CENTRE - 1);
endmodule

// One component: its products have the width of the design, in which they fit by the lemma product-in-range. The
// operands are signals of the design, which are asserted above to be right.
module slope_along #(
    parameter BASIS_BITS = 10, parameter PRODUCT_BITS = 20, parameter WIDE = 22, parameter VIEW_DISTANCE = 100,
    parameter CENTRE = 160, parameter HORIZON = 190, parameter UNIT_BITS = 2,
    parameter COLUMN_BITS = 10, parameter ROW_BITS = 8
) (
    input clk, input load, input signed [BASIS_BITS-1:0] forward, input signed [BASIS_BITS-1:0] right,
    input signed [BASIS_BITS-1:0] up, input signed [COLUMN_BITS-1:0] first, input [UNIT_BITS-1:0] base,
    input signed [ROW_BITS:0] row, output signed [WIDE-1:0] slope
);
localparam MOST = VIEW_DISTANCE + CENTRE + HORIZON << BASIS_BITS - 1;
wire signed [UNIT_BITS:0] base_part = {1'b0, base};
wire signed [PRODUCT_BITS-1:0] ahead = forward * VIEW_DISTANCE, upward = up * row;
wire signed [PRODUCT_BITS-1:0] to_first = right * first, aside = right * base_part;
// By next-column, right * first + right * base is right * column; by slope-in-range the sum fits these bits. All
// summands except that of the base are from the previous cycle, with the same pixel, so that the solver need not add
// them again.
reg signed [PRODUCT_BITS-1:0] before;
always @(posedge clk) before <= ahead + to_first + upward;
wire signed [PRODUCT_BITS-1:0] sum = before + aside;
assign slope = sum;
always @* begin
    if (load) assume (slope >= -MOST && slope <= MOST);
end
endmodule
