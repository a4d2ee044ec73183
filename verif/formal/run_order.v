// SPDX-License-Identifier: MIT
// The queue of a unit's runs gives what it takes, in the same order, and a row that begins with room never waits.
//
// The picked run is an arbitrary one of those that the queue takes, so what is asserted for it holds for all. Assumed:
// a cycle of reset at first, and a take only while a run is offered. A memory of three places is enough for the logic,
// which depends on their number only where the places wrap. It is one bank; leaf tests have several.
//
// [proof]
// claim = "the queue gives each run once and in order, and a row that begins with room never waits for it"
// modules = ["run_queue", "read_ahead", "run_memory", "run_bank"]
// as_registers = ["run_bank", "read_ahead"]
// induction = 1
// reach = 24
// label = "{COLUMNS} columns"
// quick = ["alone=queue COLUMNS=1,2,3 PLACES=3"]
// [faults]
// "2 columns" = ["read_ahead.put_slot 0", "run_queue.write_place short", "read_ahead.fetch late",
//   "read_ahead.taken_slots edge", "run_queue.room 1", "run_queue.put as valid", "read_ahead.arrives late"]

module run_order;
localparam SLOTS = 4;
run_queue dut (.*);

always @* if (take) assume (offered);

// All runs in the queue, and those before the picked one.
(* anyseq *) reg pick;
reg picked;
reg [RUN_BITS-1:0] picked_run;
reg [3:0] older, all;
wire put = valid && ready;
always @(posedge clk) begin
    if (reset) {picked, older, all} <= 0;
    else begin
        all <= all + put - take;
        if (put && pick && !picked) {picked, picked_run, older} <= {1'b1, run_word, all - take};
        else if (picked && take) {picked, older} <= {older != 0, older - 4'd1};
    end
end
always @* if (known) begin
    if (offered) assert (all != 0);
    if (picked && offered && older == 0) assert (head_word == picked_run);
end

// The head stays until it is taken. A queue that is not empty offers a run after three cycles in which it takes none.
reg [1:0] age;
always @(posedge clk) age <= reset || all == 0 || offered ? 0 : age + 1;
always @* if (known) begin
    if ($past(known) && !$past(reset) && $past(offered) && !$past(take)) assert (offered && $stable(head_word));
    if (all != 0 && age == 3) assert (offered);
end

// A row of COLUMNS runs that begins with room is taken without a pause.
reg [2:0] row_left;
always @(posedge clk) begin
    if (reset) row_left <= 0;
    else if (room && row_left == 0) row_left <= COLUMNS - put;
    else if (put && row_left != 0) row_left <= row_left - 1;
end
always @* if (known && (room || row_left != 0)) assert (ready);

// Invariants: a run is in a slot, in one of the two cycles on its way there, or in the memory.
wire [3:0] in_slots = dut.read_ahead_i.filled_slots, ahead = dut.read_ahead_i.taken_slots;
wire [1:0] on_the_way = dut.read_ahead_i.on_the_way;
wire [1:0] read_place = dut.read_place, write_place = dut.write_place;
wire [3:0] place = read_place + older - ahead, next_place = read_place + dut.unread;
wire [1:0] slot = dut.read_ahead_i.head_slot + older[1:0], put_slot = dut.read_ahead_i.put_slot;
wire [RUN_BITS-1:0] in_slot = dut.read_ahead_i.slots{slot};
wire [RUN_BITS-1:0] in_memory = dut.run_memory_i.run_bank_i.memory{place % PLACES};
always @* if (known) begin
    assert (ready == (dut.unread != PLACES) && room == (dut.unread <= PLACES - COLUMNS));
    assert (dut.unread <= PLACES && in_slots <= SLOTS && ahead <= SLOTS && all == ahead + dut.unread);
    assert (ahead == in_slots + on_the_way[0] + on_the_way[1] && dut.run_memory_i.run_bank_i.reads);
    assert (read_place < PLACES && write_place == (next_place >= PLACES ? next_place - PLACES : next_place));
    assert (offered == (in_slots != 0));
    assert (put_slot == dut.read_ahead_i.head_slot + in_slots[1:0]);
    assert (row_left <= COLUMNS && dut.unread + row_left <= PLACES);
    if (picked) begin
        assert (older < all);
        if (older < in_slots) assert (in_slot == picked_run);
        else if (older >= ahead) assert (in_memory == picked_run);
        else if (older == in_slots && on_the_way[1]) assert (dut.shown_word == picked_run);
        else assert (dut.run_memory_i.run_bank_i.fetched == picked_run);
    end
    if (all != 0 && in_slots == 0) assert (age == 0 || on_the_way >> (age - 1) != 0);
end

// Covers a full queue, and a row that was taken while it was full of rows before.
always @* cover (known && !ready && all == PLACES + SLOTS);
always @* cover (picked && older == PLACES + SLOTS - 2);
endmodule
