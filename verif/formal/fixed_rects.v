// SPDX-License-Identifier: MIT
// A fixed scene's table against the general memory whose words are that scene's: every engine asks both for any
// rectangle at any time, and gets the same.
//
// Assumed of the memory is only that its words are the scene's, which is committed and goes live in every clock. Engines
// are the same modules behind either, so this is what a fixed scene changes.

module fixed_rects #(
    parameter INDEX_BITS = 2, parameter ADDRESS_BITS = 5, parameter RECT_BITS = 71, parameter LATENCY = 1,
    parameter [31:0] CORNER_0_0 = 0, parameter [31:0] CORNER_1_0 = 0, parameter [31:0] SURFACE_0 = 0,
    parameter [31:0] CORNER_0_1 = 0, parameter [31:0] CORNER_1_1 = 0, parameter [31:0] SURFACE_1 = 0,
    parameter [31:0] CORNER_0_2 = 0, parameter [31:0] CORNER_1_2 = 0, parameter [31:0] SURFACE_2 = 0
) (
    input clk, input reset, input [INDEX_BITS-1:0] index, input fetch, input [ADDRESS_BITS-1:0] address
);
wire [2:0] usable;
wire [RECT_BITS-1:0] rect, fixed_rect;
rect_mem memory (
    .clk(clk), .reset(reset), .readback(), .bad_rectangle(), .bus_write(1'b0), .bus_commit(1'b1), .bus_go_live(1'b1),
    .bus_address(address), .bus_data(32'b0), .bus_mask(32'b0), .rects_usable(usable), .rects_index(index),
    .rects_fetch(fetch), .rects_rect_word(rect)
);
rect_rom rom (.clk(clk), .rects_index(index), .rects_fetch(fetch), .rects_rect_word(fixed_rect));

// What the scene's words say; the live ones stay as they are, without a reset.
(* hierconn *) wire [31:0] \memory.rect_slot_0_i.live_corner_0 , \memory.rect_slot_0_i.live_corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_1_i.live_corner_0 , \memory.rect_slot_1_i.live_corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_2_i.live_corner_0 , \memory.rect_slot_2_i.live_corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_0_i.live_surface , \memory.rect_slot_1_i.live_surface ;
(* hierconn *) wire [31:0] \memory.rect_slot_2_i.live_surface ;
(* hierconn *) wire [31:0] \memory.rect_slot_0_i.corner_0 , \memory.rect_slot_0_i.corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_1_i.corner_0 , \memory.rect_slot_1_i.corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_2_i.corner_0 , \memory.rect_slot_2_i.corner_1 ;
(* hierconn *) wire [31:0] \memory.rect_slot_0_i.surface , \memory.rect_slot_1_i.surface , \memory.rect_slot_2_i.surface ;
reg committed = 0, started = 0, known = 0, held = 0;
always @(posedge clk) begin
    committed <= 1;
    started <= committed;
    held <= held || fetch;
    known <= LATENCY == 1 ? held || fetch : held;
end
always @* begin
    assume (!reset && index < 3);
    assume (\memory.rect_slot_0_i.live_corner_0 == CORNER_0_0 && \memory.rect_slot_0_i.live_corner_1 == CORNER_1_0 );
    assume (\memory.rect_slot_1_i.live_corner_0 == CORNER_0_1 && \memory.rect_slot_1_i.live_corner_1 == CORNER_1_1 );
    assume (\memory.rect_slot_2_i.live_corner_0 == CORNER_0_2 && \memory.rect_slot_2_i.live_corner_1 == CORNER_1_2 );
    assume (\memory.rect_slot_0_i.live_surface == SURFACE_0 && \memory.rect_slot_1_i.live_surface == SURFACE_1 );
    assume (\memory.rect_slot_2_i.live_surface == SURFACE_2 );
    assume (\memory.rect_slot_0_i.corner_0 == CORNER_0_0 && \memory.rect_slot_0_i.corner_1 == CORNER_1_0 );
    assume (\memory.rect_slot_1_i.corner_0 == CORNER_0_1 && \memory.rect_slot_1_i.corner_1 == CORNER_1_1 );
    assume (\memory.rect_slot_2_i.corner_0 == CORNER_0_2 && \memory.rect_slot_2_i.corner_1 == CORNER_1_2 );
    assume (\memory.rect_slot_0_i.surface == SURFACE_0 && \memory.rect_slot_1_i.surface == SURFACE_1 );
    assume (\memory.rect_slot_2_i.surface == SURFACE_2 );
end

always @* if (known) assert (fixed_rect == rect);
always @* if (started) assert (usable == 3'b111);

// Any of them, after any other.
reg [INDEX_BITS-1:0] before = 0;
always @(posedge clk) if (fetch) before <= index;
always @* cover (known && fetch && index == 2 && before == 0);
always @* cover (known && fetch && index == 0 && before == 2);
endmodule
