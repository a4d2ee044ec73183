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

module wishbone_transfers #(parameter ADDRESS_BITS = 4, parameter MOST_WAIT = 1, parameter MOST_LATENCY = 2) (
    input clk, input reset,
    input cyc, input stb, input we, input [ADDRESS_BITS-1:0] adr, input [3:0] sel, input [31:0] dat_w,
    input [31:0] readdata, input readdatavalid, input waitrequest
);
wire done, read, write;
wire [31:0] dat_r, writedata;
wire [3:0] byteenable;
wire [ADDRESS_BITS-1:0] address;
wishbone_bridge bridge (
    .clk(clk), .reset(reset), .wb_cyc(cyc), .wb_stb(stb), .wb_we(we), .wb_ack(done), .wb_adr(adr), .wb_sel(sel),
    .wb_dat_w(dat_w), .wb_dat_r(dat_r), .avm_m0_address(address), .avm_m0_read(read), .avm_m0_write(write),
    .avm_m0_writedata(writedata), .avm_m0_byteenable(byteenable), .avm_m0_readdata(readdata),
    .avm_m0_readdatavalid(readdatavalid), .avm_m0_waitrequest(waitrequest)
);
wire active = cyc && stb;
`include "avalon_side.v"

// Whether the answer that is due belongs to an access that was given up.
reg last_active, last_done, last_we, stale;
reg [ADDRESS_BITS-1:0] last_adr;
reg [3:0] last_sel;
reg [31:0] last_dat_w;
always @(posedge clk) begin
    {last_active, last_done, last_we} <= {active, done, we};
    {last_adr, last_sel, last_dat_w} <= {adr, sel, dat_w};
    stale <= !reset && outstanding && !readdatavalid && (stale || !active);
end
always @* if (known && !last_reset && last_active && !last_done && active)
    assume (we == last_we && adr == last_adr && sel == last_sel && dat_w == last_dat_w);

always @* if (known && !last_reset && !reset) begin
    // A transfer has the kind, address, bytes and data of the access; a read gets its own answer.
    if (read || write) assert (write == we && address == adr);
    if (write) assert (writedata == dat_w && byteenable == sel);
    if (done && !we) assert (outstanding && !stale && readdatavalid && dat_r == readdata);
    if (readdatavalid && !stale && active) assert (done);
    // Within the bounds, even after an access that another master gave up.
    if (active) assert (age <= MOST_WAIT + 2 * MOST_LATENCY);
end

// Invariants.
(* hierconn *) wire \bridge.reading , \bridge.still_wanted ;
always @* if (known && !last_reset) begin
    assert (\bridge.reading == outstanding);
    if (outstanding) assert (\bridge.still_wanted == !stale && since >= 1 && since <= MOST_LATENCY);
    if (!outstanding) assert (!stale);
    if (outstanding && !stale && active) assert (transfers == 1 && last_active && !we);
    if (stale || !outstanding) assert (transfers == 0);
    if (stale) assert (age < since && waited == 0);
    if (outstanding && !stale && active) assert (age <= MOST_WAIT + MOST_LATENCY + since);
    if (!outstanding) assert (age <= MOST_LATENCY + waited);
end
always @* if (known && last_reset) assert (!\bridge.reading );

// Covers an abandoned read, then another read that waits and is answered late.
reg gave_up = 0;
always @(posedge clk) gave_up <= !reset && (stale || (gave_up && !done));
always @* cover (gave_up && !stale && done && !we && since == MOST_LATENCY && age == MOST_WAIT + MOST_LATENCY + 1);
endmodule
