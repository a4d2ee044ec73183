// SPDX-License-Identifier: MIT
// APB through the bridge to an agent: the requester's accesses, the agent's transfers, and the answers.
//
// Assumed: an access has a setup phase of one cycle and is then held, with penable, until it is ready, as APB requires.
//
// [proof]
// claim = "each access is one transfer, stable while it waits, and ready once, in time"
// modules = ["apb_bridge"]
// induction = 2
// reach = "3 * (MOST_WAIT + MOST_LATENCY) + 8"
// label = "{ADDRESS_BITS} bits, {MOST_WAIT} and {MOST_LATENCY} cycles"
// quick = ["alone=apb MOST_WAIT=1 MOST_LATENCY=2"]
// designs = ["alone=apb one-unit rectangles=32 MOST_WAIT=3 MOST_LATENCY=4"]
// [faults]
// "6 bits, 1 and 2 cycles" = ["apb_bridge.s_apb_penable 1", "apb_bridge.reading 0",
//   "apb_bridge.s_apb_pready as s_apb_pwrite", "apb_bridge.avm_m0_waitrequest 0",
//   "apb_bridge.s_apb_pslverr as avm_m0_waitrequest"]

module apb_transfers;
apb_bridge bridge (.*);
wire active = s_apb_psel, access = s_apb_penable, done = active && access && s_apb_pready, is_write = s_apb_pwrite;
wire [ADDRESS_BITS-1:0] at = s_apb_paddr[ADDRESS_BITS+1:2];
wire [3:0] bytes = s_apb_pstrb;
wire [31:0] data = s_apb_pwdata, answer = s_apb_prdata;
`include "avalon_side.v"
`include "held_access.v"

always @* begin
    if (reset) assume (!active);
    if (known && !$past(reset) && !reset && $past(active) && !$past(done)) assume (access);
    if (known && ($past(reset) || !$past(active) || $past(done))) assume (!access || !active);
end

always @* if (known && !$past(reset) && !reset) begin
    assert (!s_apb_pslverr);
    if (active) assert (age <= MOST_WAIT + MOST_LATENCY + is_write);
    // Invariants.
    if (outstanding) assert (access);
    if (active && !outstanding) assert (age == waited + (is_write && access));
    if (active) assert (access == (age != 0));
end
always @* if (known) assert (bridge.reading == outstanding);
endmodule
