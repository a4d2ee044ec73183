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

module walked_products #(
    parameter LANE = 0, parameter PIXELS = 1, parameter RECTANGLES = 2, parameter WALK_BITS = 19,
    parameter DISTANCE_BITS = 10, parameter SLOPE_BITS = 10, parameter VIEW_DISTANCE = 100, parameter CENTRE = 160,
    parameter STEEPEST = 190, parameter COLUMNS = 320
) (
    input clk, input start_line, input given, input step_way, input step_bounds, input step_slope,
    input [1:0] given_axis, input [5*DISTANCE_BITS-1:0] given_distances, input [SLOPE_BITS-1:0] any_level
);
localparam WIDE = SLOPE_BITS + 1, FIELDS = 6, STRIDE_BITS = DISTANCE_BITS + PIXELS - 1;
localparam signed [SLOPE_BITS-1:0] AHEAD = VIEW_DISTANCE, FIRST_COLUMN = -CENTRE, LANE_COLUMN = LANE - CENTRE;

// A row: the first column's slope, x in the lowest bits; D[z] is arbitrary.
reg [SLOPE_BITS-1:0] level;
always @(posedge clk) if (start_line) level <= any_level;
wire [3*SLOPE_BITS-1:0] first = {level, LANE_COLUMN, AHEAD}, first_of_row = {level, FIRST_COLUMN, AHEAD};

// A rectangle: its axis, and n and the distances to the four bounds, n in the lowest bits.
reg [1:0] axis;
reg [5*DISTANCE_BITS-1:0] distances;
reg started = 1'b0, was_given = 1'b0;
always @(posedge clk) begin
    if (given) begin
        axis <= given_axis;
        distances <= given_distances;
    end
    was_given <= given;
    started <= started || start_line;
end
wire load = PIXELS > 1 ? was_given : given;  // in the next cycle the walker has its start

// The columns of the ways, of the bounds and of the slope.
wire way_valid, bounds_valid, slope_valid;
wire [3*WIDE-1:0] way_slope, bounds_slope, slope, next_way_slope, next_bounds_slope, next_slope;
column_slope #(
    .SLOPE_BITS(SLOPE_BITS), .STEEPEST(STEEPEST), .COLUMNS(COLUMNS / PIXELS), .PIXELS(PIXELS)
) ways (
    .clk(clk), .start(load), .step(step_way), .first(first), .valid(way_valid), .slope(way_slope), .next_slope(next_way_slope)
), bounds (
    .clk(clk), .start(load), .step(step_bounds), .first(first), .valid(bounds_valid), .slope(bounds_slope), .next_slope(next_bounds_slope)
), slopes (
    .clk(clk), .start(start_line), .step(step_slope), .first(first), .valid(slope_valid), .slope(slope), .next_slope(next_slope)
);
always @* begin
    assume (given_axis < 3);
    // Each rectangle is loaded once per row, after the start of the row.
    if (start_line || !started) assume (!given && !was_given);
    if (was_given) assume (!given);
    if (given || load) assume (!step_way && !step_bounds);
    if (start_line) assume (!step_slope && !step_way && !step_bounds);
end

// p is y unless the plane is on y, then x; q is z unless the plane is on z, then x.
function [1:0] along(input integer field, input [1:0] plane);
    along = field == 0 ? (plane == 1 ? 0 : 1) : field == 1 ? (plane == 2 ? 0 : 2) : plane;
endfunction
function signed [SLOPE_BITS-1:0] narrow(input [3*SLOPE_BITS-1:0] vector, input [1:0] which);
    narrow = which == 0 ? vector[0 +: SLOPE_BITS] : which == 1 ? vector[SLOPE_BITS +: SLOPE_BITS]
        : vector[2*SLOPE_BITS +: SLOPE_BITS];
endfunction
function signed [WIDE-1:0] wide(input [3*WIDE-1:0] vector, input [1:0] which);
    wide = which == 0 ? vector[0 +: WIDE] : which == 1 ? vector[WIDE +: WIDE] : vector[2*WIDE +: WIDE];
