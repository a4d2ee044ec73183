// SPDX-License-Identifier: MIT
// Wishbone through the bridge to an agent: the master's accesses, the agent's transfers, and the answers.
//
// Assumed: an access is held until it is acknowledged, or ends with a cycle without an access, as the master may give
// up.
//
// [proof]
// claim = "each access is one transfer, acknowledged once, in time; an abandoned read disturbs no other access"
// modules = ["wishbone_bridge"]
// induction = 2
// reach = "3 * (MOST_WAIT + MOST_LATENCY) + 8"
// label = "{ADDRESS_BITS} bits, {MOST_WAIT} and {MOST_LATENCY} cycles"
// quick = ["alone=wishbone MOST_WAIT=1 MOST_LATENCY=2"]
// designs = ["alone=wishbone one-unit rectangles=32 MOST_WAIT=3 MOST_LATENCY=4"]
// [faults]
// "6 bits, 1 and 2 cycles" = ["wishbone_bridge.still_wanted 1", "wishbone_bridge.avm_m0_write or wb_we",
//   "wishbone_bridge.reading 0", "wishbone_bridge.avm_m0_waitrequest 0", "wishbone_bridge.selected as wb_stb"]

module wishbone_transfers;
wishbone_bridge bridge (.*);
wire active = wb_cyc && wb_stb, done = wb_ack, is_write = wb_we;
wire [ADDRESS_BITS-1:0] at = wb_adr;
wire [3:0] bytes = wb_sel;
wire [31:0] data = wb_dat_w, answer = wb_dat_r;
`include "avalon_side.v"

// True if the answer that is due belongs to an access that was given up.
reg stale;
always @(posedge clk) stale <= !reset && outstanding && !readdatavalid && (stale || !active);
always @* if (known && !$past(reset) && $past(active) && !$past(done) && active) assume ($stable(request));

always @* if (known && !$past(reset) && !reset) begin
    // A read gets its own answer.
    if (done && !is_write) assert (!stale);
    if (readdatavalid && !stale && active) assert (done);
    // Within the bounds, even after an access that another master gave up.
    if (active) assert (age <= MOST_WAIT + 2 * MOST_LATENCY);
end

// Invariants.
always @* if (known && !$past(reset)) begin
    assert (bridge.reading == outstanding);
    if (outstanding) assert (bridge.still_wanted == !stale && since >= 1 && since <= MOST_LATENCY);
    if (!outstanding) assert (!stale);
    if (outstanding && !stale && active) assert (transfers == 1 && $past(active) && !is_write);
    if (stale || !outstanding) assert (transfers == 0);
    if (stale) assert (age < since && waited == 0);
    if (outstanding && !stale && active) assert (age <= MOST_WAIT + MOST_LATENCY + since);
    if (!outstanding) assert (age <= MOST_LATENCY + waited);
end
always @* if (known && $past(reset)) assert (!bridge.reading);

// Covers an abandoned read, then another read that waits and is answered late.
reg gave_up = 0;
always @(posedge clk) gave_up <= !reset && (stale || (gave_up && !done));
wire late = since == MOST_LATENCY && age == MOST_WAIT + MOST_LATENCY + 1;
always @* cover (gave_up && !stale && done && !is_write && late);
endmodule
