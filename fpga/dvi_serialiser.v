// SPDX-License-Identifier: MIT
// Sends the symbols of a DVI link on its wires: ten bits per pixel, two per cycle of shift_clk, which is five times the
// pixel clock. Wires 0 to 2 are blue, green and red; wire 3 is the link's clock, five ones and five zeros per pixel.
//
// The symbols come from another clock of the same PLL, of which only the pixel rate is assumed: they are stable for a
// pixel, five cycles here, and are loaded in the middle of it, two to three cycles after they changed. nextpnr checks
// no limit for paths between two clocks; raycaster.fpga.bitstream checks that these take less than a cycle.

module dvi_serialiser (
    input  wire       clk,              // clock of the symbols
    input  wire       shift_clk,
    input  wire [9:0] blue,
    input  wire [9:0] green,
    input  wire [9:0] red,
    input  wire       pixel,            // changes with the symbols, once a pixel
    output wire [3:0] link
);

localparam [9:0] LINK_CLOCK = 10'b0000011111;

dvi_lane blue_lane (.clk(clk), .shift_clk(shift_clk), .pixel(pixel), .symbol(blue), .sent(link[0]));
dvi_lane green_lane (.clk(clk), .shift_clk(shift_clk), .pixel(pixel), .symbol(green), .sent(link[1]));
dvi_lane red_lane (.clk(clk), .shift_clk(shift_clk), .pixel(pixel), .symbol(red), .sent(link[2]));
dvi_lane clock_lane (.clk(clk), .shift_clk(shift_clk), .pixel(pixel), .symbol(LINK_CLOCK), .sent(link[3]));

endmodule
