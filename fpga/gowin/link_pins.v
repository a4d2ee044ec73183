// SPDX-License-Identifier: MIT
// Differential pins of a link, with a buffer per pair.

module link_pins (
    input  wire [3:0] link,
    output wire [3:0] link_p,
    output wire [3:0] link_n
);

TLVDS_OBUF blue (.I(link[0]), .O(link_p[0]), .OB(link_n[0]));
TLVDS_OBUF green (.I(link[1]), .O(link_p[1]), .OB(link_n[1]));
TLVDS_OBUF red (.I(link[2]), .O(link_p[2]), .OB(link_n[2]));
TLVDS_OBUF clock (.I(link[3]), .O(link_p[3]), .OB(link_n[3]));

endmodule
