// SPDX-License-Identifier: MIT
// Sends two bits per cycle of shift_clk, bits[0] first.

module ddr_pin (
    input  wire       shift_clk,
    input  wire [1:0] bits,
    output wire       sent
);

ODDRX1F pin (.SCLK(shift_clk), .RST(1'b0), .D0(bits[0]), .D1(bits[1]), .Q(sent));

endmodule
