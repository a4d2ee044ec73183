// SPDX-License-Identifier: MIT
// APB through the bridge to an agent: the requester's accesses, the agent's transfers, and the answers.
//
// Assumed: an access has a setup phase of one cycle and is then held, with penable, until it is ready, as APB requires.
//
// [proof]
// claim = "each access is one transfer, stable while it waits, and ready once, in time"
// modules = ["apb_bridge"]
// induction = 2
// reach = "3 * (MOST_WAIT + MOST_LATENCY) + 8"
// label = "{ADDRESS_BITS} bits, {MOST_WAIT} and {MOST_LATENCY} cycles"
// quick = ["alone=apb MOST_WAIT=1 MOST_LATENCY=2"]
// designs = ["alone=apb one-unit rectangles=32 MOST_WAIT=3 MOST_LATENCY=4"]
// [faults]
// "6 bits, 1 and 2 cycles" = ["apb_bridge.s_apb_penable 1", "apb_bridge.reading 0",
//   "apb_bridge.s_apb_pready as s_apb_pwrite", "apb_bridge.avm_m0_waitrequest 0",
//   "apb_bridge.s_apb_pslverr as avm_m0_waitrequest"]

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
wire active = psel, done = psel && penable && pready;
`include "avalon_side.v"

reg last_psel, last_done, last_pwrite;
reg [ADDRESS_BITS+1:0] last_paddr;
reg [31:0] last_pwdata;
reg [3:0] last_pstrb;
always @(posedge clk) begin
    {last_psel, last_done, last_pwrite} <= {psel, done, pwrite};
    {last_paddr, last_pwdata, last_pstrb} <= {paddr, pwdata, pstrb};
end
always @* begin
    if (reset) assume (!psel);
    if (known && !last_reset && !reset && last_psel && !last_done)
        assume (psel && penable && pwrite == last_pwrite && paddr == last_paddr && pwdata == last_pwdata
            && pstrb == last_pstrb);
    if (known && (last_reset || !last_psel || last_done)) assume (!penable || !psel);
end

always @* if (known && !last_reset && !reset) begin
    // A transfer has the kind, address, bytes and data of the access. Never an error.
    if (read || write) assert (write == pwrite && address == paddr[ADDRESS_BITS+1:2]);
    if (write) assert (writedata == pwdata && byteenable == pstrb);
    if (done && !pwrite) assert (outstanding && readdatavalid && prdata == readdata);
    if (readdatavalid) assert (done);
    assert (!pslverr);
    // Within the bounds.
    if (psel) assert (age <= MOST_WAIT + MOST_LATENCY + pwrite);
end

// Invariants.
(* hierconn *) wire \bridge.reading ;
always @* if (known) assert (\bridge.reading == outstanding);
always @* if (known && !reset && !last_reset) begin
    assert (transfers == outstanding);
    if (!active) assert (age == 0 && waited == 0);
    if (outstanding) assert (psel && penable && !pwrite && age == waited + since);
    if (psel && !outstanding) assert (age == waited + (pwrite && penable));
    if (psel) assert (penable == (age != 0));
end

// Covers a read that waits and is answered late, and right after it a write of some bytes that waits.
reg was_read = 0, after_read = 0;
always @(posedge clk) begin
    was_read <= !reset && done && !pwrite && waited == MOST_WAIT && since == MOST_LATENCY;
    after_read <= !reset && psel && !done && (was_read || after_read);
end
always @* cover (after_read && done && pwrite && pstrb == 4'b0110 && waited == MOST_WAIT);
endmodule
