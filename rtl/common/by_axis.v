// SPDX-License-Identifier: MIT
// Selects by the axis of a rectangle's plane: on_x, on_y or on_z for axis 0, 1 or 2.

`timescale 1ns/10ps

module by_axis #(
    parameter width = 1
) (
    input  wire [1:0] axis,
    input  wire [width-1:0] on_x,
    input  wire [width-1:0] on_y,
    input  wire [width-1:0] on_z,
    output wire [width-1:0] chosen
);

assign chosen = axis == 0 ? on_x : axis == 1 ? on_y : on_z;

endmodule
