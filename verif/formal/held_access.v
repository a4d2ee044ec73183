// SPDX-License-Identifier: MIT
// A bridge whose requester holds each access until it is done, for host_transfers and apb_transfers.
always @* begin
    if (known && !$past(reset) && !reset && $past(active) && !$past(done)) assume (active && $stable(request));
    if (known && !reset && readdatavalid) assert (done);
end

// Invariants.
always @* if (known && !reset && !$past(reset)) begin
    assert (transfers == outstanding);
    if (!active) assert (age == 0 && waited == 0);
    if (outstanding) assert (active && !is_write && age == waited + since);
end

// Covers a read that waits and is answered late, and right after it a write of some bytes that waits.
reg was_read = 0, after_read = 0;
always @(posedge clk) begin
    was_read <= !reset && done && !is_write && waited == MOST_WAIT && since == MOST_LATENCY;
    after_read <= !reset && active && !done && (was_read || after_read);
end
always @* cover (after_read && done && is_write && bytes == 4'b0110 && waited == MOST_WAIT);
