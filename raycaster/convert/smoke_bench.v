// SPDX-License-Identifier: MIT
// A first simulation in your own tools: does the design answer on the bus, and does it draw lines of the right length?
// It prints one verdict, PASS or FAIL, and ends. Checking the picture takes a bench with a model of it.

`timescale 1ns / 1ns

module smoke_bench #(
    // The values are those of the design that was written together with this bench.
    parameter ADDRESS_BITS = 0,     // width of the bus's word address
    parameter COLOUR_BITS = 0,      // bits per channel, of all pixels in a clock
    parameter H_TOTAL = 0,          // pixel clocks per line, blanking included
    parameter H_SYNC = 0,           // pixel clocks of the HS pulse
    parameter HS_ACTIVE = 0,        // level of HS in the pulse
    parameter SIZE = 0,             // expected value of the register with the design's size
    parameter BIT_NS = 0,           // time of a bit on a serial bus
    parameter ASKED = 0,            // bytes of a frame that reads the first four registers, the first in the low bits
    parameter ANSWER = 0            // bytes of the frame that answers
) ();
    localparam IDENTIFICATION = 0, SIZE_ADDRESS = 3;
    localparam MAGIC = 32'h52415943;
    localparam LINES = 3;
    localparam PATIENCE = 2 * H_TOTAL * (LINES + 1);    // clocks, at most two per pixel clock

    reg clk = 1'b0, reset = 1'b1;
    always #10 clk = ~clk;
    integer faults = 0, waited = 0;
    wire irq;

`ifdef BUS_UART
    reg rx = 1'b1;
    wire tx;
`else
    // The bus: read is high with the address, and readdata is valid while answered is high.
    reg [ADDRESS_BITS-1:0] address = 0;
    reg read = 1'b0;
    wire [31:0] readdata;
    wire taken, answered;
`ifdef BUS_AXI4LITE
    localparam HOLD = 0;        // 1: the request stays until the answer
    wire arready;
    assign taken = arready;
`elsif BUS_WISHBONE
    localparam HOLD = 1;
    assign taken = 1'b1;
`elsif BUS_APB
    localparam HOLD = 1;
    reg enable = 1'b0;
    always @(posedge clk) enable <= read && !answered;
    wire ready;
    assign taken = 1'b1, answered = enable && ready;
