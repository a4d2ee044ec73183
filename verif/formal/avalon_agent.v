// SPDX-License-Identifier: MIT
// The registers and the scene memories as software sees them, compared with a model of one word at any address.
//
// Assumed: a transfer either reads or writes, as Avalon requires; one cycle of reset at first. Reset may come again at
// any time; StartScreen, the budget's counters and the renderer's flags are arbitrary. The solver chooses the constant
// `watched`, so what holds for it holds for every address; likewise the rectangle `watched_slot`.
//
// [proof]
// claim = """reads are answered once and in order, no write is lost, commit is atomic, sticky bits and interrupt \
// are kept"""
// modules = ["avalon_interface", "camera_mem", "rect_mem", "rect_slot", "rect_sorter", "scene_word"]
// cut = ["rect_sorter"]
// as_registers = ["rect_mem"]
// induction = 3
// reach = 12
// quick = ["one-unit two"]
// designs = ["one-unit two reflections=2 rounding=nearest fraction_bits=4 rows=200"]
// [faults]
// "vga240-u1-r2-m1-f0t-d3-c8" = ["avalon_interface.wait_request or avs_s0_write",
//   "avalon_interface.avs_s0_readdatavalid or bus_write", "avalon_interface.bus_write and bus_mask[0]",
//   "avalon_interface.bus_mask[15] 0", "avalon_interface.commit_pending 0",
//   "avalon_interface.progress_underrun unless bus_write", "avalon_interface.irq as irq_pending",
//   "avalon_interface.avs_s0_readdata as read_data", "rect_mem.readback or old_surface",
//   "rect_mem.latest_copies_live as latest_copies_pending", "rect_mem.latest_copies_pending as latest_copies_live",
//   "rect_mem.written 1", "rect_slot.shadow_usable as usable", "scene_word.bus_commit or bus_write",
//   "scene_word.bus_go_live or bus_commit"]

module avalon_agent;
avalon_interface registers (.*);
wire [ADDRESS_BITS-1:0] address = avs_s0_address;
wire [31:0] writedata = avs_s0_writedata, readdata = avs_s0_readdata;
wire [3:0] byteenable = avs_s0_byteenable;
wire read = avs_s0_read, write = avs_s0_write, readdatavalid = avs_s0_readdatavalid, waitrequest = avs_s0_waitrequest;
wire start_screen = progress_start_screen, busy = progress_busy;
wire [15:0] row_cycles = progress_row_cycles, group_cycles = progress_group_cycles;
camera_mem camera (.*, .readback(camera_readback));
rect_mem rects (.*, .readback(rect_readback));

// The register map, written a second time by hand.
localparam ID = 0, VERSION = 1, ENGINE = 2, SIZE = 3, CONTROL = 4, STATUS = 5, CYCLES = 6, IRQ_ENABLE = 7,
    IRQ_PENDING = 8, BACKGROUND = 9, CAMERA = 10, TABLE = 16;
localparam [31:0] POINT_BITS = 32'h1ff7fdff, SURFACE_BITS = 32'h80ffffff;
localparam [95:0] SLOT_BITS = {POINT_BITS, POINT_BITS, SURFACE_BITS};
(* anyconst *) reg [ADDRESS_BITS-1:0] watched;
reg [31:0] implemented;  // bits of a shadowed word; the other words have none
always @* case (watched)
    CONTROL: implemented = 32'h701;
    BACKGROUND: implemented = 32'h00ffffff;
    CAMERA, TABLE, TABLE + 1, TABLE + 4, TABLE + 5: implemented = POINT_BITS;
    TABLE + 2, TABLE + 6: implemented = SURFACE_BITS;
    default: implemented = 0;
endcase

always @* assume (!(read && write));

// waitrequest is high in the first cycle after reset only.
always @* if (known) assert (waitrequest == $past(reset));

// Accepted transfers, and the same one cycle later.
wire accepted = !waitrequest && !reset;
wire reads = read && accepted, writes = write && accepted;
wire [31:0] mask = {{8{byteenable[3]}}, {8{byteenable[2]}}, {8{byteenable[1]}}, {8{byteenable[0]}}};
wire commits = writes && address == CONTROL && byteenable[0] && writedata[1];
reg wrote, committed_2;
reg [ADDRESS_BITS-1:0] wrote_address;
reg [31:0] wrote_ones, wrote_mask;
always @(posedge clk) begin
    {wrote, wrote_address, wrote_ones, wrote_mask} <= {writes, address, writedata & mask, mask};
    committed_2 <= !reset && $past(commits);
