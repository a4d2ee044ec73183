// SPDX-License-Identifier: MIT
// APB through the bridge to an agent: the requester's accesses, the agent's transfers, and the answers.
//
// Assumed: an access has a setup phase of one cycle and is then held, with penable, until it is ready, as APB requires.
// The agent asserts waitrequest for at most MOST_WAIT cycles per transfer, and answers a read with one readdatavalid, 1
// to MOST_LATENCY cycles after it accepted it. One cycle of reset at first; it may come again at any time.

module apb_transfers #(parameter ADDRESS_BITS = 4, parameter MOST_WAIT = 1, parameter MOST_LATENCY = 2) (
    input clk, input reset,
    input [ADDRESS_BITS+1:0] paddr, input psel, input penable, input pwrite, input [31:0] pwdata, input [3:0] pstrb,
    input [31:0] readdata, input readdatavalid, input waitrequest
);
wire pready, pslverr, read, write;
wire [31:0] prdata, writedata;
wire [3:0] byteenable;
wire [ADDRESS_BITS-1:0] address;
apb_bridge bridge (
    .clk(clk), .reset(reset), .s_apb_paddr(paddr), .s_apb_psel(psel), .s_apb_penable(penable), .s_apb_pwrite(pwrite),
    .s_apb_pready(pready), .s_apb_pslverr(pslverr), .s_apb_pwdata(pwdata), .s_apb_pstrb(pstrb), .s_apb_prdata(prdata),
    .avm_m0_address(address), .avm_m0_read(read), .avm_m0_write(write), .avm_m0_writedata(writedata),
    .avm_m0_byteenable(byteenable), .avm_m0_readdata(readdata), .avm_m0_readdatavalid(readdatavalid),
    .avm_m0_waitrequest(waitrequest)
);

// The previous cycle.
reg known = 0;
reg last_reset, last_psel, last_penable, last_pready, last_pwrite, last_read, last_write, last_waitrequest;
reg [ADDRESS_BITS+1:0] last_paddr;
reg [31:0] last_pwdata;
reg [3:0] last_pstrb;
always @(posedge clk) begin
    known <= 1;
    {last_reset, last_psel, last_penable, last_pready, last_pwrite} <= {reset, psel, penable, pready, pwrite};
    {last_paddr, last_pwdata, last_pstrb} <= {paddr, pwdata, pstrb};
    {last_read, last_write, last_waitrequest} <= {read, write, waitrequest};
end

// The current access so far: accepted transfers, cycles, cycles of waitrequest.
wire taken = (read || write) && !waitrequest, done = psel && penable && pready;
reg outstanding;
reg [1:0] transfers;
reg [7:0] age, waited, since;
always @(posedge clk) begin
    if (reset || !psel || done) begin
        transfers <= 0;
        {age, waited} <= 0;
    end
    else begin
        transfers <= transfers + taken;
        age <= age + 1;
        waited <= waited + ((read || write) && waitrequest);
    end
    outstanding <= !reset && (outstanding ? !readdatavalid : read && taken);
    since <= outstanding ? since + 1 : 1;
end

always @* begin
    if (!known) assume (reset);
    if (reset) assume (!psel);
    if (known && !last_reset && !reset && last_psel && !(last_penable && last_pready))
        assume (psel && penable && pwrite == last_pwrite && paddr == last_paddr && pwdata == last_pwdata
            && pstrb == last_pstrb);
    if (known && (last_reset || !last_psel || (last_penable && last_pready))) assume (!penable || !psel);
    if (known && !outstanding) assume (!readdatavalid);
    if (known && outstanding && since == MOST_LATENCY) assume (readdatavalid);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
end

always @* if (known && !last_reset && !reset) begin
    // Read and write exclude each other, and come only with a matching access of the requester.
    assert (!(read && write));
    if (read || write) assert (psel && write == pwrite && address == paddr[ADDRESS_BITS+1:2]);
    if (write) assert (writedata == pwdata && byteenable == pstrb);
    if (outstanding) assert (!read && !write);
    // An access is ready once, with one transfer: a write when it is accepted, a read with its answer. Never an error.
    if (done) assert (transfers + taken == 1);
    if (psel && !done) assert (!(write && taken) && transfers + taken <= 1);
    if (done && !pwrite) assert (outstanding && readdatavalid && prdata == readdata);
    if (readdatavalid) assert (done);
    assert (!pslverr);
    // Within the bounds.
    if (psel) assert (age <= MOST_WAIT + MOST_LATENCY + pwrite);
end

// A transfer is stable while it waits.
always @* if (known && !reset && !last_reset && (last_read || last_write) && last_waitrequest)
    assert (read == last_read && write == last_write);

// Invariants.
(* hierconn *) wire \bridge.reading ;
always @* if (known && !reset && !last_reset) begin
    assert (\bridge.reading == outstanding && transfers == outstanding);
    if (outstanding) assert (psel && penable && !pwrite && since >= 1 && since <= MOST_LATENCY && waited <= MOST_WAIT);
    if (outstanding) assert (age == waited + since);
    if (psel && !outstanding) assert (age == waited + (pwrite && penable) && waited <= MOST_WAIT);
    if (psel) assert (penable == (age != 0));
    if (!psel) assert (!outstanding && age == 0 && waited == 0);
end
always @* if (known && last_reset) assert (!\bridge.reading && !outstanding && transfers == 0 && age == 0 && waited == 0);

// Covers a read that waits and is answered late, and right after it a write of some bytes that waits.
reg was_read = 0, after_read = 0;
always @(posedge clk) begin
    was_read <= !reset && done && !pwrite && waited == MOST_WAIT && since == MOST_LATENCY;
    after_read <= !reset && psel && !done && (was_read || after_read);
end
always @* cover (after_read && done && pwrite && pstrb == 4'b0110 && waited == MOST_WAIT);
endmodule
