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
// induction = 2
// reach = 4
// quick = ["exact turn"]
// designs = ["exact", "exact rows=200", "exact turn reflections=2"]
// [faults]
// "exact-vga240-u4-r12-m1-c8" = ["ray_generator.place_row increased", "ray_generator.dy edge"]
// "exact-vga240-u4-r12-m1-c8-turn" = ["slope_component.component_size short",
//   "turned_generator.camera_up_y as camera_up_x", "slope_component.upward negated"]

module slope_exact;
localparam WIDE = SLOPE_BITS + 4;
`DUT dut (.*);

// In numbers that are wide enough: from the centre to the first unit's column, and to that of this unit; from the
// horizon up.
wire signed [WIDE-1:0] first = place_column_offset * UNITS - CENTRE, column = first + column_base;
wire signed [WIDE-1:0] level = HORIZON - place_row;
wire [3*WIDE-1:0] slope;
wire signed [WIDE-1:0] x = slope[0 +: WIDE], y = slope[WIDE +: WIDE], z = slope[2*WIDE +: WIDE];

reg running = 1'b0, loaded = 1'b0;
always @(posedge clk) {running, loaded} <= {1'b1, steps_screen_to_ray};
wire same_basis, still = $stable(place_row) && $stable(place_column_offset) && $stable(column_base);
always @* begin
    assume (place_row < ROWS && column_base < UNITS && place_column_offset < COLUMNS / UNITS);
    if (steps_screen_to_ray) assume (running && still && same_basis);
end

generate
    genvar axis;
    if (TURN) begin: design
        localparam PRODUCT_BITS = SLOPE_BITS + 2, MOST = VIEW_DISTANCE + CENTRE + HORIZON << BASIS_BITS - 1;
        wire [9*BASIS_BITS-1:0] basis = camera_word[9*BASIS_BITS-1:0];
        reg [9*BASIS_BITS-1:0] last_basis;
        always @(posedge clk) last_basis <= basis;
        assign same_basis = basis == last_basis;
        always @* begin
            assert (dut.column == first && dut.row == level);
            assert (column >= -CENTRE && column <= CENTRE && level >= -HORIZON && level <= HORIZON);
        end
        // The products have the width of the design, in which they fit by the lemma product-in-range. Their operands
        // are signals of the design, which are asserted above to be right.
        for (axis = 0; axis < 3; axis = axis + 1) begin: along
            wire signed [BASIS_BITS-1:0] forward = basis[(8-axis)*BASIS_BITS +: BASIS_BITS];
            wire signed [BASIS_BITS-1:0] right = basis[(5-axis)*BASIS_BITS +: BASIS_BITS];
            wire signed [BASIS_BITS-1:0] up = basis[(2-axis)*BASIS_BITS +: BASIS_BITS];
            wire signed [UNIT_BITS:0] base_part = {1'b0, column_base};
            wire signed [PRODUCT_BITS-1:0] ahead = forward * VIEW_DISTANCE, upward = up * dut.row;
            wire signed [PRODUCT_BITS-1:0] to_first = right * dut.column, aside = right * base_part;
            // By next-column, right * first + right * base is right * column; by slope-in-range the sum fits these
            // bits. All summands except that of the base are from the previous cycle, with the same pixel, so that the
            // solver need not add them again.
            reg signed [PRODUCT_BITS-1:0] before;
            always @(posedge clk) before <= ahead + to_first + upward;
            wire signed [PRODUCT_BITS-1:0] sum = before + aside;
            wire signed [WIDE-1:0] component = sum;
            assign slope[axis*WIDE +: WIDE] = component;
            always @* if (steps_screen_to_ray) assume (component >= -MOST && component <= MOST);
        end
    end
    else begin: design
        wire signed [WIDE-1:0] ahead = VIEW_DISTANCE;
        assign slope = {level, column, ahead};
        assign same_basis = 1;
    end
endgenerate

wire signed [WIDE-1:0] size_x = {1'b0, slope_dx}, size_y = {1'b0, slope_dy}, size_z = {1'b0, slope_dz};
wire [2:0] negative = initial_signs_word;
always @* if (loaded) begin
    assert ((negative[2] ? -size_x : size_x) == $past(x) && negative[2] == ($past(x) < 0));
    assert ((negative[1] ? -size_y : size_y) == $past(y) && negative[1] == ($past(y) < 0));
    assert ((negative[0] ? -size_z : size_z) == $past(z) && negative[0] == ($past(z) < 0));
end

always @* cover (loaded && negative == (TURN ? 7 : 3) && slope_dy > CENTRE - 1);
endmodule
