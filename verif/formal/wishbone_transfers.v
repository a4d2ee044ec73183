// SPDX-License-Identifier: MIT
// Wishbone through the bridge to an agent: the master's accesses, the agent's transfers, and the answers.
//
// Assumed: the agent asserts waitrequest for at most MOST_WAIT cycles per transfer, and answers a read with one
// readdatavalid, 1 to MOST_LATENCY cycles after it accepted it. An access is held until it is acknowledged, or ends
// with a cycle without an access, as the master may give up. One cycle of reset at first; it may come again at any
// time.

module wishbone_transfers #(parameter ADDRESS_BITS = 4, parameter MOST_WAIT = 1, parameter MOST_LATENCY = 2) (
    input clk, input reset,
    input cyc, input stb, input we, input [ADDRESS_BITS-1:0] adr, input [3:0] sel, input [31:0] dat_w,
    input [31:0] readdata, input readdatavalid, input waitrequest
);
wire ack, read, write;
wire [31:0] dat_r, writedata;
wire [3:0] byteenable;
wire [ADDRESS_BITS-1:0] address;
wishbone_bridge bridge (
    .clk(clk), .reset(reset), .wb_cyc(cyc), .wb_stb(stb), .wb_we(we), .wb_ack(ack), .wb_adr(adr), .wb_sel(sel),
    .wb_dat_w(dat_w), .wb_dat_r(dat_r), .avm_m0_address(address), .avm_m0_read(read), .avm_m0_write(write),
    .avm_m0_writedata(writedata), .avm_m0_byteenable(byteenable), .avm_m0_readdata(readdata),
    .avm_m0_readdatavalid(readdatavalid), .avm_m0_waitrequest(waitrequest)
);
wire access = cyc && stb;

// The previous cycle.
reg known = 0;
reg last_reset, last_access, last_we, last_ack, last_read, last_write, last_waitrequest;
reg [ADDRESS_BITS-1:0] last_adr;
reg [3:0] last_sel;
reg [31:0] last_dat_w;
always @(posedge clk) begin
    known <= 1;
    {last_reset, last_access, last_we, last_ack} <= {reset, access, we, ack};
    {last_adr, last_sel, last_dat_w} <= {adr, sel, dat_w};
    {last_read, last_write, last_waitrequest} <= {read, write, waitrequest};
end

// Transfers of the current access; the transfer whose answer is due, and whether it belongs to an earlier access.
wire taken = (read || write) && !waitrequest;
reg [1:0] transfers;
reg outstanding, stale;
reg [7:0] age, waited, since;
always @(posedge clk) begin
    if (reset) begin
        {transfers, outstanding, stale, age, waited} <= 0;
        since <= 1;
    end
    else begin
        transfers <= access && !ack ? transfers + taken : 0;
        outstanding <= outstanding ? !readdatavalid : read && taken;
        stale <= outstanding && !readdatavalid && (stale || !access);
        age <= access && !ack ? age + 1 : 0;
        waited <= (read || write) && waitrequest ? waited + 1 : 0;
        since <= outstanding ? since + 1 : 1;
    end
end

always @* begin
    if (!known) assume (reset);
    if (known && !last_reset && last_access && !last_ack && access)
        assume (we == last_we && adr == last_adr && sel == last_sel && dat_w == last_dat_w);
    if (known && !outstanding) assume (!readdatavalid);
    if (known && outstanding && since == MOST_LATENCY) assume (readdatavalid);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
end

always @* if (known && !last_reset && !reset) begin
    // Read and write exclude each other, and come only with a matching access of the master.
    assert (!(read && write));
    if (read || write) assert (access && write == we && address == adr);
    if (write) assert (writedata == dat_w && byteenable == sel);
    // At most one read is outstanding, and nothing overtakes it.
    if (outstanding) assert (!read && !write);
    // An access is acknowledged once, with one transfer: a write when it is accepted, a read with its own answer.
    if (ack) assert (access && transfers + taken == 1);
    if (!ack) assert (!(write && taken) && transfers + taken <= 1);
    if (ack && !we) assert (outstanding && !stale && readdatavalid && dat_r == readdata);
    if (readdatavalid && !stale && access) assert (ack);
    // Within the bounds, even after an access that another master gave up.
    if (access) assert (age <= MOST_WAIT + 2 * MOST_LATENCY);
end

// A transfer is stable while it waits and its access is held.
always @* if (known && !reset && !last_reset && access && (last_read || last_write) && last_waitrequest)
    assert (read == last_read && write == last_write);

// Invariants.
(* hierconn *) wire \bridge.reading , \bridge.still_wanted ;
always @* if (known && !last_reset) begin
    assert (\bridge.reading == outstanding);
    if (outstanding) assert (\bridge.still_wanted == !stale && since >= 1 && since <= MOST_LATENCY && waited == 0);
    if (!outstanding) assert (!stale);
    if (outstanding && !stale && access) assert (transfers == 1 && last_access && !we);
    if (stale || !outstanding) assert (transfers == 0);
    assert (waited <= MOST_WAIT && (waited == 0 || !outstanding));
    if (outstanding && stale) assert (age < since);
    if (outstanding && !stale && access) assert (age <= MOST_WAIT + MOST_LATENCY + since);
    if (!outstanding) assert (age <= MOST_LATENCY + waited);
end
always @* if (known && last_reset) assert (!\bridge.reading && transfers == 0 && age == 0);

// Covers an abandoned read, then another read that waits and is answered late.
reg gave_up = 0;
always @(posedge clk) gave_up <= !reset && (stale || (gave_up && !ack));
always @* cover (gave_up && !stale && ack && !we && since == MOST_LATENCY && age == MOST_WAIT + MOST_LATENCY + 1);
endmodule
