// SPDX-License-Identifier: MIT
// AXI4-Lite through the bridge to an agent: the manager's handshakes, the agent's transfers, and the responses.
//
// Assumed: valid is low in reset, and once high it stays high, with the same payload, until it is accepted, as AXI
// requires. The agent asserts waitrequest for at most MOST_WAIT cycles per transfer, and answers a read with one
// readdatavalid, 2 to MOST_LATENCY cycles after it accepted it; readdata changes with an answer only. bready and rready
// are arbitrary. One cycle of reset at first; it may come again at any time.
//
// [proof]
// claim = "a write and a read at a time are one transfer each, answered once, in time, and held until accepted"
// modules = ["axi4lite_bridge"]
// induction = "2 * MOST_WAIT + MOST_LATENCY + 5"  # the two directions wait for each other, limited only by the bounds
// reach = "3 * (MOST_WAIT + MOST_LATENCY) + 8"
// label = "{ADDRESS_BITS} bits, {MOST_WAIT} and {MOST_LATENCY} cycles"
// quick = ["alone=axi4lite MOST_WAIT=1 MOST_LATENCY=2"]
// designs = ["alone=axi4lite one-unit rectangles=32 MOST_WAIT=3 MOST_LATENCY=4"]
// [faults]
// "6 bits, 1 and 2 cycles" = ["axi4lite_bridge.writing or write_taken", "axi4lite_bridge.writing or s_axi_awvalid",
//   "axi4lite_bridge.responding and s_axi_bready", "axi4lite_bridge.s_axi_bready 1",
//   "axi4lite_bridge.avm_m0_waitrequest 0", "axi4lite_bridge.s_axi_awaddr as s_axi_araddr",
//   "axi4lite_bridge.answer_kept 0", "axi4lite_bridge.asking or answer_kept", "axi4lite_bridge.read_waits 0",
//   "axi4lite_bridge.reading 1"]

module axi4lite_transfers;
axi4lite_bridge bridge (.*);
wire read = avm_m0_read, write = avm_m0_write, waitrequest = avm_m0_waitrequest, answers = avm_m0_readdatavalid;

// Handshakes of each channel, and valid that waits for ready; the latter and others in the previous cycle.
wire aw = s_axi_awvalid && s_axi_awready, w = s_axi_wvalid && s_axi_wready, b = s_axi_bvalid && s_axi_bready;
wire ar = s_axi_arvalid && s_axi_arready, r = s_axi_rvalid && s_axi_rready;
wire aw_waits = s_axi_awvalid && !s_axi_awready, w_waits = s_axi_wvalid && !s_axi_wready;
wire ar_waits = s_axi_arvalid && !s_axi_arready, b_waits = s_axi_bvalid && !s_axi_bready;
wire r_waits = s_axi_rvalid && !s_axi_rready;

// For each kind, transfers that the agent has accepted and that wait for the manager's handshake, and handshakes that
// wait for a response; for a read, the agent's answer.
wire write_taken = write && !waitrequest, read_taken = read && !waitrequest;
reg [1:0] writes_at_agent, addresses, words, reads_at_agent, asked, outstanding;
reg [7:0] waited, since, write_age, read_age;
reg answered;
reg [31:0] answer;
always @(posedge clk) begin
    if (reset) begin
        {writes_at_agent, addresses, words, reads_at_agent, asked, outstanding} <= 0;
        {waited, since, write_age, read_age, answered} <= 0;
    end
    else begin
        writes_at_agent <= writes_at_agent + write_taken - aw;
        addresses <= addresses + aw - b;
        words <= words + w - b;
        reads_at_agent <= reads_at_agent + read_taken - ar;
        asked <= asked + ar - r;
        outstanding <= outstanding + read_taken - answers;
        waited <= (read || write) && waitrequest ? waited + 1 : 0;
        since <= outstanding ? since + 1 : 1;
        write_age <= s_axi_awvalid && s_axi_wvalid && !aw && !b_waits ? write_age + 1 : 0;
        read_age <= s_axi_arvalid && !ar && !r_waits ? read_age + 1 : 0;
        answered <= (answers || answered) && !r;
    end
    if (answers) answer <= avm_m0_readdata;
end

