// SPDX-License-Identifier: MIT
// A fixed scene's table compared with the general memory into which the scene's words were written: an engine may fetch
// any rectangle at any time, and gets the same from both.
//
// Assumed: only whole words of the scene are written, each in its place, at any time, in any order and any number of
// times. Commit and StartScreen are arbitrary, except that no commit comes in the cycle after a write, as is proved for
// the registers. One cycle of reset at first, which may come again. Behind either, an engine consists of the same
// modules, so this is all that a fixed scene changes.
//
// [proof]
// claim = "a fixed scene's table returns the same rectangles as a memory that holds the scene's words"
// modules = ["rect_mem", "rect_slot", "rect_sorter", "rect_rom"]
// as_registers = ["rect_mem"]
// induction = 3
// reach = 16
// label = "{ENGINE}, {'alike' if ALIKE else 'different'}"
// quick = ["alone=table engine=seed,beam ALIKE=0"]
// designs = ["alone=table engine=seed,beam ALIKE=1"]
// [faults]
// "seed, different" = ["rect_sorter.y_low as written_y_0 in 14", "rect_rom.rects_fetch 1 in 14"]

module fixed_rects #(
    parameter INDEX_BITS = 2, parameter ADDRESS_BITS = 5, parameter RECT_BITS = 71, parameter LATENCY = 1,
    parameter [31:0] CORNER_0_0 = 0, parameter [31:0] CORNER_1_0 = 0, parameter [31:0] SURFACE_0 = 0,
    parameter [31:0] CORNER_0_1 = 0, parameter [31:0] CORNER_1_1 = 0, parameter [31:0] SURFACE_1 = 0,
    parameter [31:0] CORNER_0_2 = 0, parameter [31:0] CORNER_1_2 = 0, parameter [31:0] SURFACE_2 = 0,
    parameter [31:0] CORNER_BITS = 0, parameter [31:0] SURFACE_BITS = 0
) (
    input clk, input reset, input [INDEX_BITS-1:0] index, input fetch,
    input write, input [1:0] slot, input [1:0] word, input commit, input go_live
);
localparam TABLE = 16;
localparam [95:0] KEPT = {CORNER_BITS, CORNER_BITS, SURFACE_BITS};  // the implemented bits
localparam [95:0] SCENE_0 = {CORNER_0_0, CORNER_1_0, SURFACE_0}, SCENE_1 = {CORNER_0_1, CORNER_1_1, SURFACE_1},
    SCENE_2 = {CORNER_0_2, CORNER_1_2, SURFACE_2};
