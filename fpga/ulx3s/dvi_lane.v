// SPDX-License-Identifier: MIT
// One wire of a DVI link: a symbol's ten bits in five cycles of shift_clk, bit 0 first. A module of its own in the
// netlist too, so that each wire keeps its own load register near it; one for all four would be far from most of them.

(* keep_hierarchy *)
module dvi_lane (
    input  wire       shift_clk,
    input  wire       fourth,           // of a pixel's five cycles
    input  wire [9:0] symbol,
    output wire       wire_p
);

reg       fifth = 1'b0;
reg       load = 1'b0;
reg [9:0] shift;
reg [1:0] leaving, pair;

// The symbol is taken in a pixel's first cycle; two registers have the way here to themselves.
always @(posedge shift_clk) begin
    fifth <= fourth;
    load <= fifth;
end

// Around rather than out, as what comes last is never sent, and a reset is slower than a table.
always @(posedge shift_clk)
    shift <= load ? symbol : {shift[1:0], shift[9:2]};

// The pin may be far from the rest, farther than a signal comes in a cycle.
always @(posedge shift_clk) begin
    leaving <= shift[1:0];
    pair <= leaving;
end

ODDRX1F pin (.SCLK(shift_clk), .RST(1'b0), .D0(pair[0]), .D1(pair[1]), .Q(wire_p));

endmodule
