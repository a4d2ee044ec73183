// SPDX-License-Identifier: MIT
// One wire of a DVI link: sends a symbol's ten bits in five cycles of shift_clk, bit 0 first. Each wire stays a separate
// module in the netlist: it has its own copies of load, on the way to its pin, which would otherwise be merged.

(* keep_hierarchy *)
module dvi_lane (
    input  wire       clk,
    input  wire       shift_clk,
    input  wire       load,             // once per pixel; the symbol is read three cycles later
    input  wire [9:0] symbol,
    output wire       sent
);

reg [9:0] held = 10'b0000000000;
reg       load_on_the_way = 1'b0, load_here = 1'b0;
reg [9:0] shift;
reg [1:0] leaving, on_the_way, pair;

// Cross the chip here, while there is time: the registers of shift_clk then read only from nearby.
always @(posedge clk)
    held <= symbol;

// A signal cannot cross from the detection of pixels to every wire within a cycle.
always @(posedge shift_clk) begin
    load_on_the_way <= load;
    load_here <= load_on_the_way;
end

// Rotates instead of shifting in zeros: rotated bits are never sent, and zeros would need a reset, slower than a table.
always @(posedge shift_clk)
    shift <= load_here ? held : {shift[1:0], shift[9:2]};

// The path to the pin may be long too.
always @(posedge shift_clk) begin
    leaving <= shift[1:0];
    on_the_way <= leaving;
    pair <= on_the_way;
end

ddr_pin pin (.shift_clk(shift_clk), .bits(pair), .sent(sent));

endmodule
