// SPDX-License-Identifier: MIT
// The lists between units and monitor, with a picture of a few rows. The units, their queues and the monitor's side are
// cut out, so runs come at any time and in any order, and StartScreen at any time.
//
// That nobody waits for ever follows from three facts. A run of the unit whose turn it is, is taken at once, or the
// frame is abandoned. The turn passes on with each row, and rows are dealt in the same order. A queue with room takes a
// row without a pause, as run_order proves. So the first row that is not yet complete has been dealt, or its unit is
// done with the rows above, whose runs have left the queue, and it is dealt at once.
//
// Assumed: a cycle of reset at first, no two StartScreens in a row, and only runs of rows that have been dealt.
//
// [proof]
// claim = """what is shown is one whole frame, which nothing writes into; a frame that is whole is shown at the next \
// StartScreen; a scene goes live only between frames; the units have their turns, and nobody waits for ever"""
// modules = [
//   "frame_list", "frame_switch", "row_dealer", "row_collector", "list_player", "run_queue if UNITS > 1",
// ]
// cut = ["list_player", "run_queue if UNITS > 1"]
// induction = 1
// reach = "20 if UNITS == 1 else 0"
// label = "units {UNITS}, rows {ROWS}"
// quick = [
//   "alone=list UNITS=1 ROWS=1 COLUMNS=3 ENTRIES=2 PIXELS=1", "alone=list UNITS=2 ROWS=3 COLUMNS=4 ENTRIES=6 PIXELS=1",
// ]
// designs = ["alone=list UNITS=3 ROWS=4 COLUMNS=2 ENTRIES=8 PIXELS=1"]
// [faults]
// "units 2, rows 3" = ["frame_switch.upper 0 in 20", "frame_switch.ready 1 in 20",
//   "frame_switch.take_scene as start_screen in 20", "row_collector.rows_left edge in 20",
//   "row_collector.turn 0 in 20", "row_collector.next_place 0 in 20", "row_collector.write late in 20",
//   "row_dealer.busy 0 in 20", "row_dealer.turn 0 in 20", "frame_switch.drawn_run 1 in 20",
//   "row_collector.whole late in 20"]

module whole_frames;
frame_list dut (.*);
wire start_screen = scan_start_screen, write = dut.write, upper = dut.upper, new_frame = dut.new_frame;
wire abandoned = dut.abandoned;
wire row_written = write && dut.entry_word[RUN_BITS-1:1] == COLUMNS;
wire [7:0] place = dut.place;

