// SPDX-License-Identifier: MIT
// The path from the processor to an Avalon-MM agent: each access is one transfer, whatever the agent does.
//
// Assumed: the processor holds an access until it is ready. The agent answers only reads that it accepted in an earlier
// cycle; waitrequest and the time to an answer are bounded, else no access would be. One cycle of reset at first, which
// may come again at any time and ends every access.

module host_transfers #(
    parameter ADDRESS_BITS = 6, parameter MOST_WAIT = 3, parameter MOST_LATENCY = 3
) (
    input clk, input reset,
    input select, input [3:0] strobe, input [ADDRESS_BITS-1:0] address, input [31:0] data,
    input [31:0] readdata, input readdatavalid, input waitrequest
);
wire ready, read, write;
wire [31:0] word, writedata;
wire [ADDRESS_BITS-1:0] bus_address;
wire [3:0] byteenable;

avalon_host host (
    .clk(clk), .reset(reset), .access_select(select), .access_ready(ready), .access_word(word), .strobe(strobe),
    .address(address), .data(data), .avm_m0_address(bus_address), .avm_m0_read(read), .avm_m0_write(write), .avm_m0_writedata(writedata),
    .avm_m0_byteenable(byteenable), .avm_m0_readdata(readdata), .avm_m0_readdatavalid(readdatavalid),
    .avm_m0_waitrequest(waitrequest)
);

// The previous cycle.
reg known = 0;
reg last_reset, last_select, last_ready, last_read, last_write, last_waitrequest;
reg [3:0] last_strobe, last_byteenable;
reg [ADDRESS_BITS-1:0] last_address, last_bus_address;
reg [31:0] last_data, last_writedata;
always @(posedge clk) begin
    known <= 1;
    {last_reset, last_select, last_ready} <= {reset, select, ready};
    {last_strobe, last_address, last_data} <= {strobe, address, data};
    {last_read, last_write, last_waitrequest} <= {read, write, waitrequest};
    {last_byteenable, last_bus_address, last_writedata} <= {byteenable, bus_address, writedata};
end

// The current access so far: accepted transfers, cycles, cycles of waitrequest, and cycles since an unanswered read was
// accepted.
wire taken = (read || write) && !waitrequest;
reg outstanding;
reg [1:0] transfers;
reg [7:0] age, waited, since;
always @(posedge clk) begin
    if (reset || !select || ready) begin
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
    else if (!last_reset && last_select && !last_ready)
        assume (select && strobe == last_strobe && address == last_address && data == last_data);
    if (known && !outstanding) assume (!readdatavalid);
    if (known && outstanding && since == MOST_LATENCY) assume (readdatavalid);
    if (known && waited == MOST_WAIT) assume (!waitrequest);
end

always @* if (known && !reset) begin
    // Read and write exclude each other, and come only with an access of the processor.
    assert (!(read && write));
    if (read) assert (select && strobe == 0);
    if (write) assert (select && strobe != 0);
    // A transfer has the address, bytes and data of the access.
    if (read || write) assert (bus_address == address);
    if (read) assert (byteenable == 4'b1111);
    if (write) assert (byteenable == strobe && writedata == data);
    // At most one read is outstanding, and nothing overtakes it.
    if (outstanding) assert (!read && !write);
    // An access is ready once, with one transfer: no write is lost or repeated, no read gets the answer of another.
    if (ready) assert (select && transfers + taken == 1);
    if (!ready) assert (!(write && taken) && transfers + taken <= 1);
    if (ready && strobe == 0) assert (outstanding && readdatavalid && word == readdata);
    if (readdatavalid) assert (ready);
    // Within the bounds.
    if (select) assert (age <= MOST_WAIT + MOST_LATENCY);
end

// A transfer is stable while it waits.
always @* if (known && !reset && !last_reset && (last_read || last_write) && last_waitrequest)
    assert (read == last_read && write == last_write && bus_address == last_bus_address
        && byteenable == last_byteenable && (!write || writedata == last_writedata));

// Invariants.
(* hierconn *) wire \host.waiting ;
always @* if (known && !reset && !last_reset) begin
    assert (\host.waiting == outstanding);
    assert (transfers == outstanding);
    if (outstanding) assert (select && strobe == 0 && since >= 1 && since <= MOST_LATENCY && waited <= MOST_WAIT);
    if (outstanding) assert (age == waited + since);
    if (select && !outstanding) assert (age == waited && waited <= MOST_WAIT);
    if (!select) assert (!outstanding && age == 0 && waited == 0);
end
always @* if (known && last_reset) assert (!\host.waiting && !outstanding && transfers == 0 && age == 0 && waited == 0);

// Covers a read that waits and is answered late, and right after it a write of some bytes that waits.
reg was_read = 0;
always @(posedge clk) was_read <= !reset && ready && strobe == 0 && waited == MOST_WAIT && since == MOST_LATENCY;
reg after_read = 0;
always @(posedge clk) after_read <= !reset && select && !ready && (was_read || after_read);
always @* cover (after_read && ready && strobe == 4'b0110 && waited == MOST_WAIT);
endmodule
