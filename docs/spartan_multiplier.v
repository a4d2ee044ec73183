// SPDX-License-Identifier: MIT
// Spartan-3E multiplier as used by Racing the Beam: signed, with a registered product.

module MULT18X18SIO #(
    parameter AREG = 0,
    parameter BREG = 0,
    parameter PREG = 1,
    parameter B_INPUT = "DIRECT"
) (
    input CLK, input CEA, input CEB, input CEP, input RSTA, input RSTB, input RSTP, input signed [17:0] A,
    input signed [17:0] B, input signed [17:0] BCIN, output reg signed [35:0] P
);
always @(posedge CLK) if (RSTP) P <= 0; else if (CEP) P <= A * B;
endmodule