// The frame that is drawn: from the cycle after new_frame until its last entry is written, or it is abandoned.
// waits: a whole frame, maybe a black one, waits for StartScreen. whole[i]: list i is a whole frame.
reg begins, drawing, waits, black;
reg [1:0] whole;
reg [7:0] rows_in, entries_in, dealt;
reg [UNITS-1:0] at_work, starts;
wire [UNITS-1:0] deals;
wire completes = drawing && row_written && rows_in == ROWS - 1;
wire takes_scene = start_screen && !drawing, hands_over = takes_scene && waits;
wire [7:0] rows_taken = rows_in + row_written, entries_taken = entries_in + write;
always @(posedge clk) begin
    if (reset) begin
        {begins, drawing, at_work, starts} <= 0;
        whole <= 0;
        {waits, black} <= 2'b11;
    end
    else begin
        begins <= takes_scene;
        {rows_in, entries_in} <= new_frame ? 16'b0 : {rows_taken, entries_taken};
        dealt <= new_frame ? 0 : dealt + (deals != 0);
        at_work <= abandoned ? 0 : at_work & ~done | deals;
        starts <= abandoned ? 0 : deals;
        if (begins) {drawing, waits, black} <= {run, !run, !run};
        else if (completes || abandoned) {drawing, waits} <= {1'b0, completes};
        else if (takes_scene) waits <= 0;
        if (new_frame) whole[upper] <= 0;
        else if (completes) whole[upper] <= 1;
    end
end
always @* begin
    if ($past(known) && $past(start_screen)) assume (!start_screen);
    if (drawing && rows_taken >= dealt) assume (!dut.offered);
end

// The list in view is one whole frame. Nothing is written into it, and only a whole frame takes its place.
always @* if (known) begin
    if (view_run) assert (whole[!upper]);
    if (write) assert (drawing && place == entries_in && entries_in < ENTRIES && rows_in < ROWS);
    if ($past(known) && !$past(reset)) begin
        assert (upper == ($past(upper) ^ $past(hands_over)));
        assert (view_run == ($past(hands_over) ? !$past(black) : $past(view_run)));
    end
end

// A scene goes live only between two frames. A frame is abandoned only if its list is full and a run more comes.
always @* if (known) begin
    assert (take_scene == takes_scene && new_frame == (begins && run));
    if (abandoned) assert (drawing && dut.offered && entries_taken == ENTRIES && rows_taken < ROWS);
    if ($past(known)) assert (stop == ($past(abandoned) || $past(reset)));
    assert (events_drawn == completes && events_list_full == abandoned);
    assert (events_shown == (hands_over && !black) && events_again == (start_screen && !hands_over));
    assert (events_late == (start_screen && drawing));
end

// Rows are dealt in order, each to the unit whose turn it is and as soon as that is idle and has room. A row starts in
// the cycle after its deal.
reg settling, settled;
always @(posedge clk) {settling, settled} <= reset || new_frame || abandoned ? 0 : {first_row, settling || settled};
wire [UNITS-1:0] idle = dut.row_dealer_i.room & (~at_work | done), in_turn = 1 << dealt % UNITS;
assign deals = drawing && settled && dealt < ROWS ? idle & in_turn : 0;
always @* if (known && !reset) begin
    assert (dut.row_dealer_i.starts == deals && start == starts && next_row == (starts != 0));
    if ($past(known) && !$past(reset)) assert (first_row == ($past(new_frame) && !$past(abandoned)));
end

// Runs are taken from the units in the same order, and at once.
wire take = dut.take;
generate if (UNITS > 1) begin: several
    wire [UNITS-1:0] takes = dut.takes;
    always @* if (known && drawing && !reset) begin
        assert (dut.turn == rows_taken % UNITS);
        assert (takes == (take ? 1 << rows_taken % UNITS : 0));
    end
end endgenerate
always @* if (known && drawing && dut.offered) assert (take || abandoned);
always @* if (known && !drawing) assert (!take && !abandoned);

// Invariants.
wire [1:0] state = dut.frame_switch_i.state;
wire [7:0] rows_left = dut.row_collector_i.rows_left;
always @* if (known) begin
    assert (state == (drawing ? 2 : begins ? 1 : 0) && !(begins && (drawing || waits)));
    assert (dut.frame_switch_i.ready == waits && dut.frame_switch_i.drawn_run == !black);
    assert (dut.whole == completes && dut.row_dealer_i.busy == at_work);
    if (begins) assert ($past(start_screen));
    if (drawing) assert (!waits && !black);
    if (drawing) assert (rows_left + rows_taken == ROWS && entries_taken <= ENTRIES);
    if (drawing) assert (dut.row_collector_i.next_place == entries_taken);
    else assert (rows_left == 0 && !write);
    assert (dut.row_collector_i.collecting == (rows_left != 0));
    if (drawing) assert (dut.row_collector_i.fits == (entries_taken != ENTRIES));
    if (waits && !black) assert (whole[upper]);
    if (drawing && settled) assert (dut.row_dealer_i.left + dealt == ROWS && dut.row_dealer_i.turn == dealt % UNITS);
    else assert (dut.row_dealer_i.left == 0 && (!drawing || dealt == 0));
    if (drawing) assert (rows_taken <= dealt && dealt <= ROWS);
    assert (dut.row_dealer_i.settles == settling && first_row + settling + settled <= 1);
    if (first_row || settling) assert (drawing);
end
wire view_run = dut.view_run;

// Covers a frame that is shown after it was late, one after an abandoned one, and a full list.
reg was_late, was_abandoned;
always @(posedge clk) begin
    was_late <= !reset && !takes_scene && (was_late || events_late);
    was_abandoned <= !reset && !hands_over && (was_abandoned || abandoned);
end
always @* cover (known && events_shown && was_late);
always @* cover (known && events_shown && was_abandoned);
always @* cover (known && completes && entries_taken == ENTRIES);
endmodule