wire [95:0] words = slot == 0 ? SCENE_0 : slot == 1 ? SCENE_1 : SCENE_2;
wire [31:0] data = word == 0 ? words[95:64] : word == 1 ? words[63:32] : words[31:0];
wire [ADDRESS_BITS-1:0] address = TABLE + {slot, word};
wire [2:0] usable;
wire [RECT_BITS-1:0] rect, fixed_rect;
rect_mem memory (
    .clk(clk), .reset(reset), .readback(), .bad_rectangle(), .bus_write(write), .bus_commit(commit),
    .bus_go_live(go_live), .bus_address(address), .bus_data(data), .bus_mask({32{1'b1}}), .rects_usable(usable),
    .rects_index(index), .rects_fetch(fetch), .rects_rect_word(rect)
);
rect_rom rom (.clk(clk), .rects_index(index), .rects_fetch(fetch), .rects_rect_word(fixed_rect));

reg running = 0, wrote = 0;
always @(posedge clk) begin
    running <= 1;
    wrote <= write;
end
always @* begin
    if (!running) assume (reset);
    assume (index < 3 && slot < 3 && word < 3);
    assume (!(commit && wrote));
end

// Words of each slot that are written, and slots whose copies are from the scene.
reg [2:0] written_0, written_1, written_2, pending, live;
wire [2:0] shadow = {&written_2, &written_1, &written_0};
always @(posedge clk) begin
    if (reset) {written_0, written_1, written_2, pending, live} <= 0;
    else begin
        if (write && slot == 0) written_0 <= written_0 | 3'b1 << word;
        if (write && slot == 1) written_1 <= written_1 | 3'b1 << word;
        if (write && slot == 2) written_2 <= written_2 | 3'b1 << word;
        if (commit) pending <= shadow;
        if (go_live) live <= pending;
    end
end

// True if the rectangle at the outputs was from the scene when it was fetched.
reg fetched = 0, held = 0;
always @(posedge clk) begin
    if (fetch) fetched <= live[index] && running;
    held <= fetched;
end
wire known = LATENCY == 1 ? fetched : held;
always @* if (known) assert (fixed_rect == rect);
always @* if (running) assert ((usable & live) == live);

// Invariants: the memory's contents, which are registers in this model.
(* hierconn *) wire [95:0] \memory.shadow_words[0] , \memory.shadow_words[1] , \memory.shadow_words[2] ;
(* hierconn *) wire [RECT_BITS-1:0] \memory.banks[0] , \memory.banks[1] , \memory.banks[2] , \memory.banks[4] ,
    \memory.banks[5] , \memory.banks[6] , \memory.banks[8] , \memory.banks[9] , \memory.banks[10] ;
(* hierconn *) wire [1:0] \memory.rect_slot_0_i.shadow , \memory.rect_slot_1_i.shadow , \memory.rect_slot_2_i.shadow ,
    \memory.rect_slot_0_i.pending , \memory.rect_slot_1_i.pending , \memory.rect_slot_2_i.pending ,
    \memory.rect_slot_0_i.live , \memory.rect_slot_1_i.live , \memory.rect_slot_2_i.live ;
(* hierconn *) wire [2:0] \memory.written ;
(* hierconn *) wire [1:0] \memory.latest_index ;
(* hierconn *) wire [95:0] \memory.latest_word ;
(* hierconn *) wire \memory.storing , \memory.rect_slot_0_i.shadow_usable , \memory.rect_slot_1_i.shadow_usable ,
    \memory.rect_slot_2_i.shadow_usable , \memory.rect_slot_0_i.pending_usable ,
    \memory.rect_slot_1_i.pending_usable , \memory.rect_slot_2_i.pending_usable ;
fixed_rects_slot #(RECT_BITS, SCENE_0, KEPT) slot_0 (
    running, wrote, \memory.storing && \memory.latest_index == 0, \memory.latest_word , written_0, shadow[0],
    pending[0], live[0], \memory.written [0], \memory.shadow_words[0] , \memory.banks[0] ,
    \memory.banks[4] , \memory.banks[8] , \memory.rect_slot_0_i.shadow , \memory.rect_slot_0_i.pending ,
    \memory.rect_slot_0_i.live , \memory.rect_slot_0_i.shadow_usable , \memory.rect_slot_0_i.pending_usable
);
fixed_rects_slot #(RECT_BITS, SCENE_1, KEPT) slot_1 (
    running, wrote, \memory.storing && \memory.latest_index == 1, \memory.latest_word , written_1, shadow[1],
    pending[1], live[1], \memory.written [1], \memory.shadow_words[1] , \memory.banks[1] ,
    \memory.banks[5] , \memory.banks[9] , \memory.rect_slot_1_i.shadow , \memory.rect_slot_1_i.pending ,
    \memory.rect_slot_1_i.live , \memory.rect_slot_1_i.shadow_usable , \memory.rect_slot_1_i.pending_usable
);
fixed_rects_slot #(RECT_BITS, SCENE_2, KEPT) slot_2 (
    running, wrote, \memory.storing && \memory.latest_index == 2, \memory.latest_word , written_2, shadow[2],
    pending[2], live[2], \memory.written [2], \memory.shadow_words[2] , \memory.banks[2] ,
    \memory.banks[6] , \memory.banks[10] , \memory.rect_slot_2_i.shadow , \memory.rect_slot_2_i.pending ,
    \memory.rect_slot_2_i.live , \memory.rect_slot_2_i.shadow_usable , \memory.rect_slot_2_i.pending_usable
);

// Covers fetches of one rectangle after another.
reg [INDEX_BITS-1:0] before = 0;
always @(posedge clk) if (fetch) before <= index;
always @* cover (known && fetch && index == 2 && before == 0);
always @* cover (known && fetch && index == 0 && before == 2);
endmodule

// One slot: its written words, and each copy that is from the scene, compared with the result of a second sorter.
module fixed_rects_slot #(parameter RECT_BITS = 71, parameter [95:0] SCENE = 0, parameter [95:0] KEPT = 0) (
    input running, input wrote, input storing, input [95:0] latest, input [2:0] words, input shadow, input pending,
    input live, input written, input [95:0] kept,
    input [RECT_BITS-1:0] place_0, input [RECT_BITS-1:0] place_1, input [RECT_BITS-1:0] place_2,
    input [1:0] at_shadow, input [1:0] at_pending, input [1:0] at_live, input shadow_usable, input pending_usable
);
wire [95:0] mask = {{32{words[0]}}, {32{words[1]}}, {32{words[2]}}};
wire [RECT_BITS-1:0] sorted;
rect_sorter sorter (.written_word(SCENE), .rect_word(sorted));
wire [2:0] right = {place_2 == sorted, place_1 == sorted, place_0 == sorted};
always @* if (running) begin
    assert (at_shadow < 3 && at_pending < 3 && at_live < 3);
    assert (written == (words != 0));
    if (written) assert (kept == (SCENE & KEPT & mask));
    if (storing) assert (wrote && latest == kept);
    else if (shadow) assert (right[at_shadow] && shadow_usable);
    if (pending) assert (right[at_pending] && pending_usable);
    if (live) assert (right[at_live]);
end
endmodule
