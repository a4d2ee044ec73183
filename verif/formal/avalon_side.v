// SPDX-License-Identifier: MIT
// The Avalon-MM side of a bridge, included by the properties of each bus. They declare `active`, an access of the
// requester, which ends with its cycle `done`, or when the requester gives it up.
//
// Assumed: the agent asserts waitrequest for at most MOST_WAIT cycles per transfer, and answers a read with one
// readdatavalid, 1 to MOST_LATENCY cycles after it accepted it, and nothing else. One cycle of reset at first; it may
// come again at any time.
wire taken = (read || write) && !waitrequest;

// The previous cycle; of the current access, accepted transfers, cycles, and cycles of waitrequest; cycles since an
// unanswered read was accepted.
reg known = 0;
reg last_reset, last_read, last_write, last_waitrequest, outstanding;
reg [1:0] transfers;
reg [7:0] age, waited, since;
always @(posedge clk) begin
    known <= 1;
    {last_reset, last_read, last_write, last_waitrequest} <= {reset, read, write, waitrequest};
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
    if (!known) assume (reset);
    if (known && !outstanding) assume (!readdatavalid);
    if (known && outstanding && since == MOST_LATENCY) assume (readdatavalid);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
end

always @* if (known && !last_reset && !reset) begin
    // Read and write exclude each other, come only with an access, and nothing overtakes the read that is outstanding.
    assert (!(read && write));
    if (read || write) assert (active && !outstanding);
    // An access is done once, with one transfer: no write is lost or repeated, no read gets the answer of another.
    if (done) assert (active && transfers + taken == 1);
    if (!done) assert (!(write && taken) && transfers + taken <= 1);
    // A transfer is stable while it waits.
    if (active && (last_read || last_write) && last_waitrequest) assert (read == last_read && write == last_write);
    // Invariants.
    assert (waited <= MOST_WAIT);
    if (outstanding) assert (since >= 1 && since <= MOST_LATENCY);
end
always @* if (known && last_reset) assert (!outstanding && transfers == 0 && age == 0 && waited == 0);
