// SPDX-License-Identifier: MIT
// A pair of pins that sends two bits each cycle of shift_clk, first bits[0]. Its standard makes the other pin the inverse.

module ddr_pin (
    input  wire       shift_clk,
    input  wire [1:0] bits,
    output wire       wire_p,
    output wire       wire_n
);

assign wire_n = 1'b0;                   // no port: the pin file names one of the two

ODDRX1F pin (.SCLK(shift_clk), .RST(1'b0), .D0(bits[0]), .D1(bits[1]), .Q(wire_p));

endmodule
