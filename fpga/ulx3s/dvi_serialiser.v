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
    output wire [3:0] gpdi_dp
);

localparam [9:0] LINK_CLOCK = 10'b0000011111;
localparam [2:0] WAITING = 3'd7;        // for the first pixel

reg  [2:0] seen = 3'b000;
wire       changed = seen[1] != seen[2];
reg  [2:0] phase = WAITING;
wire       expected = phase == 3'd4 || phase == 3'd0 || phase == 3'd1;
reg  [9:0] shift_blue, shift_green, shift_red, shift_clock;

// Two registers bring pixel over, and one more remembers it.
always @(posedge shift_clk)
    seen <= {seen[1:0], pixel};

// Five cycles a pixel, counted from the first; one that comes a cycle early or late changes nothing, as symbols hold still
// for longer, and where one comes at quite another time, after a reset, counting starts with it.
always @(posedge shift_clk)
    if (changed && !expected)
        phase <= 3'd1;
    else if (phase == 3'd4)
        phase <= 3'd0;
    else if (phase != WAITING)
        phase <= phase + 3'd1;

// Bit 0 first.
always @(posedge shift_clk)
    if (phase == 3'd0) begin
        shift_blue <= blue;
        shift_green <= green;
        shift_red <= red;
        shift_clock <= LINK_CLOCK;
    end
    else begin
        shift_blue <= {2'b00, shift_blue[9:2]};
        shift_green <= {2'b00, shift_green[9:2]};
        shift_red <= {2'b00, shift_red[9:2]};
        shift_clock <= {2'b00, shift_clock[9:2]};
    end

ODDRX1F blue_pin (.SCLK(shift_clk), .RST(1'b0), .D0(shift_blue[0]), .D1(shift_blue[1]), .Q(gpdi_dp[0]));
ODDRX1F green_pin (.SCLK(shift_clk), .RST(1'b0), .D0(shift_green[0]), .D1(shift_green[1]), .Q(gpdi_dp[1]));
ODDRX1F red_pin (.SCLK(shift_clk), .RST(1'b0), .D0(shift_red[0]), .D1(shift_red[1]), .Q(gpdi_dp[2]));
ODDRX1F clock_pin (.SCLK(shift_clk), .RST(1'b0), .D0(shift_clock[0]), .D1(shift_clock[1]), .Q(gpdi_dp[3]));

endmodule
