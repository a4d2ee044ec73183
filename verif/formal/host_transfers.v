// SPDX-License-Identifier: MIT
// The path from the processor to an Avalon-MM agent: each access is one transfer, whatever the agent does.
//
// Assumed: the processor holds an access until it is ready; reset ends every access.
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

module host_transfers #(
    parameter ADDRESS_BITS = 6, parameter MOST_WAIT = 3, parameter MOST_LATENCY = 3
) (
    input clk, input reset,
    input active, input [3:0] strobe, input [ADDRESS_BITS-1:0] address, input [31:0] data,
    input [31:0] readdata, input readdatavalid, input waitrequest
);
wire done, read, write;
wire [31:0] word, writedata;
wire [ADDRESS_BITS-1:0] bus_address;
wire [3:0] byteenable;

avalon_host host (
    .clk(clk), .reset(reset), .access_select(active), .access_ready(done), .access_word(word), .strobe(strobe),
    .address(address), .data(data), .avm_m0_address(bus_address), .avm_m0_read(read), .avm_m0_write(write),
    .avm_m0_writedata(writedata), .avm_m0_byteenable(byteenable), .avm_m0_readdata(readdata),
    .avm_m0_readdatavalid(readdatavalid), .avm_m0_waitrequest(waitrequest)
);
`include "avalon_side.v"

reg last_active, last_done;
reg [3:0] last_strobe;
reg [ADDRESS_BITS-1:0] last_address;
reg [31:0] last_data;
always @(posedge clk) begin
    {last_active, last_done, last_strobe, last_address, last_data} <= {active, done, strobe, address, data};
end
always @* if (known && !last_reset && last_active && !last_done)
    assume (active && strobe == last_strobe && address == last_address && data == last_data);

always @* if (known && !reset) begin
    // A transfer has the kind, address, bytes and data of the access, also while it waits.
    if (read) assert (strobe == 0 && byteenable == 4'b1111);
    if (write) assert (strobe != 0 && byteenable == strobe && writedata == data);
    if (read || write) assert (bus_address == address);
    if (done && strobe == 0) assert (outstanding && readdatavalid && word == readdata);
    if (readdatavalid) assert (done);
    // Within the bounds.
    if (active) assert (age <= MOST_WAIT + MOST_LATENCY);
end

// Invariants.
(* hierconn *) wire \host.waiting ;
always @* if (known) assert (\host.waiting == outstanding);
always @* if (known && !reset && !last_reset) begin
    assert (transfers == outstanding);
    if (!active) assert (age == 0 && waited == 0);
    if (outstanding) assert (active && strobe == 0 && age == waited + since);
    if (active && !outstanding) assert (age == waited);
end

// Covers a read that waits and is answered late, and right after it a write of some bytes that waits.
reg was_read = 0, after_read = 0;
always @(posedge clk) begin
    was_read <= !reset && done && strobe == 0 && waited == MOST_WAIT && since == MOST_LATENCY;
    after_read <= !reset && active && !done && (was_read || after_read);
end
always @* cover (after_read && done && strobe == 4'b0110 && waited == MOST_WAIT);
endmodule
