// SPDX-License-Identifier: MIT
// A link's pairs of pins: the standard of the one that has a port makes the other its inverse.

module link_pins (
    input  wire [3:0] link,
    output wire [3:0] link_p,
    output wire [3:0] link_n            // no pins
);

assign link_p = link;
assign link_n = 4'b0000;

endmodule