`else
    localparam HOLD = 0;
    wire waitrequest;
    assign taken = !waitrequest;
`endif
`endif
    wire [COLOUR_BITS-1:0] vga_r, vga_g, vga_b;
    wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk;

    ray_caster_module dut (
        .clk(clk),
        .reset(reset),
`ifdef BUS_AXI4LITE
        .s_axi_awaddr({ADDRESS_BITS+2{1'b0}}),
        .s_axi_awvalid(1'b0),
        .s_axi_awready(),
        .s_axi_wdata(32'b0),
        .s_axi_wstrb(4'b0),
        .s_axi_wvalid(1'b0),
        .s_axi_wready(),
        .s_axi_bresp(),
        .s_axi_bvalid(),
        .s_axi_bready(1'b1),
        .s_axi_araddr({address, 2'b0}),
        .s_axi_arvalid(read),
        .s_axi_arready(arready),
        .s_axi_rdata(readdata),
        .s_axi_rresp(),
        .s_axi_rvalid(answered),
        .s_axi_rready(1'b1),
`elsif BUS_WISHBONE
        .wb_cyc(read),
        .wb_stb(read),
        .wb_we(1'b0),
        .wb_ack(answered),
        .wb_adr(address),
        .wb_sel(4'b1111),
        .wb_dat_w(32'b0),
        .wb_dat_r(readdata),
`elsif BUS_APB
        .s_apb_paddr({address, 2'b0}),
        .s_apb_psel(read),
        .s_apb_penable(enable),
        .s_apb_pwrite(1'b0),
        .s_apb_pready(ready),
        .s_apb_pslverr(),
        .s_apb_pwdata(32'b0),
        .s_apb_pstrb(4'b0),
        .s_apb_prdata(readdata),
`elsif BUS_UART
        .uart_rx(rx),
        .uart_tx(tx),
`else
        .avs_s0_address(address),
        .avs_s0_read(read),
        .avs_s0_write(1'b0),
        .avs_s0_writedata(32'b0),
        .avs_s0_byteenable(4'b1111),
        .avs_s0_readdata(readdata),
        .avs_s0_readdatavalid(answered),
        .avs_s0_waitrequest(waitrequest),
`endif
        .irq(irq),
        .vga_r(vga_r),
        .vga_g(vga_g),
        .vga_b(vga_b),
        .vga_hs(vga_hs),
        .vga_vs(vga_vs),
        .vga_blank_n(vga_blank_n),
        .vga_sync_n(vga_sync_n),
        .vga_clk(vga_clk)
    );

`ifdef BUS_UART
    reg [8*64-1:0] left, wanted;
    reg [7:0] heard;
    integer sent_bits, heard_bits;

    // Ask once, and compare each byte of the answer.
    task talk;
        begin
            for (left = ASKED; left != 0; left = left >> 8)
                for (sent_bits = 0; sent_bits < 10; sent_bits = sent_bits + 1) begin
                    rx = sent_bits == 0 ? 1'b0 : sent_bits == 9 ? 1'b1 : left[sent_bits - 1];
                    #(BIT_NS);
                end
            for (wanted = ANSWER; wanted != 0 && waited < PATIENCE; wanted = wanted >> 8) begin
                for (waited = 0; tx !== 1'b0 && waited < PATIENCE; waited = waited + 1) @(negedge clk);
                #(BIT_NS / 2);
                for (heard_bits = 0; heard_bits < 8; heard_bits = heard_bits + 1)
                    #(BIT_NS) heard[heard_bits] = tx;
                #(BIT_NS);
                if (heard !== wanted[7:0]) begin
                    $display("the answer has %h, expected %h", heard, wanted[7:0]);
                    faults = faults + 1;
                end
            end
        end
    endtask
`else
    task expect_word(input [ADDRESS_BITS-1:0] at, input [31:0] expected);
        begin
            @(negedge clk) begin
                address = at;
                read = 1'b1;
                waited = 0;
            end
            #1;
            while (taken !== 1'b1 && waited < PATIENCE) @(negedge clk) waited = waited + 1;
            if (!HOLD) @(negedge clk) read = 1'b0;
            while (answered !== 1'b1 && waited < PATIENCE) @(negedge clk) waited = waited + 1;
            if (waited >= PATIENCE) begin
                $display("address %0d: no answer in %0d clocks", at, PATIENCE);
                faults = faults + 1;
            end else if (readdata !== expected) begin
                $display("address %0d reads %h, expected %h", at, readdata, expected);
                faults = faults + 1;
            end
            if (HOLD) @(negedge clk) read = 1'b0;
        end
    endtask
`endif

    // Measure lines in pixel clocks.
    wire hs_active = vga_hs == HS_ACTIVE[0];
    reg hs_was_active = 1'b0;
    integer pixels = 0, pulse = 0, lines = 0;
    always @(posedge vga_clk) begin
        if (hs_active && !hs_was_active) begin
            if (lines > 0 && (pixels != H_TOTAL || pulse != H_SYNC)) begin
                $display("a line of %0d pixels, %0d of them sync; expected %0d and %0d", pixels, pulse, H_TOTAL,
                    H_SYNC);
                faults = faults + 1;
            end
            lines = lines + 1;
            pixels = 0;
            pulse = 0;
        end
        hs_was_active = hs_active;
        pixels = pixels + 1;
        if (hs_active) pulse = pulse + 1;
    end

    initial begin
        repeat (4) @(negedge clk);
        reset = 1'b0;
`ifdef BUS_UART
        talk;
`else
        expect_word(IDENTIFICATION, MAGIC);
        expect_word(SIZE_ADDRESS, SIZE);
`endif
        repeat (PATIENCE) @(negedge clk);
        if (lines < LINES) begin
            $display("%0d lines, expected %0d or more", lines, LINES);
            faults = faults + 1;
        end
        if (faults == 0) $display("PASS: %0d lines, and the bus answers", lines);
        else begin
            $display("FAIL: %0d faults", faults);
            $stop;                  // makes simulators that run unattended end in an error
        end
        $finish;
    end
endmodule