end

// The shadow, its snapshot with the write that committed it, and the live word. A commit takes two cycles, so
// StartScreen shows it only if it comes later.
wire [31:0] shadow, shadow_1, snapshot, pending, live;
copies #(32) word (
    clk, reset, writes && address == watched, mask & implemented, writedata, $past(commits), committed_2, start_screen,
    shadow, shadow_1, snapshot, pending, live
);
reg outstanding;  // committed but not shown yet
always @(posedge clk) begin
    if (reset) outstanding <= 0;
    else if (commits) outstanding <= 1;
    else if (start_screen && !$past(commits) && !committed_2) outstanding <= 0;
end

// Status, interrupt and cycles: an event in the same cycle as a write that clears it is kept.
wire wrote_status = wrote && wrote_address == STATUS;
wire wrote_cycles = wrote && wrote_address == CYCLES && wrote_mask != 0;
reg status_underrun, status_bad, enabled, event_pending;
reg [15:0] frame, slowest_row, slowest_group;
always @(posedge clk) begin
    if (reset) begin
        {status_underrun, status_bad, enabled, event_pending} <= 0;
        {frame, slowest_row, slowest_group} <= 0;
    end
    else begin
        status_underrun <= progress_underrun || (status_underrun && !(wrote_status && wrote_ones[1]));
        status_bad <= (committed_2 && bad_rectangle) || (status_bad && !(wrote_status && wrote_ones[2]));
        event_pending <= start_screen || (event_pending && !(wrote && wrote_address == IRQ_PENDING && wrote_ones[0]));
        if (wrote && wrote_address == IRQ_ENABLE && wrote_mask[0]) enabled <= wrote_ones[0];
        if (start_screen) frame <= frame + 1;
        slowest_row <= wrote_cycles ? 0 : busy && row_cycles > slowest_row ? row_cycles : slowest_row;
        slowest_group <= wrote_cycles ? 0 : busy && group_cycles > slowest_group ? group_cycles : slowest_group;
    end
end
always @* if (known) assert (irq == (enabled && event_pending));

// Every accepted read, and nothing else, is answered two cycles later. The answer for the watched word has all writes
// from before the read was accepted.
reg read_2, watched_1;
reg [31:0] expected_1;
always @* case (watched)
    ID: expected_1 = 32'h52415943;
    VERSION: expected_1 = VERSION_WORD;
    ENGINE: expected_1 = CULLING << 30 | COLOUR_BITS << 24 | SCALE << 20 | REFLECTIONS << 16 | LIGHT << 14
        | DIVIDER_BITS << 12 | PATTERNS << 11 | MATERIALS << 10 | TURN << 9 | NEAREST << 8 | FRACTION_BITS << 4 | !SEED;
    SIZE: expected_1 = ROWS << 16 | RECTANGLES << 10 | UNITS;
    CONTROL: expected_1 = shadow_1 | (outstanding << 1);
    STATUS: expected_1 = {frame, 13'b0, status_bad, status_underrun, busy};
    CYCLES: expected_1 = {slowest_group, slowest_row};
    IRQ_ENABLE: expected_1 = enabled;
    IRQ_PENDING: expected_1 = event_pending;
    default: expected_1 = shadow_1;  // 0 at an unmapped address
endcase
always @(posedge clk) begin
    read_2 <= $past(reads) && !reset;
    watched_1 <= address == watched;
end
always @* if (known && !$past(reset)) begin
    assert (readdatavalid == read_2);
    if (readdatavalid && $past(watched_1)) assert (readdata == $past(expected_1));
end
always @* if (known && $past(reset)) assert (!readdatavalid);

// An answer stays on the bus until the next one; hosts may rely on this.
always @* if (known && !$past(reset) && !readdatavalid) assert ($stable(readdata));

// The renderer gets the live word, which changes at StartScreen only.
reg [31:0] shown;
always @* case (watched)
    CONTROL: shown = registers.live_control;
    BACKGROUND: shown = registers.live_background;
    CAMERA: shown = camera.lives_0;
    default: shown = live;  // rectangles are below
endcase
wire [2:0] most_reflections = REFLECTIONS;
wire [53:0] scene = {picture_run, picture_reflections, picture_background, camera_x, camera_y, camera_z};
always @* if (known) begin
    assert (shown == live);
    if (watched == CONTROL) begin
        assert (picture_run == live[0]);
        assert (picture_reflections == (live[10:8] > most_reflections ? most_reflections : live[10:8]));
    end
    if (watched == BACKGROUND) assert (picture_background == live[23:0]);
    if (watched == CAMERA) assert ({camera_z, camera_y, camera_x} == {live[28:20], live[18:10], live[8:0]});
    if (!$past(start_screen) && !$past(reset)) assert ($stable(shown) && $stable(scene));
end

// The watched rectangle: its three words as above, whether any was written since reset, and what the renderer gets. The
// sorter is arbitrary here, except that `words` always give the same `result`; what holds for these holds for any
// words.
(* anyconst *) reg watched_slot;
wire [ADDRESS_BITS-1:0] first = TABLE + 4 * watched_slot;
wire in_slot = address[ADDRESS_BITS-1:2] == first[ADDRESS_BITS-1:2];
wire [95:0] slot_mask = {
    address[1:0] == 0 ? mask : 32'b0, address[1:0] == 1 ? mask : 32'b0, address[1:0] == 2 ? mask : 32'b0
} & SLOT_BITS;
wire [95:0] wrote_slot_mask = {
    wrote_address[1:0] == 0 ? wrote_mask : 32'b0, wrote_address[1:0] == 1 ? wrote_mask : 32'b0,
    wrote_address[1:0] == 2 ? wrote_mask : 32'b0
} & SLOT_BITS;
wire [95:0] slot_shadow, slot_shadow_1, slot_snapshot, slot_pending, slot_live;
wire written, written_1, written_snapshot, written_pending, written_live;
copies #(97) slot (
    clk, reset, writes && in_slot, {1'b1, slot_mask}, {1'b1, {3{writedata}}}, $past(commits), committed_2, start_screen,
    {written, slot_shadow}, {written_1, slot_shadow_1}, {written_snapshot, slot_snapshot},
    {written_pending, slot_pending}, {written_live, slot_live}
);
function shares(input [31:0] a, input [31:0] b);
    shares = a[8:0] == b[8:0] || a[18:10] == b[18:10] || a[28:20] == b[28:20];