always @* begin
    if (reset) assume (!s_axi_awvalid && !s_axi_wvalid && !s_axi_arvalid);
    if (known && !$past(reset) && !reset) begin
        if ($past(aw_waits)) assume (s_axi_awvalid && $stable(s_axi_awaddr));
        if ($past(w_waits)) assume (s_axi_wvalid && $stable(s_axi_wdata) && $stable(s_axi_wstrb));
        if ($past(ar_waits)) assume (s_axi_arvalid && $stable(s_axi_araddr));
    end
    if (known && (outstanding == 0 || since < 2)) assume (!answers);
    if (known && outstanding != 0 && since == MOST_LATENCY) assume (answers);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
    if (known && !$past(reset) && !answers) assume ($stable(avm_m0_readdata));
end

always @* if (known && !$past(reset) && !reset) begin
    // A transfer has all that the manager presents.
    assert (!(read && write));
    if (write) begin
        assert (s_axi_awvalid && s_axi_wvalid && avm_m0_address == s_axi_awaddr[ADDRESS_BITS+1:2]);
        assert (avm_m0_writedata == s_axi_wdata && avm_m0_byteenable == s_axi_wstrb);
    end
    if (read) assert (s_axi_arvalid && avm_m0_address == s_axi_araddr[ADDRESS_BITS+1:2]);
    // Each write is one transfer, followed by its handshakes: none is lost, none comes twice.
    assert (writes_at_agent <= 1 && aw == (writes_at_agent == 1) && w == aw);
    if (writes_at_agent == 1) assert (!write);
    assert (reads_at_agent <= 1 && ar == (reads_at_agent == 1));
    if (reads_at_agent == 1) assert (!read);
    // Each has one response, after its handshakes.
    assert (addresses <= 1 && words == addresses && s_axi_bvalid == (addresses == 1));
    assert (asked <= 1 && outstanding <= 1);
    if (s_axi_rvalid) assert (asked == 1 && !ar && s_axi_rdata == (answers ? avm_m0_readdata : answer));
    if (answers) assert (s_axi_rvalid);
    assert (s_axi_bresp == 0 && s_axi_rresp == 0);
    // Within the bounds, from when the manager last held up the previous response.
    assert (write_age <= 2 * MOST_WAIT + 1);
    assert (read_age <= 2 * MOST_WAIT + MOST_LATENCY + 3);
    // Responses, and transfers that wait, are stable.
    if ($past(b_waits)) assert (s_axi_bvalid);
    if ($past(r_waits)) assert (s_axi_rvalid && $stable(s_axi_rdata));
    if (($past(read) || $past(write)) && $past(waitrequest))
        assert ($stable(read) && $stable(write) && $stable(avm_m0_address));
end
always @* if (known && $past(reset)) assert (!s_axi_bvalid && (!s_axi_rvalid || answers));

// No input from the manager affects an output to it in the same cycle.
always @* if (known) begin
    assert (s_axi_awready == bridge.write_taken && s_axi_wready == bridge.write_taken);
    assert (s_axi_arready == bridge.read_taken && s_axi_bvalid == bridge.responding);
    assert (s_axi_rvalid == (answers || bridge.answer_kept) && s_axi_rdata == avm_m0_readdata);
end

// Invariants.
always @* if (known && !$past(reset) && !reset) begin
    assert (bridge.reading == outstanding && bridge.answer_kept == answered);
    if (answered) assert (answer == $past(avm_m0_readdata));
    assert (asked + reads_at_agent == outstanding + answered);
    if (outstanding) assert (since >= 1 && since <= MOST_LATENCY && !answered);
    assert (waited <= MOST_WAIT && (waited != 0) == (($past(read) || $past(write)) && $past(waitrequest)));
    assert (bridge.read_waits == ($past(read) && $past(waitrequest)));
    assert (writes_at_agent == ($past(write) && !$past(waitrequest)));
    assert (reads_at_agent == ($past(read) && !$past(waitrequest)));
end

// Covers a write of some bytes that waits, right after a response that waited, and a read after a write.
reg waited_response = 0, waited_answer = 0;
always @(posedge clk) begin
    waited_response <= !reset && (($past(b_waits) && b) || (waited_response && !b));
    waited_answer <= !reset && (($past(r_waits) && r) || (waited_answer && !r));
end
always @* if (known && !reset && !$past(reset)) begin
    cover (waited_response && write_taken && waited == MOST_WAIT && s_axi_wstrb == 4'b0110);
    cover (waited_answer && s_axi_rvalid && since == MOST_LATENCY + 1 && s_axi_bvalid);
end
endmodule
