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
// quick = ["alone=table engine=seed ALIKE=0"]
// designs = ["alone=table engine=seed ALIKE=1"]
// [faults]
// "seed, different" = ["rect_sorter.y_low as written_y_0 in 14", "rect_rom.rects_fetch 1 in 14"]

module fixed_rects;
localparam TABLE = 16;
localparam [95:0] KEPT = {CORNER_BITS, CORNER_BITS, SURFACE_BITS};  // the implemented bits
localparam [95:0] SCENE_0 = {CORNER_0_0, CORNER_1_0, SURFACE_0}, SCENE_1 = {CORNER_0_1, CORNER_1_1, SURFACE_1},
    SCENE_2 = {CORNER_0_2, CORNER_1_2, SURFACE_2};
(* anyseq *) reg [1:0] next_slot, next_word;
reg [1:0] slot, word;
reg accessed = 0;
always @(posedge clk) begin
    accessed <= bus_access;
    if (bus_access) {slot, word} <= {next_slot, next_word};
end
wire [95:0] words = slot == 0 ? SCENE_0 : slot == 1 ? SCENE_1 : SCENE_2;
assign bus_data = word == 0 ? words[95:64] : word == 1 ? words[63:32] : words[31:0];
assign bus_address = TABLE + {slot, word};
assign bus_next_address = TABLE + {next_slot, next_word};
assign bus_mask = {32{1'b1}};
rect_mem memory (.*);
wire [RECT_BITS-1:0] fixed_rect;
rect_rom rom (.*, .rects_rect_word(fixed_rect));

reg wrote = 0;
always @(posedge clk) wrote <= bus_write;
always @* begin
    assume (rects_index < 3 && next_slot < 3 && next_word < 3);
    assume (!bus_write || accessed);
    assume (!(bus_commit && wrote));
end

// Words of each slot that are written, and slots whose copies are from the scene.
reg [2:0] written_0, written_1, written_2, pending, live;
wire [2:0] shadow = {&written_2, &written_1, &written_0};
always @(posedge clk) begin
    if (reset) {written_0, written_1, written_2, pending, live} <= 0;
    else begin
        if (bus_write && slot == 0) written_0 <= written_0 | 3'b1 << word;
        if (bus_write && slot == 1) written_1 <= written_1 | 3'b1 << word;
        if (bus_write && slot == 2) written_2 <= written_2 | 3'b1 << word;
        if (bus_commit) pending <= shadow;
        if (bus_go_live) live <= pending;
    end
end

// True if the rectangle at the outputs was from the scene when it was fetched.
reg fetched = 0;
always @(posedge clk) if (rects_fetch) fetched <= live[rects_index] && known;
always @* if (fetched) assert (fixed_rect == rects_rect_word);
always @* if (known) assert ((rects_usable & live) == live);

// Invariants: what is known of the memory's address, and its contents, which are registers in this model.
always @* if (known && accessed)
    assert (memory.in_table && memory.index == slot && memory.known == memory.written[slot]);
generate
    genvar i;
    for (i = 0; i < 3; i = i + 1) begin: slots
        fixed_rects_slot #(RECT_BITS, i == 0 ? SCENE_0 : i == 1 ? SCENE_1 : SCENE_2, KEPT) slot_i (
            known, wrote, memory.storing && memory.latest_index == i, memory.latest_word,
            i == 0 ? written_0 : i == 1 ? written_1 : written_2, shadow[i], pending[i], live[i], memory.written[i],
            memory.shadow_words{i}, memory.banks{i}, memory.banks{i + 4}, memory.banks{i + 8},
            memory.rect_slot{i}_i.shadow, memory.rect_slot{i}_i.pending, memory.rect_slot{i}_i.live,
            memory.rect_slot{i}_i.shadow_usable, memory.rect_slot{i}_i.pending_usable);
    end
endgenerate

// Covers fetches of one rectangle after another.
reg [1:0] before = 0;
always @(posedge clk) if (rects_fetch) before <= rects_index;
always @* cover (fetched && rects_fetch && rects_index == 2 && before == 0);
always @* cover (fetched && rects_fetch && rects_index == 0 && before == 2);
endmodule

// One slot: its written words, and each copy that is from the scene, compared with the result of a second sorter.
module fixed_rects_slot #(parameter RECT_BITS = 71, parameter [95:0] SCENE = 0, parameter [95:0] KEPT = 0) (
    input running, input wrote, input storing, input [95:0] latest, input [2:0] words, input shadow, input pending,
    input live, input written, input [95:0] kept,
    input [RECT_BITS-1:0] place_0, input [RECT_BITS-1:0] place_1, input [RECT_BITS-1:0] place_2,
    input [1:0] at_shadow, input [1:0] at_pending, input [1:0] at_live, input shadow_usable, input pending_usable);
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