endfunction
function good(input [95:0] words);
    good = words[31] && shares(words[95:64], words[63:32]);
endfunction
function wrong(input [95:0] words);
    wrong = words[31] && !shares(words[95:64], words[63:32]);
endfunction
(* anyconst *) reg [95:0] words;
(* anyconst *) reg [RECT_BITS-1:0] result;
always @* assume (rects.latest_word != words || rects.sorted_rect_word == result);

// A fetch returns the rectangle that is live in its cycle, until the next fetch.
reg fetched = 0;
always @(posedge clk)
    if (rects_fetch) fetched <= known && rects_index == watched_slot && written_live && slot_live == words;
always @* if (known) begin
    assert (rects_usable[watched_slot] == good(slot_live));
    if (fetched) assert (rects_rect_word == result);
end

// The memories of rect_mem are registers in this model.
wire [95:0] slot_0 = rects.written[0] ? \rects.shadow_words[0] : 0;
wire [95:0] slot_1 = rects.written[1] ? \rects.shadow_words[1] : 0;
wire [1:0] its_shadow = rects.rect_slot{watched_slot}_i.shadow, its_live = rects.rect_slot{watched_slot}_i.live;
wire [1:0] its_pending = rects.rect_slot{watched_slot}_i.pending;
wire [2:0] right = watched_slot ? {\rects.banks[5] == result, \rects.banks[3] == result, \rects.banks[1] == result}
    : {\rects.banks[4] == result, \rects.banks[2] == result, \rects.banks[0] == result};
wire stores_0 = rects.storing && !rects.latest_index, stores_1 = rects.storing && rects.latest_index;
wire stores_it = watched_slot ? stores_1 : stores_0;
always @* if (known) begin
    if (bus_commit) assert (!rects.storing && bad_rectangle == (wrong(slot_0) || wrong(slot_1)));
    if (stores_0) assert (rects.latest_word == slot_0);
    else assert (rects.rect_slot_0_i.bad == wrong(slot_0));
    if (stores_1) assert (rects.latest_word == slot_1);
    else assert (rects.rect_slot_1_i.bad == wrong(slot_1));
    assert ((watched_slot ? slot_1 : slot_0) == slot_shadow_1 && (slot_shadow & ~SLOT_BITS) == 0);
    if (!wrote || wrote_address[ADDRESS_BITS-1:2] != first[ADDRESS_BITS-1:2])
        assert (slot_shadow == slot_shadow_1 && written == written_1);
    else assert (slot_shadow == ((slot_shadow_1 & ~wrote_slot_mask) | ({3{wrote_ones}} & wrote_slot_mask)) && written);
    assert (rects.written[watched_slot] == written_1);
    assert (its_shadow < 3 && its_pending < 3 && its_live < 3);
    if (!stores_it) begin
        if (written_1 && slot_shadow_1 == words) assert (right[its_shadow]);
        assert (rects.rect_slot{watched_slot}_i.shadow_usable == good(slot_shadow_1));
    end
    if (written_pending && slot_pending == words) assert (right[its_pending]);
    if (written_live && slot_live == words) assert (right[its_live]);
    assert (rects.rect_slot{watched_slot}_i.pending_usable == good(slot_pending));
    if (committed_2) assert (slot_snapshot == slot_shadow_1 && written_snapshot == written_1);
