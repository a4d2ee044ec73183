// SPDX-License-Identifier: MIT
// Black box for a chip's multiplier, which Yosys would otherwise make of logic; its instances are only counted.

(* blackbox *)
module hard_multiplier #(
    parameter A_SIGNED = 0,
    parameter B_SIGNED = 0,
    parameter A_WIDTH = 9,
    parameter B_WIDTH = 9,
    parameter Y_WIDTH = 18
) (
    input wire [A_WIDTH-1:0] A,
    input wire [B_WIDTH-1:0] B,
    output wire [Y_WIDTH-1:0] Y
);
endmodule
