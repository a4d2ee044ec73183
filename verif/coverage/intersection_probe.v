// SPDX-License-Identifier: MIT
// Counts, in every ray unit of the seed engine, which kinds of intersection are offered to its z buffer. A frame's
// counts are written as a line "bin times bin times ..." each into the file bins.<unit> of the directory in which the
// simulation runs; bins are numbered as functional.py has its points, the last the fastest.

`timescale 1ns / 1ns

module intersection_probe #(
    parameter POSITION_BITS = 9
) (
    input wire clk,
    input wire first_group,         // of a frame
    input wire start_group,
    input wire find_intersection,
    input wire load_divider,
    input wire store_quotient,
    input wire write_z_buf,
    input wire add_colour,
    input wire [15:0] unit,
    input wire [1:0] axis,          // of what is offered
    input wire e_is_0,              // of what find_intersection starts on
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
    localparam BINS = 3 * 3 * 7 * 5 * 3;

    integer counts [0:BINS-1];
    integer file = 0;
    integer place;
    integer ray = 0;
    reg alive = 0;
    reg any = 0;
    reg [8*16-1:0] name;

    // Of a rectangle, from its start to its offer: slope in the first two bits, parallel, on plane, behind or ahead.
    wire [1:0] slope = e_is_0 ? 2'd1 : e_negative ? 2'd0 : 2'd2;
    wire [1:0] way = e_is_0 ? 2'd0 : plane == start ? 2'd1 : (plane < start) != e_negative ? 2'd2 : 2'd3;
    reg [3:0] started, loaded, stored;

    integer result, rank;

    task write_frame;
        begin
            if (any) begin
                if (file == 0) begin
                    $sformat(name, "bins.%0d", unit);
                    file = $fopen(name, "w");
                end
                for (place = 0; place < BINS; place = place + 1)
                    if (counts[place] != 0) $fwrite(file, "%0d %0d ", place, counts[place]);
                $fwrite(file, "\n");
            end
            for (place = 0; place < BINS; place = place + 1) counts[place] = 0;
            any = 0;
        end
    endtask

    initial write_frame;
    final write_frame;

    // All decide within the edge, so nothing is lost between them.
    always @(posedge clk) begin
        if (start_group) begin
            if (first_group) write_frame;
            ray = 0;
            alive = 1;
        end
        if (write_z_buf && alive) begin
            result = stored[1:0] != 3 ? {30'd0, stored[1:0]} : !valid ? 3 : !hit ? 4 : on_bound ? 5 : 6;
            rank = !hit ? 0 : !found ? 1 : depth < nearest ? 2 : depth == nearest ? 3 : 4;
            place = (((axis * 3 + {30'd0, stored[3:2]}) * 7 + result) * 5 + rank) * 3 + ray;
            counts[place] = counts[place] + 1;
            any = 1;
        end
        if (add_colour) begin
            alive = alive && found;
            ray = ray + 1;
        end
        if (find_intersection) started <= {slope, way};
        if (load_divider) loaded <= started;
        if (store_quotient) stored <= loaded;
    end
endmodule

bind ray_unit intersection_probe #(
    .POSITION_BITS($bits(depth))
) intersection_probe_i (
    .clk(clk),
    .first_group(place_row == 0 && place_column_offset == 0),
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