end

// Invariants: the registers behind the bus are one cycle behind the model, and its pending copies are the same.
reg [31:0] kept, kept_pending;
always @* case (watched)
    CONTROL: {kept, kept_pending} = {registers.control_word, registers.scene_word_0_i.pending};
    BACKGROUND: {kept, kept_pending} = {registers.background_word, registers.scene_word_1_i.pending};
    CAMERA: {kept, kept_pending} = {camera_readback, camera.scene_word_i.pending};
    TABLE: {kept, kept_pending} = {slot_0[95:64], pending};
    TABLE + 1: {kept, kept_pending} = {slot_0[63:32], pending};
    TABLE + 2: {kept, kept_pending} = {slot_0[31:0], pending};
    TABLE + 4: {kept, kept_pending} = {slot_1[95:64], pending};
    TABLE + 5: {kept, kept_pending} = {slot_1[63:32], pending};
    TABLE + 6: {kept, kept_pending} = {slot_1[31:0], pending};
    default: {kept, kept_pending} = 0;
endcase
always @* if (known) begin
    assert (kept == shadow_1 && (kept & ~implemented) == 0 && (shadow & ~implemented) == 0);
    if (!wrote || wrote_address != watched) assert (shadow == shadow_1);
    else assert (shadow == (((shadow_1 & ~wrote_mask) | wrote_ones) & implemented));
    assert (kept_pending == pending);
    if (committed_2) assert (snapshot == shadow_1 && outstanding);
    if ($past(commits)) assert (outstanding);
    assert (outstanding == ($past(commits) || committed_2 || registers.commit_pending));
    assert (bus_commit == committed_2);
    assert ($past(commits) == (wrote && wrote_address == CONTROL && wrote_ones[1]));
    assert (bus_write == wrote && registers.reading == $past(reads));
    if (wrote) assert (bus_address == wrote_address && bus_mask == wrote_mask && (bus_data & bus_mask) == wrote_ones);
    if ($past(reads)) assert (watched_1 == (bus_address == watched));
    if (bus_write || registers.reading) begin
        assert (rects.in_table == (bus_address >= TABLE && bus_address < TABLE + 8));
        if (rects.in_table) assert (rects.index == bus_address[2] && rects.known == rects.written[rects.index]);
    end
    assert (!(wrote && $past(reads)));
    assert (registers.frame == frame);
    assert (registers.slowest_row == slowest_row && registers.slowest_group == slowest_group);
    assert (registers.sticky_underrun == status_underrun && registers.sticky_bad == status_bad);
    assert (registers.irq_enable == enabled && registers.irq_pending == event_pending);
end

// Covers a written and committed word that is shown and read back, and an interrupt that is raised and cleared.
reg was_irq = 0;
always @(posedge clk) was_irq <= !reset && (was_irq || irq);
always @* begin
    cover (watched == TABLE + 6 && live[31] && !outstanding && readdatavalid && $past(watched_1));
    cover (was_irq && !irq && !reset && enabled);
end
endmodule

// Bits as software writes them, now and a cycle ago, and their copies: as committed, pending, and live.
module copies #(parameter BITS = 32) (
    input clk, input reset, input write, input [BITS-1:0] mask, input [BITS-1:0] data, input snap, input commit,
    input go_live, output reg [BITS-1:0] shadow, output reg [BITS-1:0] shadow_1, output reg [BITS-1:0] snapshot,
    output reg [BITS-1:0] pending, output reg [BITS-1:0] live
);
always @(posedge clk) begin
    if (reset) {shadow, shadow_1, pending, live} <= 0;
    else begin
        if (write) shadow <= (shadow & ~mask) | (data & mask);
        shadow_1 <= shadow;
        if (commit) pending <= snapshot;
        if (go_live) live <= pending;
    end
    if (snap) snapshot <= shadow;
end
endmodule
