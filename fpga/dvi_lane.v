// SPDX-License-Identifier: MIT
// One wire of a DVI link: a symbol's ten bits in five cycles of shift_clk, bit 0 first. Each wire counts for itself, and
// is a module of its own in the netlist too: wires are far apart, farther than a signal comes in a cycle.

(* keep_hierarchy *)
module dvi_lane (
    input  wire       shift_clk,
    input  wire       restart,          // counting starts with the third cycle of a pixel
    input  wire [9:0] symbol,
    output wire       sent
);

localparam [4:0] THIRD = 5'b01000;

reg [4:0] arriving = 5'b00000;
reg [4:0] phase = 5'b00000;
reg       load = 1'b0;
reg [9:0] shift;
reg [1:0] leaving, pair;

// The way here may take five cycles, which are a pixel, so that it is the third one again.
always @(posedge shift_clk)
    arriving <= {arriving[3:0], restart};

// Five cycles a pixel; one bit is high, that of the cycle.
always @(posedge shift_clk)
    if (arriving[4])
        phase <= THIRD;
    else
        phase <= {phase[3:0], phase[4]};

// The symbol is taken in a pixel's first cycle.
always @(posedge shift_clk)
    load <= phase[4];

// Around rather than out, as what comes last is never sent, and a reset is slower than a table.
always @(posedge shift_clk)
    shift <= load ? symbol : {shift[1:0], shift[9:2]};

// The way to the pin may be long too.
always @(posedge shift_clk) begin
    leaving <= shift[1:0];
    pair <= leaving;
end

ddr_pin pin (.shift_clk(shift_clk), .bits(pair), .sent(sent));

endmodule
