// SPDX-License-Identifier: MIT
// Counts the kinds of intersection that the beam engine's passes find, for rays of a camera that does not turn. Within
// a pass, rectangles with lower indices count as found earlier. The counts are written like those of
// intersection_counter.v.

`timescale 1ns / 1ns

// In a tester, following its stages: the kind of intersection of a ray with its rectangle, in the cycle of its report.
module tester_probe #(
    parameter NUMERATOR_BITS = 11,
    parameter SLOPE_BITS = 8
) (
    input wire clk,
    input wire step_way, step_bounds, step_slope,
    input wire usable,
    input wire [1:0] axis,
    input wire back,                // at step_way: the folded ray runs towards lower coordinates
    input wire at_plane, under_plane,       // at step_bounds: where the ray starts
    input wire on_bound,
    input wire in_bounds, hit,      // at step_slope
    input wire [NUMERATOR_BITS-1:0] numerator,
    input wire [SLOPE_BITS-1:0] e,
    output reg [NUMERATOR_BITS+SLOPE_BITS+8:0] found
);
    reg back_1, back_2, at_plane_2, behind_2, on_bound_2;
    wire [1:0] slope = e == 0 ? 2'd1 : back_2 ? 2'd0 : 2'd2;
    wire [2:0] result = e == 0 ? 3'd0 : at_plane_2 ? 3'd1 : behind_2 ? 3'd2 : !in_bounds ? 3'd4 : !hit ? 3'd3
        : on_bound_2 ? 3'd5 : 3'd6;
    always @(posedge clk) begin
        if (step_way) back_1 <= back;
        if (step_bounds) begin
            back_2 <= back_1;
            at_plane_2 <= at_plane;
            behind_2 <= under_plane == back_1;
            on_bound_2 <= on_bound;
        end
        if (step_slope) found <= {usable, axis, slope, result, hit, numerator, e};
    end
endmodule

bind ray_tester tester_probe #(
    .NUMERATOR_BITS($bits(numerator)),
    .SLOPE_BITS($bits(e))
) probe_i (
    .clk(clk),
    .step_way(step_way),
    .step_bounds(step_bounds),
    .step_slope(step_slope),
    .usable(facet_usable),
    .axis(facet_axis),
    .back(back),
    .at_plane(facet_distance == 0),
    .under_plane(facet_distance > 0),
    .on_bound(walk_way_p == walk_low_p || walk_way_p == walk_high_p
        || facet_way_q == walk_low_q || facet_way_q == walk_high_q),
    .in_bounds(inside_p && inside_q),
    .hit(valid),
    .numerator(numerator),
    .e(e)
);

bind fold_tester tester_probe #(
    .NUMERATOR_BITS($bits(numerator_2)),
    .SLOPE_BITS($bits(e))
) probe_i (
    .clk(clk),
    .step_way(step_way),
    .step_bounds(step_bounds),
    .step_slope(step_slope),
    .usable(facet_usable),
    .axis(facet_axis),
    .back(back != turned),
    .at_plane(distance_1 == 0),
    .under_plane(distance_1 > 0),
    .on_bound(folded_p_1 == walk_low_p || folded_p_1 == walk_high_p
        || folded_q_1 == walk_low_q || folded_q_1 == walk_high_q),
    .in_bounds(inside_p && inside_q),
    .hit(valid),
    .numerator(numerator_2),
    .e(e)
);

// In a lane, with three passes and twelve rectangles: which of these rays exist, and how their hits rank.
module pass_probe #(
    parameter NUMERATOR_BITS = 11,
    parameter SLOPE_BITS = 8,
    parameter WORD_BITS = NUMERATOR_BITS + SLOPE_BITS + 9
) (
    input wire clk,
    input wire in_picture,          // the column is shown; the other columns of a line are don't care
    input wire [2:0] reports,       // one per pass, at step_slope
    input wire [2:0] reflections,
    input wire [12*WORD_BITS-1:0] found_0, found_1, found_2
);
    localparam BINS = 3 * 3 * 7 * 5 * 3, PRODUCT_BITS = NUMERATOR_BITS + SLOPE_BITS;

    integer counts [0:BINS-1];
    integer file, place, index;
    reg [2:0] reported = 0;
    // For columns that one pass has reported and the next one has not: whether there is a ray.
    bit reflected [$], reflected_twice [$];
    bit there, met;

    reg usable, hit;
    reg [1:0] axis, slope;
    reg [2:0] result, rank;
    reg [NUMERATOR_BITS-1:0] numerator, nearest_numerator;
    reg [SLOPE_BITS-1:0] e, nearest_e;
    reg [PRODUCT_BITS-1:0] product, nearest_product;

    task count(input [12*WORD_BITS-1:0] found, input integer ray);
        begin
            met = 0;
            for (index = 0; index < 12; index = index + 1) begin
                {usable, axis, slope, result, hit, numerator, e} = found[index*WORD_BITS +: WORD_BITS];
                product = numerator * nearest_e;
                nearest_product = nearest_numerator * e;
                rank = !hit ? 3'd0 : !met ? 3'd1 : product < nearest_product ? 3'd2 : product == nearest_product ? 3'd3
                    : 3'd4;
                if (rank == 1 || rank == 2) begin
                    met = 1;
                    nearest_numerator = numerator;
                    nearest_e = e;
                end
                if (usable && there) begin
                    place = (((axis * 3 + {30'd0, slope}) * 7 + {29'd0, result}) * 5 + {29'd0, rank}) * 3 + ray;
                    counts[place] = counts[place] + 1;
                end
            end
        end
    endtask

    initial for (place = 0; place < BINS; place = place + 1) counts[place] = 0;

    // Columns that are in flight at a reset are never reported.
    always @(posedge clk) begin
        reported <= reports;
        if (reported[2]) begin
            there = reflected_twice.size() != 0 && reflected_twice.pop_front();
            count(found_2, 2);
        end
        if (reported[1]) begin
            there = reflected.size() != 0 && reflected.pop_front();
            count(found_1, 1);
            reflected_twice.push_back(there && met && reflections > 1);
        end
        if (reported[0]) begin
            there = in_picture;
            count(found_0, 0);
            reflected.push_back(there && met && reflections > 0);
        end
    end

    final begin
        file = $fopen("bins.beam", "w");
        for (place = 0; place < BINS; place = place + 1)
            if (counts[place] != 0) $fwrite(file, "%0d %0d ", place, counts[place]);
        $fwrite(file, "\n");
        $fclose(file);
    end
endmodule

bind beam_lane pass_probe #(
    // folds_1_image holds six flags and one numerator-wide turn for each of the three axes.
    .NUMERATOR_BITS(($bits(folds_1_image) - 6) / 3),
    .SLOPE_BITS($bits(late_slopes_0_y) - 1)
) pass_probe_i (
    .clk(clk),
    .in_picture(beam_renderer.in_picture),
    .reports({beam_pass_2_i.step_slope, beam_pass_1_i.step_slope, beam_pass_0_i.step_slope}),
    .reflections(picture_reflections),
    .found_0({
        beam_pass_0_i.ray_tester_11_i.probe_i.found, beam_pass_0_i.ray_tester_10_i.probe_i.found,
        beam_pass_0_i.ray_tester_9_i.probe_i.found, beam_pass_0_i.ray_tester_8_i.probe_i.found,
        beam_pass_0_i.ray_tester_7_i.probe_i.found, beam_pass_0_i.ray_tester_6_i.probe_i.found,
        beam_pass_0_i.ray_tester_5_i.probe_i.found, beam_pass_0_i.ray_tester_4_i.probe_i.found,
        beam_pass_0_i.ray_tester_3_i.probe_i.found, beam_pass_0_i.ray_tester_2_i.probe_i.found,
        beam_pass_0_i.ray_tester_1_i.probe_i.found, beam_pass_0_i.ray_tester_0_i.probe_i.found
    }),
    .found_1({
        beam_pass_1_i.fold_tester_11_i.probe_i.found, beam_pass_1_i.fold_tester_10_i.probe_i.found,
        beam_pass_1_i.fold_tester_9_i.probe_i.found, beam_pass_1_i.fold_tester_8_i.probe_i.found,
        beam_pass_1_i.fold_tester_7_i.probe_i.found, beam_pass_1_i.fold_tester_6_i.probe_i.found,
        beam_pass_1_i.fold_tester_5_i.probe_i.found, beam_pass_1_i.fold_tester_4_i.probe_i.found,
        beam_pass_1_i.fold_tester_3_i.probe_i.found, beam_pass_1_i.fold_tester_2_i.probe_i.found,
        beam_pass_1_i.fold_tester_1_i.probe_i.found, beam_pass_1_i.fold_tester_0_i.probe_i.found
    }),
    .found_2({
        beam_pass_2_i.fold_tester_11_i.probe_i.found, beam_pass_2_i.fold_tester_10_i.probe_i.found,
        beam_pass_2_i.fold_tester_9_i.probe_i.found, beam_pass_2_i.fold_tester_8_i.probe_i.found,
        beam_pass_2_i.fold_tester_7_i.probe_i.found, beam_pass_2_i.fold_tester_6_i.probe_i.found,
        beam_pass_2_i.fold_tester_5_i.probe_i.found, beam_pass_2_i.fold_tester_4_i.probe_i.found,
        beam_pass_2_i.fold_tester_3_i.probe_i.found, beam_pass_2_i.fold_tester_2_i.probe_i.found,
        beam_pass_2_i.fold_tester_1_i.probe_i.found, beam_pass_2_i.fold_tester_0_i.probe_i.found
    })
);
