// SPDX-License-Identifier: MIT
// Reports, in every unit of the exact engine, the kinds of intersection that are offered to its nearest hit.

`timescale 1ns / 1ns

module intersection_probe #(
    parameter EYE_BITS = 11,
    parameter SLOPE_BITS = 8,
    parameter PRODUCT_BITS = EYE_BITS + SLOPE_BITS
) (
    input wire clk,
    input wire start_group,
    input wire find_intersection,
    input wire write_z_buf,
    input wire add_colour,
    input wire [15:0] unit,
    input wire [1:0] axis,          // from here on: of the rectangle that find_intersection starts
    input wire back,                // the ray runs towards lower coordinates
    input wire signed [EYE_BITS+1:0] n, to_near_u, to_far_u, to_near_v, to_far_v,
    input wire [SLOPE_BITS-1:0] e, slope_u, slope_v,
    input wire hit,
    input wire found,
    input wire [PRODUCT_BITS-1:0] offered_product,
    input wire [PRODUCT_BITS-1:0] nearest_product
);
    // Without clipping at a mirror: whether the ray is within the bounds, or exactly on one.
    wire signed [PRODUCT_BITS+3:0] wide_e = $signed({1'b0, e});
    wire signed [PRODUCT_BITS+3:0] way_u = n * $signed({1'b0, slope_u}), way_v = n * $signed({1'b0, slope_v});
    wire signed [PRODUCT_BITS+3:0] near_u = to_near_u * wide_e, far_u = to_far_u * wide_e;
    wire signed [PRODUCT_BITS+3:0] near_v = to_near_v * wide_e, far_v = to_far_v * wide_e;
    wire in_bounds = near_u <= way_u && way_u <= far_u && near_v <= way_v && way_v <= far_v;
    wire on_bound = near_u == way_u || way_u == far_u || near_v == way_v || way_v == far_v;

    // From a rectangle's start to its offer: axis, slope and result (parallel, on plane, behind, miss, edge or hit).
    wire [1:0] slope = e == 0 ? 2'd1 : back ? 2'd0 : 2'd2;
    wire [2:0] way = e == 0 ? 3'd0 : n == 0 ? 3'd1 : n < 0 ? 3'd2 : !in_bounds ? 3'd4 : on_bound ? 3'd5 : 3'd6;
    reg [6:0] started, multiplied, compared;
    always @(posedge clk) begin
        if (find_intersection) started <= {axis, slope, way};
        multiplied <= started;
        compared <= multiplied;
    end

    intersection_counter #(.DEPTH_BITS(PRODUCT_BITS)) counter (
        .clk(clk),
        .start_group(start_group),
        .offer(write_z_buf),
        .axis(compared[6:5]),
        .slope(compared[4:3]),
        .result(compared[2:0] > 4 && !hit ? 3'd3 : compared[2:0]),
        .hit(hit),
        .depth(offered_product),
        .nearest(nearest_product),
        .add_colour(add_colour),
        .found(found),
        .unit(unit)
    );
endmodule

bind exact_unit intersection_probe #(
    .EYE_BITS($bits(numerator)),
    .SLOPE_BITS($bits(denominator))
) intersection_probe_i (
    .clk(clk),
    .start_group(steps_screen_to_ray),
    .find_intersection(steps_find_intersection),
    .write_z_buf(steps_write_z_buf),
    .add_colour(steps_add_colour),
    .unit(16'(column_base)),
    .axis(rect_tester_i.rect_axis),
    .back(rect_tester_i.back),
    .n(rect_tester_i.n),
    .to_near_u(rect_tester_i.extent_tester_0_i.to_near),
    .to_far_u(rect_tester_i.extent_tester_0_i.to_far),
    .to_near_v(rect_tester_i.extent_tester_1_i.to_near),
    .to_far_v(rect_tester_i.extent_tester_1_i.to_far),
    .e(rect_tester_i.e),
    .slope_u(rect_tester_i.slope_u),
    .slope_v(rect_tester_i.slope_v),
    .hit(hit),
    .found(found),
    .offered_product(nearest_hit_i.offered_product),
    .nearest_product(nearest_hit_i.nearest_product)
);
