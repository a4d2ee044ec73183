// SPDX-License-Identifier: MIT
// The Avalon-MM side of a bridge, included by the properties of each bus. They declare `active`, an access of the
// requester, which ends with its cycle `done`, or when the requester gives it up; `is_write`, `at`, `bytes` and `data`,
// which the access asks for; and `answer`, the word that a read gets.
//
// Assumed: the agent asserts waitrequest for at most MOST_WAIT cycles per transfer, and answers a read with one
// readdatavalid, 1 to MOST_LATENCY cycles after it accepted it, and nothing else. One cycle of reset at first; it may
// come again at any time.
wire read = avm_m0_read, write = avm_m0_write, waitrequest = avm_m0_waitrequest, readdatavalid = avm_m0_readdatavalid;
wire taken = (read || write) && !waitrequest;
wire [ADDRESS_BITS+36:0] request = {is_write, at, bytes, data};

// The previous cycle; of the current access, accepted transfers, cycles, and cycles of waitrequest; cycles since an
// unanswered read was accepted.
reg outstanding;
reg [1:0] transfers;
reg [7:0] age, waited, since;
always @(posedge clk) begin
    if (reset || !active || done) {transfers, age, waited} <= 0;
    else begin
        transfers <= transfers + taken;
        age <= age + 1;
        waited <= waited + ((read || write) && waitrequest);
    end
    outstanding <= !reset && (outstanding ? !readdatavalid : read && taken);
    since <= outstanding ? since + 1 : 1;
end
always @* begin
    if (known && !outstanding) assume (!readdatavalid);
    if (known && outstanding && since == MOST_LATENCY) assume (readdatavalid);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
end

always @* if (known && !$past(reset) && !reset) begin
    // Read and write exclude each other, come only with an access, and nothing overtakes the read that is outstanding.
    assert (!(read && write));
    if (read || write) assert (active && !outstanding);
    // An access is done once, with one transfer: no write is lost or repeated, no read gets the answer of another.
    if (done) assert (active && transfers + taken == 1);
    if (!done) assert (!(write && taken) && transfers + taken <= 1);
    // A transfer is stable while it waits.
    if (active && ($past(read) || $past(write)) && $past(waitrequest)) assert ($stable(read) && $stable(write));
    // Invariants.
    assert (waited <= MOST_WAIT);
    if (outstanding) assert (since >= 1 && since <= MOST_LATENCY);
end
always @* if (known && !reset) begin
    // A transfer has the kind, address, bytes and data of the access.
    if (read || write) assert (write == is_write && avm_m0_address == at);
    if (write) assert (avm_m0_writedata == data && avm_m0_byteenable == bytes);
    if (done && !is_write) assert (outstanding && readdatavalid && answer == avm_m0_readdata);
end
always @* if (known && $past(reset)) assert (!outstanding && transfers == 0 && age == 0 && waited == 0);
