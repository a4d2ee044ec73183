// SPDX-License-Identifier: MIT
// Sends the symbols of a DVI link on its wires: ten bits per pixel, two per cycle of shift_clk, which is five times the
// pixel clock. Wires 0 to 2 are blue, green and red; wire 3 is the link's clock, five ones and five zeros per pixel.
//
// The symbols come from another clock of the same PLL, of which only the pixel rate is assumed: they are stable for a
// pixel, five cycles here, and are loaded in the middle of it, two to three cycles after they changed. nextpnr checks
// no limit for paths between two clocks; raycaster.fpga.bitstream checks that these take less than a cycle. Pixels are
// detected once for all wires, so that all load a symbol in the same cycle.

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
localparam [4:0] WAITING = 5'b00000;    // before the first pixel
localparam [4:0] DETECTED = 5'b00001;

reg held_pixel = 1'b0;
reg arriving = 1'b0, arrived = 1'b0, previous = 1'b0;
reg changed = 1'b0, restart = 1'b0;
reg [4:0] phase = WAITING;              // one-hot: cycle within the pixel, counted from its detection
reg load = 1'b0;

// Changes with the symbols that the lanes hold.
always @(posedge clk)
    held_pixel <= pixel;

// Two registers synchronise the pixel, and a third keeps its previous value.
always @(posedge shift_clk) begin
    arriving <= held_pixel;
    arrived <= arriving;
    previous <= arrived;
end

// A pixel one cycle early or late changes nothing, because symbols are stable for longer. A pixel at any other time, as
// after a reset, restarts the counting. Each step is one table and one register, to meet the clock.
always @(posedge shift_clk) begin
    changed <= arrived != previous;
    restart <= changed && !phase[2] && !phase[3] && !phase[4];
end

// Counts five cycles per pixel, from the first pixel on.
always @(posedge shift_clk)
    if (restart)
        phase <= DETECTED;
    else
        phase <= {phase[3:0], phase[4]};

// A lane loads its symbol three cycles after this.
always @(posedge shift_clk)
    load <= phase[4];

dvi_lane blue_lane (.clk(clk), .shift_clk(shift_clk), .load(load), .symbol(blue), .sent(link[0]));
dvi_lane green_lane (.clk(clk), .shift_clk(shift_clk), .load(load), .symbol(green), .sent(link[1]));
dvi_lane red_lane (.clk(clk), .shift_clk(shift_clk), .load(load), .symbol(red), .sent(link[2]));
dvi_lane clock_lane (.clk(clk), .shift_clk(shift_clk), .load(load), .symbol(LINK_CLOCK), .sent(link[3]));

endmodule
