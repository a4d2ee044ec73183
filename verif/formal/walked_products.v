// SPDX-License-Identifier: MIT
// The walkers of a beam engine whose camera does not turn, at their own widths, with any function instead of
// multiplication: at each column of a row a rectangle's registers are the products of its distances with the slope
// there, whose D[y] is the column. The ways, the bounds and the slope may be stepped in different cycles.
//
// Assumed about products is the lemma next-column. Assumed about a row's start, as row-setup proves: products with the
// first column's slope, and the growth per column. Assumed, as the lane guarantees: the growth is constant along the
// row, and no step comes before the start or after the last column.
//
// [proof]
// claim = "without a turning camera, a rectangle's registers are its distances times the slope, at full width"
// modules = ["rect_walker", "slope_walker", "lane_start if PIXELS > 1"]
// any_product = true
// parameters = { SLOPE_BITS = "SLOPE_BITS + 1" }
// induction = 1
// reach = 6
// label = "{DESIGN}{' lane %d' % LANE if PIXELS > 1 else ''}"
// quick = ["beam two LANE=0"]
// designs = ["beam two pairs LANE=0,1"]
// [faults]
// "beam-vga240-s2-u1-r2-m1-c8" = ["rect_walker.high_q signed-short", "rect_walker.growth_low_p short",
//   "rect_walker.step_bounds as step_way", "slope_walker.slope_y negated"]
// "beam-vga180-s6-u2-r2-m1-c8 lane 1" = ["lane_start.growth_low_q 0"]
// "beam-vga180-s6-u2-r2-m1-c8 lane 0" = ["lane_start.first_start_word 0"]

module walked_products;
localparam WIDE = SLOPE_BITS + 1, FIELDS = 5, STRIDE_BITS = DISTANCE_BITS + PIXELS - 1;
localparam signed [SLOPE_BITS-1:0] AHEAD = VIEW_DISTANCE, FIRST_COLUMN = -CENTRE, LANE_COLUMN = LANE - CENTRE;
(* anyseq *) reg start_line, given, step_slope;
(* anyseq *) reg [1:0] given_axis;
(* anyseq *) reg [FIELDS*DISTANCE_BITS-1:0] given_distances;

// A row: the first column's slope, x in the lowest bits; D[z] is arbitrary.
(* anyseq *) reg [SLOPE_BITS-1:0] any_level;
reg [SLOPE_BITS-1:0] level;
always @(posedge clk) if (start_line) level <= any_level;
wire [3*SLOPE_BITS-1:0] first = {level, LANE_COLUMN, AHEAD}, first_of_row = {level, FIRST_COLUMN, AHEAD};

// A rectangle: its axis, and n and the distances to the four bounds, n in the lowest bits.
reg [1:0] axis;
reg [FIELDS*DISTANCE_BITS-1:0] distances;
reg started = 1'b0, was_given = 1'b0;
always @(posedge clk) begin
    if (given) {axis, distances} <= {given_axis, given_distances};
    was_given <= given;
    started <= started || start_line;
end
wire load = PIXELS > 1 ? was_given : given;  // in the next cycle the walker has its start

// The columns of the ways, of the bounds and of the slope.
wire way_valid, bounds_valid, slope_valid;
wire [3*WIDE-1:0] way_slope, bounds_slope, slope, next_way_slope, next_bounds_slope, next_slope;
column_slope #(SLOPE_BITS, STEEPEST, COLUMNS / PIXELS, PIXELS)
    ways (clk, load, step_way, first, way_valid, way_slope, next_way_slope),
    bounds (clk, load, step_bounds, first, bounds_valid, bounds_slope, next_bounds_slope),
    slopes (clk, start_line, step_slope, first, slope_valid, slope, next_slope);
always @* begin
    assume (given_axis < 3);
    // Each rectangle is loaded once per row, after the start of the row.
    if (start_line || !started) assume (!given && !was_given);
    if (was_given) assume (!given);
    if (given || load) assume (!step_way && !step_bounds);
    if (start_line) assume (!step_slope && !step_way && !step_bounds);
end

