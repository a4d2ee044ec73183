// SPDX-License-Identifier: MIT
// Compares the monitor's side of the lists with a reference that sees the whole list: the entry that each pixel of each
// line shows. A run ends with the column before its end, and the next run is the next entry's. The first row
// begins with the list's first entry, each further row with the entry after the row above, and all lines of a row with
// the same entry. So a row whose last entry ends at the number of columns is shown to its end, and not beyond.
//
// Assumed about the monitor: columns come at any pace, in lines of COLUMNS columns; there are BLANKING cycles between
// two lines; strobes come in the first three of these, and start_row not in those of start_screen. Assumed about the
// frames, as whole_frames proves: the list in view changes only in the cycle after start_screen, and is not written;
// and no row has more entries than are left in the list. The memories are one bank each; leaf tests have several.
//
// [proof]
// claim = "each pixel of each line is that of its run, which is found by the ends of the row's runs in the list"
// modules = [
//   "list_player", "row_place", "pixel_player if PIXELS == 1", "pair_player if PIXELS == 2", "read_ahead",
//   "list_memory", "run_memory", "run_bank",
// ]
// as_registers = ["read_ahead", "run_bank"]
// induction = 1
// quick = [
//   "1 pixel: alone=list UNITS=1 ROWS=2 COLUMNS=3 ENTRIES=2 PIXELS=1",
//   "2 pixels: alone=list UNITS=1 ROWS=2 COLUMNS=4 ENTRIES=4 PIXELS=2",
// ]
// [faults]
// "1 pixel" = ["pixel_player.column_end 1 in 20", "pixel_player.take 0 in 20", "read_ahead.head_slot 0 in 20",
//   "read_ahead.restart 0 in 20", "row_place.next_first 0 in 30", "row_place.row_first as next_first in 30",
//   "list_memory.lower_read 1 in 30", "row_place.view_run 1 in 20"]
// "2 pixels" = ["pair_player.splits 0 in 20", "pair_player.odd 0 in 20", "pair_player.after_ends 0 in 20",
//   "pair_player.right as left in 20", "list_player.first_even as first_odd in 30", "list_player.taken short in 20"]

module played_lines;
localparam BLANKING = 10, PLACES = ENTRIES / PIXELS, ONE = RUN_BITS;
list_player dut (.*);
wire start_screen = scan_start_screen, start_row = scan_start_row, visible = scan_visible_line;
wire next_column = scan_next_column;

// The entries of the list in view: with two pixels per clock, the even and the odd ones.
wire [2*ONE-1:0] bank_0 = {dut.list_memory{0}_i.run_memory{!upper}_i.run_bank_i.memory{1},
    dut.list_memory{0}_i.run_memory{!upper}_i.run_bank_i.memory{0}};
wire [2*ONE-1:0] bank_1 = {dut.list_memory{1}_i.run_memory{!upper}_i.run_bank_i.memory{1},
    dut.list_memory{1}_i.run_memory{!upper}_i.run_bank_i.memory{0}};
function [ONE-1:0] of(input [2*ONE-1:0] even, input [2*ONE-1:0] odd, input [4:0] number);
    if (PIXELS == 1) of = even >> ONE * number[0];
    else of = (number[0] ? odd : even) >> ONE * number[1];
endfunction

// The monitor: cycles since a line's visible part, and columns of the line that are over.
reg was_visible, screen_seen;
reg [3:0] blank;
reg [3:0] column;
always @(posedge clk) begin
    was_visible <= visible && !reset;
    blank <= visible || reset ? 0 : blank == BLANKING ? BLANKING : blank + 1;
    column <= !visible || reset ? 0 : column + (next_column ? PIXELS : 0);
    screen_seen <= !visible && !reset && (screen_seen || start_screen);
end
wire early = !visible && blank < 3;
always @* begin
    if (visible) assume (blank == BLANKING || was_visible);
    if (visible) assume (column < COLUMNS);
    if (known && was_visible && column < COLUMNS) assume (visible);
    if (!visible) assume (!next_column);
    if (start_row) assume (early && !start_screen && !screen_seen);
    if (start_screen) assume (early);
end

// The reference: the entry of the present column, and the first ones of this row and of the next.
reg shows;
reg [4:0] entry, row_first, row_next;
wire [ONE-1:0] now = of(bank_0, bank_1, entry), after = of(bank_0, bank_1, entry + 1);
wire splits = now[ONE-1:1] == column + 1;
wire [4:0] entry_2 = entry + splits;
wire [ONE-1:0] last = splits && PIXELS == 2 ? after : now;
wire last_ends = last[ONE-1:1] == column + PIXELS;
wire [4:0] next_entry = PIXELS == 1 ? entry_2 : entry_2 + last_ends;
reg [PIXELS-1:0] expected;
always @(posedge clk) begin
    expected <= 0;
    if (visible && shows && !reset) expected <= PIXELS == 1 ? now[0] : {last[0], now[0]};
    if (reset) {shows, row_first, row_next} <= 0;
    else begin
        if (start_screen) shows <= 0;
        else if (start_row) shows <= view_run;
        if ($past(start_screen) && !$past(reset)) row_next <= 0;
        else if (was_visible && !visible && shows) row_next <= entry;
        if (start_row) row_first <= was_visible && shows ? entry : row_next;
    end
    if (reset || !visible) entry <= reset ? 0 : row_first;
    else if (next_column && shows) entry <= next_entry;
