// SPDX-License-Identifier: MIT
// Records where the rays of every ray unit hit: a line "row column depth x y z" for each ray that hits something, in
// units of 2^-F, in the file hits.<unit> in the directory in which the simulation runs.

`timescale 1ns / 1ns

module hit_probe #(
    parameter UNITS = 1,
    parameter POSITION_BITS = 9
) (
    input wire clk,
    input wire initial_ray,         // the ray comes from the camera
    input wire add_colour,           // a ray ends: its result is valid in this cycle
    input wire found,
    input wire [15:0] row,
    input wire [15:0] unit,
    input wire [15:0] offset,
    input wire [3*POSITION_BITS-1:0] point
);
    wire [POSITION_BITS-1:0] x, y, z;
    assign {x, y, z} = point;

    integer file = 0;
    integer depth = 0;              // of the ray that ended last
    reg [8*16-1:0] name;

    // Blocking assignments: each statement sees the updates of the same clock edge.
    always @(posedge clk)
        if (add_colour) begin
            depth = initial_ray ? 0 : depth + 1;
            if (file == 0) begin
                $sformat(name, "hits.%0d", unit);
                file = $fopen(name, "w");
            end
            if (found)
                $fwrite(file, "%0d %0d %0d %0d %0d %0d\n", row, offset * UNITS + unit, depth, x, y, z);
        end
endmodule

bind ray_unit hit_probe #(
    .UNITS(`PROBED_UNITS),
    .POSITION_BITS($bits(found_point_word) / 3)
) hit_probe_i (
    .clk(clk),
    .initial_ray(steps_initial_ray),
    .add_colour(steps_add_colour),
    .found(found),
    .row(16'(place_row)),
    .unit(16'(column_base)),
    .offset(16'(place_column_offset)),
    .point(found_point_word)
);