// The way along p, which is y unless the plane is on y, then x, and the bounds; the way along q is constant.
wire [FIELDS*WALK_BITS-1:0] start, walker_start;
wire [FIELDS*DISTANCE_BITS-1:0] column_growth;
wire [FIELDS*STRIDE_BITS-1:0] stride;
generate
    genvar field;
    for (field = 0; field < FIELDS; field = field + 1) begin: fields
        localparam AT = FIELDS - 1 - field;
        wire signed [DISTANCE_BITS-1:0] given_distance = given_distances >> field * DISTANCE_BITS;
        wire signed [DISTANCE_BITS-1:0] distance = distances >> field * DISTANCE_BITS;
        wire [1:0] which = field ? axis : axis == 1 ? 0 : 1;
        wire [1:0] given_which = field ? given_axis : given_axis == 1 ? 0 : 1;
        wire signed [WIDE-1:0] here = (field ? bounds_slope : way_slope) >> which * WIDE;
        wire signed [WIDE-1:0] next = (field ? next_bounds_slope : next_way_slope) >> which * WIDE;
        wire signed [WALK_BITS-1:0] product = distance * here, next_product = distance * next;
        wire valid = (field ? bounds_valid : way_valid) && !(PIXELS > 1 && was_given);

        // The growth per step: a distance or nothing, for each column of a clock.
        wire signed [WALK_BITS-1:0] distance_once = which == 1 ? distance : 0;
        wire signed [WALK_BITS-1:0] grows = PIXELS > 1 ? distance_once << 1 : distance_once;
        assign stride[AT*STRIDE_BITS +: STRIDE_BITS] = grows;
        always @* if (valid) begin
            assume (next_product == product + grows);  // next-column
            assert ($signed(walk_word[AT*WALK_BITS +: WALK_BITS]) == product);
        end

        wire signed [SLOPE_BITS-1:0] given_slope = first_of_row >> given_which * SLOPE_BITS;
        wire signed [SLOPE_BITS:0] slope_later = given_which == 1 ? given_slope + 1 : given_slope;
        wire signed [WALK_BITS-1:0] given_product = given_distance * given_slope, later = given_distance * slope_later;
        wire signed [WALK_BITS-1:0] given_once = given_which == 1 ? given_distance : 0;
        assign start[AT*WALK_BITS +: WALK_BITS] = given_product;
        assign column_growth[AT*DISTANCE_BITS +: DISTANCE_BITS] = given_once;
        always @* assume (later == given_product + given_once);  // next-column

        // A second lane starts one column further, and must load the product with the slope of that column.
        wire signed [SLOPE_BITS-1:0] loaded_slope = first >> which * SLOPE_BITS;
        wire signed [WALK_BITS-1:0] to_load = distance * loaded_slope;
        always @* if (PIXELS > 1 && was_given) assert ($signed(walker_start[AT*WALK_BITS +: WALK_BITS]) == to_load);
    end

    // By product-in-range no product is further from 0 than this.
    localparam [63:0] FARTHEST = STEEPEST * ((1 << DISTANCE_BITS - 1) - 1);
    always @* assert (FARTHEST < 64'd1 << WALK_BITS - 1);

    if (PIXELS > 1) begin: lanes
        lane_start dut (.*, .load({RECTANGLES{given}}), .start_word(start), .growth_word(column_growth));
        assign walker_start = LANE ? second_start_word : first_start_word;
        reg running = 1'b0;
        always @(posedge clk) running <= 1'b1;
        always @* if (running) assert (late_load == {RECTANGLES{was_given}});
    end
    else assign walker_start = start;
endgenerate
rect_walker walker (.*, .start_word(walker_start), .growth_word(stride));
slope_walker slope_dut (.*, .step(step_slope), .aim_y(LANE_COLUMN));
always @* if (slope_valid) assert (slope_y == $signed(slope[WIDE +: WIDE]));

always @* cover (way_valid && bounds_valid && slope_valid && way_slope != bounds_slope && slope != way_slope);
endmodule

// The slope of a column: D[y] is the column, counted from the centre; the other components are those of the row.
module column_slope #(
    parameter SLOPE_BITS = 10, parameter STEEPEST = 190, parameter COLUMNS = 320, parameter PIXELS = 1
) (
    input clk, input start, input step, input [3*SLOPE_BITS-1:0] first, output valid,
    output [3*(SLOPE_BITS+1)-1:0] slope, output [3*(SLOPE_BITS+1)-1:0] next_slope
);
localparam WIDE = SLOPE_BITS + 1, COUNT_BITS = 12;
reg begun = 1'b0;
reg [COUNT_BITS-1:0] column;
assign valid = begun && column < COLUMNS;
always @(posedge clk) begin
    if (start) begin
        begun <= 1'b1;
        column <= 0;
    end
    else if (step) column <= column + 1;
end
always @* begin
    if (step) assume (valid);
    if (begun) assert (column <= COLUMNS);
end

generate
    genvar axis;
    for (axis = 0; axis < 3; axis = axis + 1) begin: each
        reg signed [WIDE-1:0] now;
        wire signed [SLOPE_BITS-1:0] from = first[axis*SLOPE_BITS +: SLOPE_BITS];
        wire signed [WIDE-1:0] then = axis == 1 ? now + PIXELS : now;
        always @(posedge clk) begin
            if (start) now <= from;
            else if (step) now <= then;
        end
        assign slope[axis*WIDE +: WIDE] = now;
        assign next_slope[axis*WIDE +: WIDE] = then;
    end
endgenerate
wire signed [WIDE+1:0] from_centre = $signed(first[SLOPE_BITS +: SLOPE_BITS]), count = {1'b0, column};
wire signed [WIDE+1:0] here = from_centre + (count << PIXELS - 1), walked = $signed(slope[WIDE +: WIDE]);
always @* if (valid) assert (walked == here && here >= -STEEPEST && here <= STEEPEST);
endmodule
