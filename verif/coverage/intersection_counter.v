// SPDX-License-Identifier: MIT
// Counts the kinds of intersection that a ray unit finds, as its engine's probe reports them. At the end, writes
// "bin times bin times ..." to the file bins.<unit> in the directory in which the simulation runs. Bins are numbered in
// the order of the points in functional.py; the last point varies fastest.

`timescale 1ns / 1ns

module intersection_counter #(
    parameter DEPTH_BITS = 9
) (
    input wire clk,
    input wire start_group,
    input wire offer,               // of a rectangle, described by the next inputs
    input wire [1:0] axis,
    input wire [1:0] slope,
    input wire [2:0] result,
    input wire hit,
    input wire [DEPTH_BITS-1:0] depth,      // of a hit, in any measure
    input wire [DEPTH_BITS-1:0] nearest,    // the nearest so far, in the same measure
    input wire add_colour,
    input wire found,               // anything was hit so far
    input wire [15:0] unit
);
    localparam BINS = 3 * 3 * 7 * 5 * 3;

    integer counts [0:BINS-1];
    integer file, place;
    integer ray = 0;
    reg alive = 0;
    wire [2:0] rank = !hit ? 3'd0 : !found ? 3'd1 : depth < nearest ? 3'd2 : depth == nearest ? 3'd3 : 3'd4;

    initial for (place = 0; place < BINS; place = place + 1) counts[place] = 0;

    final begin
        file = $fopen($sformatf("bins.%0d", unit), "w");
        for (place = 0; place < BINS; place = place + 1)
            if (counts[place] != 0) $fwrite(file, "%0d %0d ", place, counts[place]);
        $fwrite(file, "\n");
        $fclose(file);
    end

    // Blocking assignments: each statement sees the updates of the same clock edge.
    always @(posedge clk) begin
        if (start_group) begin
            ray = 0;
            alive = 1;
        end
        if (offer && alive) begin
            place = (((axis * 3 + {30'd0, slope}) * 7 + {29'd0, result}) * 5 + {29'd0, rank}) * 3 + ray;
            counts[place] = counts[place] + 1;
        end
        if (add_colour) begin
            alive = alive && found;
            ray = ray + 1;
        end
    end
endmodule
