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

module axi4lite_transfers #(parameter ADDRESS_BITS = 4, parameter MOST_WAIT = 1, parameter MOST_LATENCY = 2) (
    input clk, input reset,
    input [ADDRESS_BITS+1:0] awaddr, input awvalid, input [31:0] wdata, input [3:0] wstrb, input wvalid, input bready,
    input [ADDRESS_BITS+1:0] araddr, input arvalid, input rready,
    input [31:0] readdata, input readdatavalid, input waitrequest
);
wire awready, wready, bvalid, arready, rvalid, read, write;
wire [1:0] bresp, rresp;
wire [31:0] rdata, writedata;
wire [3:0] byteenable;
wire [ADDRESS_BITS-1:0] address;
axi4lite_bridge bridge (
    .clk(clk), .reset(reset), .s_axi_awaddr(awaddr), .s_axi_awvalid(awvalid), .s_axi_awready(awready),
    .s_axi_wdata(wdata), .s_axi_wstrb(wstrb), .s_axi_wvalid(wvalid), .s_axi_wready(wready), .s_axi_bresp(bresp),
    .s_axi_bvalid(bvalid), .s_axi_bready(bready), .s_axi_araddr(araddr), .s_axi_arvalid(arvalid),
    .s_axi_arready(arready), .s_axi_rdata(rdata), .s_axi_rresp(rresp), .s_axi_rvalid(rvalid), .s_axi_rready(rready),
    .avm_m0_address(address), .avm_m0_read(read), .avm_m0_write(write), .avm_m0_writedata(writedata),
    .avm_m0_byteenable(byteenable), .avm_m0_readdata(readdata), .avm_m0_readdatavalid(readdatavalid),
    .avm_m0_waitrequest(waitrequest)
);

// The previous cycle.
reg known = 0;
reg last_reset, last_awvalid, last_awready, last_wvalid, last_wready, last_bvalid, last_bready, last_arvalid,
    last_arready, last_rvalid, last_rready, last_read, last_write, last_waitrequest;
reg [ADDRESS_BITS+1:0] last_awaddr, last_araddr;
reg [ADDRESS_BITS-1:0] last_address;
reg [31:0] last_wdata, last_rdata, last_readdata;
reg [3:0] last_wstrb;
always @(posedge clk) begin
    known <= 1;
    {last_reset, last_read, last_write, last_waitrequest} <= {reset, read, write, waitrequest};
    {last_awvalid, last_awready, last_awaddr} <= {awvalid, awready, awaddr};
    {last_wvalid, last_wready, last_wdata, last_wstrb} <= {wvalid, wready, wdata, wstrb};
    {last_bvalid, last_bready} <= {bvalid, bready};
    {last_arvalid, last_arready, last_araddr} <= {arvalid, arready, araddr};
    {last_rvalid, last_rready, last_rdata, last_readdata} <= {rvalid, rready, rdata, readdata};
    last_address <= address;
end

// For each kind, transfers that the agent has accepted and that wait for the manager's handshake, and handshakes that
// wait for a response; for a read, the agent's answer.
wire write_taken = write && !waitrequest, read_taken = read && !waitrequest;
wire aw = awvalid && awready, w = wvalid && wready, b = bvalid && bready, ar = arvalid && arready, r = rvalid && rready;
reg [1:0] writes_at_agent, addresses, words, responses, reads_at_agent, asked, outstanding;
reg [7:0] waited, since, write_age, read_age;
reg answered;
reg [31:0] answer;
wire blocked_write = bvalid && !bready, blocked_read = rvalid && !rready;
always @(posedge clk) begin
    if (reset) begin
        {writes_at_agent, addresses, words, responses, reads_at_agent, asked, outstanding} <= 0;
        {waited, since, write_age, read_age, answered} <= 0;
    end
    else begin
        writes_at_agent <= writes_at_agent + write_taken - aw;
        addresses <= addresses + aw - b;
        words <= words + w - b;
        reads_at_agent <= reads_at_agent + read_taken - ar;
        asked <= asked + ar - r;
        outstanding <= outstanding + read_taken - readdatavalid;
        waited <= (read || write) && waitrequest ? waited + 1 : 0;
        since <= outstanding ? since + 1 : 1;
        write_age <= awvalid && wvalid && !aw && !blocked_write ? write_age + 1 : 0;
        read_age <= arvalid && !ar && !blocked_read ? read_age + 1 : 0;
        answered <= (readdatavalid || answered) && !r;
    end
    if (readdatavalid) answer <= readdata;