endfunction
wire [FIELDS*WALK_BITS-1:0] walk, start, loads;
wire [FIELDS*STRIDE_BITS-1:0] stride;
wire [FIELDS*DISTANCE_BITS-1:0] column_growth;
generate
    genvar field;
    for (field = 0; field < FIELDS; field = field + 1) begin: fields
        localparam AT = field < 2 ? 0 : field - 1;
        wire signed [DISTANCE_BITS-1:0] given_distance = given_distances[AT*DISTANCE_BITS +: DISTANCE_BITS];
        wire signed [DISTANCE_BITS-1:0] distance = distances[AT*DISTANCE_BITS +: DISTANCE_BITS];
        wire [1:0] which = along(field, axis), given_which = along(field, given_axis);
        wire signed [WIDE-1:0] here = field < 2 ? wide(way_slope, which) : wide(bounds_slope, which);
        wire signed [WIDE-1:0] next = field < 2 ? wide(next_way_slope, which)
            : wide(next_bounds_slope, which);
        wire signed [WALK_BITS-1:0] product = distance * here, next_product = distance * next;
        wire valid = (field < 2 ? way_valid : bounds_valid) && !(PIXELS > 1 && was_given);

        // The growth per step: a distance or nothing, for each column of a clock.
        wire signed [WALK_BITS-1:0] distance_once = which == 1 ? distance : 0;
        wire signed [WALK_BITS-1:0] grows = PIXELS > 1 ? distance_once << 1 : distance_once;
        assign stride[(FIELDS-1-field)*STRIDE_BITS +: STRIDE_BITS] = grows;
        always @* if (valid) assume (next_product == product + grows);  // next-column

        wire signed [SLOPE_BITS-1:0] given_slope = narrow(first_of_row, given_which);
        wire signed [SLOPE_BITS:0] slope_later = given_which == 1 ? given_slope + 1 : given_slope;
        wire signed [WALK_BITS-1:0] given_product = given_distance * given_slope, later = given_distance * slope_later;
        wire signed [WALK_BITS-1:0] given_once = given_which == 1 ? given_distance : 0;
        assign start[(FIELDS-1-field)*WALK_BITS +: WALK_BITS] = given_product;
        assign column_growth[(FIELDS-1-field)*DISTANCE_BITS +: DISTANCE_BITS] = given_once;
        always @* assume (later == given_product + given_once);  // next-column

        wire signed [WALK_BITS-1:0] value = walk[(FIELDS-1-field)*WALK_BITS +: WALK_BITS];
        always @* if (valid && field != 1) assert (value == product);

        // A second lane starts one column further, and must load the product with the slope of that column.
        wire signed [SLOPE_BITS-1:0] loaded_slope = narrow(first, which);
        wire signed [WALK_BITS-1:0] to_load = distance * loaded_slope;
        wire signed [WALK_BITS-1:0] loading = loads[(FIELDS-1-field)*WALK_BITS +: WALK_BITS];
        always @* if (PIXELS > 1 && was_given && field != 1) assert (loading == to_load);
    end

    // By product-in-range no product is further from 0 than this.
    localparam [63:0] FARTHEST = STEEPEST * ((1 << DISTANCE_BITS - 1) - 1);
    always @* assert (FARTHEST < 64'd1 << WALK_BITS - 1);

    // The way along q is constant.
    localparam REST = 4 * WALK_BITS, REST_STRIDE = 4 * STRIDE_BITS, REST_DISTANCE = 4 * DISTANCE_BITS;
    wire [5*WALK_BITS-1:0] lane_start = {start[FIELDS*WALK_BITS-1 -: WALK_BITS], start[REST-1:0]};
    wire [5*WALK_BITS-1:0] walker_start;
    assign loads = {walker_start[5*WALK_BITS-1 -: WALK_BITS], {WALK_BITS{1'b0}}, walker_start[REST-1:0]};
    if (PIXELS > 1) begin: lanes
        wire [RECTANGLES-1:0] late_load;
        wire [5*WALK_BITS-1:0] first_start, second_start;
        lane_start dut (
            .clk(clk), .load({RECTANGLES{given}}), .late_load(late_load), .start_word(lane_start),
            .growth_word({
                column_growth[FIELDS*DISTANCE_BITS-1 -: DISTANCE_BITS], column_growth[REST_DISTANCE-1:0]
            }),
            .first_start_word(first_start), .second_start_word(second_start)
        );
        assign walker_start = LANE ? second_start : first_start;
        reg running = 1'b0;
        always @(posedge clk) running <= 1'b1;
        always @* if (running) assert (late_load == {RECTANGLES{was_given}});
    end
    else assign walker_start = lane_start;
    wire [5*WALK_BITS-1:0] walker_walk;
    assign walk = {walker_walk[5*WALK_BITS-1 -: WALK_BITS], {WALK_BITS{1'b0}}, walker_walk[REST-1:0]};
    rect_walker walker (
        .clk(clk), .load(load), .step_way(step_way), .step_bounds(step_bounds), .start_word(walker_start),
        .growth_word({stride[FIELDS*STRIDE_BITS-1 -: STRIDE_BITS], stride[REST_STRIDE-1:0]}),
        .walk_word(walker_walk)
    );
    wire signed [SLOPE_BITS-1:0] y;
    slope_walker slope_dut (
        .clk(clk), .start_line(start_line), .step(step_slope), .aim_y(LANE_COLUMN), .slope_y(y)
    );
    always @* if (slope_valid) assert (y == $signed(slope[WIDE +: WIDE]));
endgenerate

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
