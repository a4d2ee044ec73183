// SPDX-License-Identifier: MIT
// Differential pins of a link. Only link_p has pins; with their I/O standard, the other pin of a pair is the inverse.

module link_pins (
    input  wire [3:0] link,
    output wire [3:0] link_p,
    output wire [3:0] link_n            // not on pins
);

assign link_p = link;
assign link_n = 4'b0000;

endmodule