end
always @* begin
    if (known && !($past(start_screen) && !$past(reset))) assume ($stable(upper) && $stable(view_run));
    if (write) assume (write_place < ENTRIES);
    if (visible && shows) assume (entry + (splits && PIXELS == 2) < ENTRIES);
end

// The pixels of a clock, in lines of the picture and between them.
always @* if (known && !$past(reset)) assert (shown == expected);

// Invariants of the present place, which is followed in the first cycles of a line's blanking.
wire [4:0] place = dut.row_place_i.present;
wire playing = dut.playing, restart = dut.restart;
wire row_starts = dut.row_place_i.row_starts, screen_starts = dut.row_place_i.screen_starts;
always @* if (known) begin
    assert (dut.row_place_i.was_visible == was_visible);
    assert (row_starts == ($past(start_row) && !$past(reset)));
    assert (screen_starts == ($past(start_screen) && !$past(reset)));
    assert (!(row_starts && screen_starts));
    if (!was_visible) assert (dut.row_place_i.taken_before == 0);
    if (row_starts || screen_starts) assert (!visible && blank != 0 && blank <= 3);
    assert (dut.row_place_i.next_first == row_next);
    assert ((row_starts ? row_next : dut.row_place_i.row_first) == row_first);
    if (!row_starts && !screen_starts) assert (playing == shows);
    if (row_starts) assert (shows == view_run && !screen_seen);
    if (screen_starts) assert (!shows && screen_seen);
    assert (was_visible ? blank == 0 : column == 0);
    if (visible) assert (place == (playing ? entry : row_first) && column % PIXELS == 0);
    if (!visible && !was_visible) assert (place == dut.row_place_i.row_first);
    if (!visible && was_visible) assert (place == (playing ? entry : row_first));
    if (!visible && blank > 3) assert (entry == row_first);
    if (restart) assert (playing && !visible && blank != 0 && blank <= 4);
    assert (blank <= BLANKING && column <= COLUMNS);
end

// Invariants of what is read ahead: it follows the place, from the head on, in slots, on the way there, and beyond.
wire reads = playing && !restart && !screen_starts;

// The list in view has been read for a while when a row begins, and the other list shows nothing.
always @* if (known) begin
    assert ($stable(upper) || screen_starts);
    if (row_starts || (playing && !screen_starts)) assert (upper == $past(upper) && upper == $past(upper, 2));
end

genvar i, k;
generate for (i = 0; i < PIXELS; i = i + 1) begin: banks
    wire [2:0] held = dut.read_ahead{i}_i.taken_slots, there = dut.read_ahead{i}_i.filled_slots;
    wire [1:0] head = dut.read_ahead{i}_i.head_slot, coming = dut.read_ahead{i}_i.on_the_way;
    wire [1:0] put_slot = dut.read_ahead{i}_i.put_slot, read_place = dut.read_ahead{i}_i.read_place;
    always @* if (known) begin
        assert (dut.list_memory{i}_i.run_memory_0_i.run_bank_i.reads == $past(upper));
        assert (dut.list_memory{i}_i.run_memory_1_i.run_bank_i.reads == !$past(upper));
        if ($past(known)) assert (($past(upper, 2) ? dut.list_memory{i}_i.upper_run_word
            : dut.list_memory{i}_i.lower_run_word) == 0);
    end
    wire [4:0] head_place = PIXELS == 1 ? place : (place + (1 - i)) >> 1;
    wire [4:0] most = blank - 5;
    always @* if (known && reads) begin
        assert (held <= 4 && there <= 4 && held == there + coming[0] + coming[1]);
        assert (put_slot == head + there[1:0]);
        assert (read_place == (head_place + held) % PLACES);
        if (visible) assert (held >= 3);
        else if (blank > 5) assert (held >= (most > 4 ? 4 : most));
    end
    for (k = 0; k < 4; k = k + 1) begin: runs
        wire [4:0] number = PIXELS == 1 ? (head_place + k) % PLACES : (head_place + k) % PLACES * 2 + i;
        wire [1:0] slot = head + k;
        wire [ONE-1:0] run = of(bank_0, bank_1, number);
        always @* if (known && reads) begin
            if (k < there) assert (dut.read_ahead{i}_i.slots{slot} == run);
            else if (k == there && coming[1]) assert (dut.list_memory{i}_i.shown_word == run);
            else if (k < held) assert (dut.list_memory{i}_i.run_memory{!upper}_i.run_bank_i.fetched == run);
        end
    end
end endgenerate
generate if (PIXELS == 2) begin: pairs
    always @* if (known && reads) assert (dut.odd == place[0]);
    always @* if (known && (visible || blank != 0)) assert (dut.pair_player_i.end_of_pair == column + 2);
    always @* if (known && (visible || blank != 0)) assert (dut.pair_player_i.column_end == column + 1);
end else begin: singles
    always @* if (known && (visible || blank != 0)) assert (dut.pixel_player_i.column_end == column + 1);
end endgenerate
endmodule
