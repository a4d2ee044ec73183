// SPDX-License-Identifier: MIT
// A fixed scene's table against the general memory whose words are that scene's: every engine asks both for any
// rectangle at any time, and gets the same.
//
// Assumed of the memory is only what its live words are. Engines are the same modules behind either, so this is what a
// fixed scene changes. A field of which all rectangles agree is no part of the table's word: its place is 99 then.

module fixed_rects #(
    parameter INDEX_BITS = 2, parameter ADDRESS_BITS = 5, parameter WORD_BITS = 71, parameter PIPELINED = 0,
    parameter [31:0] CORNER_0_0 = 0, parameter [31:0] CORNER_1_0 = 0, parameter [31:0] SURFACE_0 = 0,
    parameter [31:0] CORNER_0_1 = 0, parameter [31:0] CORNER_1_1 = 0, parameter [31:0] SURFACE_1 = 0,
    parameter [31:0] CORNER_0_2 = 0, parameter [31:0] CORNER_1_2 = 0, parameter [31:0] SURFACE_2 = 0,
    parameter AXIS_AT = 0, parameter AXIS_IS = 0, parameter POSITION_AT = 2, parameter POSITION_IS = 0,
    parameter U_LOW_AT = 11, parameter U_LOW_IS = 0, parameter U_HIGH_AT = 20, parameter U_HIGH_IS = 0,
    parameter V_LOW_AT = 29, parameter V_LOW_IS = 0, parameter V_HIGH_AT = 38, parameter V_HIGH_IS = 0,
    parameter COLOUR_AT = 47, parameter COLOUR_IS = 0
) (
    input clk, input reset, input [INDEX_BITS-1:0] index, input fetch, input [ADDRESS_BITS-1:0] address
);
localparam NOWHERE = 99;

wire [2:0] usable;
wire [1:0] axis;
wire [8:0] position, u_low, u_high, v_low, v_high;
wire [23:0] colour;
rect_mem memory (
    .clk(clk), .reset(reset), .read_word(), .bad_rectangle(), .bus_write(1'b0), .bus_commit(1'b0), .bus_go_live(1'b0),
    .bus_address(address), .bus_data(32'b0), .bus_mask(32'b0), .rects_usable(usable), .rects_index(index),
    .rects_fetch(fetch), .rects_rect_axis(axis), .rects_rect_position(position), .rects_rect_u_low(u_low),
    .rects_rect_u_high(u_high), .rects_rect_v_low(v_low), .rects_rect_v_high(v_high), .rects_rect_colour(colour)
);
wire [WORD_BITS-1:0] word;
rect_rom rom (.clk(clk), .index(index), .fetch(fetch), .word(word));

// What the scene's words say; the live ones stay as they are, without a reset.
(* hierconn *) wire [31:0] \memory.rect_slot_0_i.live_corner_0 , \memory.rect_slot_0_i.live_corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_1_i.live_corner_0 , \memory.rect_slot_1_i.live_corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_2_i.live_corner_0 , \memory.rect_slot_2_i.live_corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_0_i.live_surface , \memory.rect_slot_1_i.live_surface ;
(* hierconn *) wire [31:0] \memory.rect_slot_2_i.live_surface ;
reg started = 0, known = 0, held = 0;
always @(posedge clk) begin
    started <= 1;
    held <= held || fetch;
    known <= PIPELINED ? held : held || fetch;
end
always @* begin
    assume (!reset && index < 3);
    assume (\memory.rect_slot_0_i.live_corner_0 == CORNER_0_0 && \memory.rect_slot_0_i.live_corner_1 == CORNER_1_0 );
    assume (\memory.rect_slot_1_i.live_corner_0 == CORNER_0_1 && \memory.rect_slot_1_i.live_corner_1 == CORNER_1_1 );
    assume (\memory.rect_slot_2_i.live_corner_0 == CORNER_0_2 && \memory.rect_slot_2_i.live_corner_1 == CORNER_1_2 );
    assume (\memory.rect_slot_0_i.live_surface == SURFACE_0 && \memory.rect_slot_1_i.live_surface == SURFACE_1 );
    assume (\memory.rect_slot_2_i.live_surface == SURFACE_2 );
end

wire [WORD_BITS+NOWHERE+31:0] wide = word;
always @* if (known) begin
    assert (axis == (AXIS_AT == NOWHERE ? AXIS_IS : wide[AXIS_AT+:2]));
    assert (position == (POSITION_AT == NOWHERE ? POSITION_IS : wide[POSITION_AT+:9]));
    assert (u_low == (U_LOW_AT == NOWHERE ? U_LOW_IS : wide[U_LOW_AT+:9]));
    assert (u_high == (U_HIGH_AT == NOWHERE ? U_HIGH_IS : wide[U_HIGH_AT+:9]));
    assert (v_low == (V_LOW_AT == NOWHERE ? V_LOW_IS : wide[V_LOW_AT+:9]));
    assert (v_high == (V_HIGH_AT == NOWHERE ? V_HIGH_IS : wide[V_HIGH_AT+:9]));
    assert (colour == (COLOUR_AT == NOWHERE ? COLOUR_IS : wide[COLOUR_AT+:24]));
end
always @* if (started) assert (usable == 3'b111);

// Any of them, after any other.
reg [INDEX_BITS-1:0] before = 0;
always @(posedge clk) if (fetch) before <= index;
always @* cover (known && fetch && index == 2 && before == 0);
always @* cover (known && fetch && index == 0 && before == 2);
endmodule
