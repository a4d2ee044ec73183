// SPDX-License-Identifier: MIT
// Reports, in every ray unit of the seed engine, the kinds of intersection that are offered to its z buffer.

`timescale 1ns / 1ns

module intersection_probe #(
    parameter POSITION_BITS = 9
) (
    input wire clk,
    input wire start_group,
    input wire find_intersection,
    input wire load_divider,
    input wire store_quotient,
    input wire write_z_buf,
    input wire add_colour,
    input wire [15:0] unit,
    input wire [1:0] axis,          // of the rectangle that is offered
    input wire e_is_0,              // from here on: of the rectangle that find_intersection starts
    input wire e_negative,
    input wire [POSITION_BITS-1:0] plane,
    input wire [POSITION_BITS-1:0] start,
    input wire valid,
    input wire on_bound,
    input wire hit,
    input wire found,
    input wire [POSITION_BITS-1:0] depth,
    input wire [POSITION_BITS-1:0] nearest
);
    // From a rectangle's start to its offer: slope in the upper two bits, then parallel, on plane, behind or ahead.
    wire [1:0] slope = e_is_0 ? 2'd1 : e_negative ? 2'd0 : 2'd2;
    wire [1:0] way = e_is_0 ? 2'd0 : plane == start ? 2'd1 : (plane < start) != e_negative ? 2'd2 : 2'd3;
    reg [3:0] started, loaded, stored;
    always @(posedge clk) begin
        if (find_intersection) started <= {slope, way};
        if (load_divider) loaded <= started;
        if (store_quotient) stored <= loaded;
    end

    intersection_counter #(.DEPTH_BITS(POSITION_BITS)) counter (
        .clk(clk),
        .start_group(start_group),
        .offer(write_z_buf),
        .axis(axis),
        .slope(stored[3:2]),
        .result(stored[1:0] != 3 ? {1'b0, stored[1:0]} : !valid ? 3'd3 : !hit ? 3'd4 : on_bound ? 3'd5 : 3'd6),
        .hit(hit),
        .depth(depth),
        .nearest(nearest),
        .add_colour(add_colour),
        .found(found),
        .unit(unit)
    );
endmodule

bind ray_unit intersection_probe #(
    .POSITION_BITS($bits(depth))
) intersection_probe_i (
    .clk(clk),
    .start_group(steps_screen_to_ray),
    .find_intersection(steps_find_intersection),
    .load_divider(steps_load_divider),
    .store_quotient(steps_store_quotient),
    .write_z_buf(steps_write_z_buf),
    .add_colour(steps_add_colour),
    .unit(16'(column_base)),
    .axis(intersection_finder_i.offered_axis),
    .e_is_0(intersection_finder_i.e_slope == 0),
    .e_negative(intersection_finder_i.e_negative),
    .plane(intersection_finder_i.plane_start),
    .start(intersection_finder_i.start_a),
    .valid(intersection_finder_i.u_valid && intersection_finder_i.v_valid),
    .on_bound(
        intersection_finder_i.u_value == $signed({2'b0, intersection_finder_i.u_low})
        || intersection_finder_i.u_value == $signed({2'b0, intersection_finder_i.u_high})
        || intersection_finder_i.v_value == $signed({2'b0, intersection_finder_i.v_low})
        || intersection_finder_i.v_value == $signed({2'b0, intersection_finder_i.v_high})
    ),
    .hit(hit),
    .found(found),
    .depth(depth),
    .nearest(z_buffer_i.nearest)
);