end

always @* begin
    if (!known) assume (reset);
    if (reset) assume (!awvalid && !wvalid && !arvalid);
    if (known && !last_reset && !reset) begin
        if (last_awvalid && !last_awready) assume (awvalid && awaddr == last_awaddr);
        if (last_wvalid && !last_wready) assume (wvalid && wdata == last_wdata && wstrb == last_wstrb);
        if (last_arvalid && !last_arready) assume (arvalid && araddr == last_araddr);
    end
    if (known && outstanding == 0) assume (!readdatavalid);
    if (known && outstanding != 0 && since < 2) assume (!readdatavalid);
    if (known && outstanding != 0 && since == MOST_LATENCY) assume (readdatavalid);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
    if (known && !last_reset && !readdatavalid) assume (readdata == last_readdata);
end

always @* if (known && !last_reset && !reset) begin
    // A transfer has all that the manager presents.
    assert (!(read && write));
    if (write) assert (awvalid && wvalid && address == awaddr[ADDRESS_BITS+1:2] && writedata == wdata
        && byteenable == wstrb);
    if (read) assert (arvalid && address == araddr[ADDRESS_BITS+1:2]);
    // Each write is one transfer, followed by its handshakes: none is lost, none comes twice.
    assert (writes_at_agent <= 1 && aw == (writes_at_agent == 1) && w == aw);
    if (writes_at_agent == 1) assert (!write);
    assert (reads_at_agent <= 1 && ar == (reads_at_agent == 1));
    if (reads_at_agent == 1) assert (!read);
    // Each has one response, after its handshakes.
    assert (addresses <= 1 && words == addresses && bvalid == (addresses == 1));
    assert (asked <= 1 && outstanding <= 1);
    if (rvalid) assert (asked == 1 && !ar && rdata == (readdatavalid ? readdata : answer));
    if (readdatavalid) assert (rvalid);
    assert (bresp == 0 && rresp == 0);
    // Within the bounds, from when the manager last held up the previous response.
    assert (write_age <= 2 * MOST_WAIT + 1);
    assert (read_age <= 2 * MOST_WAIT + MOST_LATENCY + 3);
end

// Responses, and transfers that wait, are stable.
always @* if (known && !last_reset && !reset) begin
    if (last_bvalid && !last_bready) assert (bvalid);
    if (last_rvalid && !last_rready) assert (rvalid && rdata == last_rdata);
    if ((last_read || last_write) && last_waitrequest)
        assert (read == last_read && write == last_write && address == last_address);
end
always @* if (known && last_reset) assert (!bvalid && (!rvalid || readdatavalid));

// No input from the manager affects an output to it in the same cycle.
(* hierconn *) wire \bridge.write_taken , \bridge.read_taken , \bridge.responding , \bridge.answer_kept ,
    \bridge.reading , \bridge.read_waits ;
always @* if (known) begin
    assert (awready == \bridge.write_taken && wready == \bridge.write_taken && arready == \bridge.read_taken );
    assert (bvalid == \bridge.responding && rvalid == (readdatavalid || \bridge.answer_kept ) && rdata == readdata);
end

// Invariants.
always @* if (known && !last_reset && !reset) begin
    assert (\bridge.reading == outstanding && \bridge.answer_kept == answered);
    if (answered) assert (answer == last_readdata);
    assert (asked + reads_at_agent == outstanding + answered);
    if (outstanding) assert (since >= 1 && since <= MOST_LATENCY && !answered);
    assert (waited <= MOST_WAIT);
    if (waited != 0) assert (last_waitrequest && (last_read || last_write));
    if (waited == 0) assert (!((last_read || last_write) && last_waitrequest));
    assert (\bridge.read_waits == (last_read && last_waitrequest));
    assert (last_reset || writes_at_agent == (last_write && !last_waitrequest));
    assert (last_reset || reads_at_agent == (last_read && !last_waitrequest));
end

// Covers a write of some bytes that waits, right after a response that waited, and a read after a write.
reg waited_response = 0, waited_answer = 0;
always @(posedge clk) begin
    waited_response <= !reset && ((last_bvalid && !last_bready && b) || (waited_response && !b));
    waited_answer <= !reset && ((last_rvalid && !last_rready && r) || (waited_answer && !r));
end
always @* if (known && !reset && !last_reset) begin
    cover (waited_response && write_taken && waited == MOST_WAIT && wstrb == 4'b0110);
    cover (waited_answer && rvalid && since == MOST_LATENCY + 1 && bvalid);
end
endmodule
