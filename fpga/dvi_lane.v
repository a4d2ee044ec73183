// SPDX-License-Identifier: MIT
// One wire of a DVI link: a symbol's ten bits in five cycles of shift_clk, bit 0 first. Each wire finds the pixels for
// itself, and is a module of its own in the netlist too: wires are far apart, farther than a signal comes in a cycle. Two
// of them may find a pixel a cycle apart, two bits: the fifth of a pixel that DVI 1.0 allows between a source's wires.

(* keep_hierarchy *)
module dvi_lane (
    input  wire       clk,
    input  wire       shift_clk,
    input  wire       pixel,            // changes with the symbol, once a pixel
    input  wire [9:0] symbol,
    output wire       sent
);

localparam [4:0] WAITING = 5'b00000;    // for the first pixel
localparam [4:0] THIRD = 5'b01000;      // of a pixel's cycles, from the one that knew of it on

reg [9:0] held = 10'b0000000000;
reg       held_pixel = 1'b0;
reg [2:0] seen = 3'b000;
reg       changed = 1'b0;
reg       restart = 1'b0;
reg [4:0] phase = WAITING;              // one bit is high, that of the cycle in the pixel
reg       load = 1'b0;
reg [9:0] shift;
reg [1:0] leaving, on_the_way, pair;

// From across the chip while there is time for it: from here on shift_clk sees nothing that is not near.
always @(posedge clk) begin
    held <= symbol;
    held_pixel <= pixel;
end

// Two registers bring pixel over, and one more remembers it.
always @(posedge shift_clk)
    seen <= {seen[1:0], held_pixel};

// A pixel that comes a cycle early or late changes nothing, as symbols hold still for longer; where one comes at quite
// another time, after a reset, counting starts with it. A table and a register each, for the clock's sake.
always @(posedge shift_clk) begin
    changed <= seen[1] != seen[2];
    restart <= changed && !phase[0] && !phase[1] && !phase[2];
end

// Five cycles a pixel, counted from the first.
always @(posedge shift_clk)
    if (restart)
        phase <= THIRD;
    else
        phase <= {phase[3:0], phase[4]};

// The symbol is taken in a pixel's first cycle.
always @(posedge shift_clk)
    load <= phase[4];

// Around rather than out, as what comes last is never sent, and a reset is slower than a table.
always @(posedge shift_clk)
    shift <= load ? held : {shift[1:0], shift[9:2]};

// The way to the pin may be long too.
always @(posedge shift_clk) begin
    leaving <= shift[1:0];
    on_the_way <= leaving;
    pair <= on_the_way;
end

ddr_pin pin (.shift_clk(shift_clk), .bits(pair), .sent(sent));

endmodule
