// SPDX-License-Identifier: MIT
// The path from the processor to an Avalon-MM agent: each access is one transfer, whatever the agent does.
//
// Assumed besides avalon_side.v: the processor holds an access until it is ready; reset ends every access.
//
// [proof]
// claim = "each access of the processor is one transfer, stable while it waits, and ready once, in time"
// modules = ["avalon_host"]
// induction = 1
// reach = "2 * MOST_WAIT + MOST_LATENCY + 5"
// label = "{ADDRESS_BITS} bits, {MOST_WAIT} and {MOST_LATENCY} cycles"
// quick = ["alone=host MOST_WAIT=1 MOST_LATENCY=2"]
// designs = ["alone=host one-unit rectangles=32 MOST_WAIT=9 MOST_LATENCY=7"]
// [faults]
// "6 bits, 1 and 2 cycles" = ["avalon_host.waiting 0", "avalon_host.access_ready or writing",
//   "avalon_host.waiting or reading", "avalon_host.waiting 1", "avalon_host.avm_m0_byteenable 1"]

module host_transfers;
avalon_host host (.*);
wire active = access_select, done = access_ready, is_write = strobe != 0;
wire [ADDRESS_BITS-1:0] at = address;
wire [3:0] bytes = strobe;
wire [31:0] answer = access_word;
`include "avalon_side.v"
`include "held_access.v"

always @* if (known && !reset) begin
    if (read) assert (avm_m0_byteenable == 4'b1111);
    if (active) assert (age <= MOST_WAIT + MOST_LATENCY);
    if (!$past(reset) && active && !outstanding) assert (age == waited);
end
always @* if (known && !reset) assert (host.waiting == outstanding);
endmodule
