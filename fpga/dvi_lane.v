// SPDX-License-Identifier: MIT
// One wire of a DVI link: sends a symbol's ten bits in five cycles of shift_clk, bit 0 first. Each wire detects the
// pixels itself, and stays a separate module in the netlist, because a signal cannot cross from wire to wire within a
// cycle. Two wires may detect a pixel one cycle apart. That is two bits, the skew of a fifth of a pixel that DVI 1.0
// allows.

(* keep_hierarchy *)
module dvi_lane (
    input  wire       clk,
    input  wire       shift_clk,
    input  wire       pixel,            // changes with the symbol, once a pixel
    input  wire [9:0] symbol,
    output wire       sent
);

localparam [4:0] WAITING = 5'b00000;    // before the first pixel
localparam [4:0] THIRD = 5'b01000;      // third cycle of a pixel, counted from its detection

reg [9:0] held = 10'b0000000000;
reg       held_pixel = 1'b0;
reg [2:0] seen = 3'b000;
reg       changed = 1'b0;
reg       restart = 1'b0;
reg [4:0] phase = WAITING;              // one-hot: cycle within the pixel
reg       load = 1'b0;
reg [9:0] shift;
reg [1:0] leaving, on_the_way, pair;

// Cross the chip here, while there is time: the registers of shift_clk then read only from nearby.
always @(posedge clk) begin
    held <= symbol;
    held_pixel <= pixel;
end

// Two registers synchronise pixel, and a third keeps its previous value.
always @(posedge shift_clk)
    seen <= {seen[1:0], held_pixel};

// A pixel one cycle early or late changes nothing, because symbols are stable for longer. A pixel at any other time, as
// after a reset, restarts the counting. Each step is one table and one register, to meet the clock.
always @(posedge shift_clk) begin
    changed <= seen[1] != seen[2];
    restart <= changed && !phase[0] && !phase[1] && !phase[2];
end

// Counts five cycles per pixel, from the first pixel on.
always @(posedge shift_clk)
    if (restart)
        phase <= THIRD;
    else
        phase <= {phase[3:0], phase[4]};

// The symbol is loaded in a pixel's first cycle.
always @(posedge shift_clk)
    load <= phase[4];

// Rotates instead of shifting in zeros: rotated bits are never sent, and zeros would need a reset, slower than a table.
always @(posedge shift_clk)
    shift <= load ? held : {shift[1:0], shift[9:2]};

// The path to the pin may be long too.
always @(posedge shift_clk) begin
    leaving <= shift[1:0];
    on_the_way <= leaving;
    pair <= on_the_way;
end

ddr_pin pin (.shift_clk(shift_clk), .bits(pair), .sent(sent));

endmodule
