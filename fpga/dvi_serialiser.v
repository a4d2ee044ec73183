// SPDX-License-Identifier: MIT
// The symbols of a DVI link onto its wires: ten bits a pixel, two each cycle of shift_clk, which is five times the pixel
// clock. Wires 0 to 2 are blue, green and red; wire 3 is the link's clock, five ones and five zeros a pixel.
//
// The symbols come from another clock of the same PLL, which nothing is assumed of but the pixel's rate: they are stable
// for a pixel, five cycles here, and are taken in the middle of it, two to three cycles after they changed. nextpnr holds
// no path between two clocks against anything; raycaster.fpga.bitstream sees that these take less than a cycle.

module dvi_serialiser (
    input  wire       shift_clk,
    input  wire [9:0] blue,
    input  wire [9:0] green,
    input  wire [9:0] red,
    input  wire       pixel,            // changes with the symbols, once a pixel
    output wire [3:0] link
);

localparam [9:0] LINK_CLOCK = 10'b0000011111;
localparam [4:0] WAITING = 5'b00000;    // for the first pixel
localparam [4:0] THIRD = 5'b01000;      // of a pixel's cycles, from the one that knew of it on

reg  [2:0] seen = 3'b000;
reg        changed = 1'b0;
reg        restart = 1'b0;
reg  [4:0] leaving = 5'b00000;
reg  [4:0] phase = WAITING;             // one bit is high, that of the cycle in the pixel

// Two registers bring pixel over, and one more remembers it.
always @(posedge shift_clk)
    seen <= {seen[1:0], pixel};

// A pixel that comes a cycle early or late changes nothing, as symbols hold still for longer; where one comes at quite
// another time, after a reset, counting starts with it. A table and a register each, for the clock's sake.
always @(posedge shift_clk) begin
    changed <= seen[1] != seen[2];
    restart <= changed && !phase[0] && !phase[1] && !phase[2];
end

// The wires are across the chip. A whole pixel later they count alike, and a register for each cycle of it leaves each of
// them but a part of the way.
always @(posedge shift_clk)
    leaving <= {leaving[3:0], restart};

// Five cycles a pixel, counted from the first.
always @(posedge shift_clk)
    if (restart)
        phase <= THIRD;
    else
        phase <= {phase[3:0], phase[4]};

dvi_lane blue_lane (.shift_clk(shift_clk), .restart(leaving[4]), .symbol(blue), .sent(link[0]));
dvi_lane green_lane (.shift_clk(shift_clk), .restart(leaving[4]), .symbol(green), .sent(link[1]));
dvi_lane red_lane (.shift_clk(shift_clk), .restart(leaving[4]), .symbol(red), .sent(link[2]));
dvi_lane clock_lane (.shift_clk(shift_clk), .restart(leaving[4]), .symbol(LINK_CLOCK), .sent(link[3]));

endmodule
