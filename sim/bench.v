// SPDX-License-Identifier: MIT
// The bench: a clock, the design, and a line sink that hands Python a whole video line at once.
//
// Python touches only the signals marked public.

`timescale 1ns / 1ns

module bench #(
    parameter ADDRESS_BITS = 8,     // of the bus's word address
    parameter COLOUR_BITS = 8,      // of a channel
    parameter H_TOTAL = 800,        // pixels a line, blanking included
    parameter HS_ACTIVE = 0,        // level of HS in its pulse
    parameter CLOCKS_PER_PIXEL = 2, // 1 or 2
    parameter PIXELS = 1            // of a pixel clock, 1 or 2
) (`CLOCK_PORT);
    `OWN_CLOCK

    // What Python drives
    reg reset /*verilator public_flat_rw*/;
    initial reset = 1'b1;

    // What Python reads
    wire irq /*verilator public_flat_rw*/;

    // The bus, by the names that its drivers know. Python that waits for an edge of clk runs, in Verilator, when all
    // registers have changed already. So the drivers of the buses below have a clock that rises in mid-cycle: there they
    // sample what has settled, and drive what the design sees from the next edge of clk on.
    wire bus_clk /*verilator public_flat_rw*/;
    assign bus_clk = ~clk;
`ifdef BUS_AXI4LITE
    reg [ADDRESS_BITS+1:0] s_axi_awaddr /*verilator public_flat_rw*/;
    reg s_axi_awvalid /*verilator public_flat_rw*/;
    reg [31:0] s_axi_wdata /*verilator public_flat_rw*/;
    reg [3:0] s_axi_wstrb /*verilator public_flat_rw*/;
    reg s_axi_wvalid /*verilator public_flat_rw*/;
    reg s_axi_bready /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS+1:0] s_axi_araddr /*verilator public_flat_rw*/;
    reg s_axi_arvalid /*verilator public_flat_rw*/;
    reg s_axi_rready /*verilator public_flat_rw*/;
    wire s_axi_awready /*verilator public_flat_rw*/;
    wire s_axi_wready /*verilator public_flat_rw*/;
    wire [1:0] s_axi_bresp /*verilator public_flat_rw*/;
    wire s_axi_bvalid /*verilator public_flat_rw*/;
    wire s_axi_arready /*verilator public_flat_rw*/;
    wire [31:0] s_axi_rdata /*verilator public_flat_rw*/;
    wire [1:0] s_axi_rresp /*verilator public_flat_rw*/;
    wire s_axi_rvalid /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS+1:0] seen_s_axi_awaddr /*verilator public_flat_rw*/;
    reg seen_s_axi_awvalid /*verilator public_flat_rw*/;
    reg [31:0] seen_s_axi_wdata /*verilator public_flat_rw*/;
    reg [3:0] seen_s_axi_wstrb /*verilator public_flat_rw*/;
    reg seen_s_axi_wvalid /*verilator public_flat_rw*/;
    reg seen_s_axi_bready /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS+1:0] seen_s_axi_araddr /*verilator public_flat_rw*/;
    reg seen_s_axi_arvalid /*verilator public_flat_rw*/;
    reg seen_s_axi_rready /*verilator public_flat_rw*/;
    always @(posedge clk) begin
        seen_s_axi_awaddr <= s_axi_awaddr;
        seen_s_axi_awvalid <= s_axi_awvalid;
        seen_s_axi_wdata <= s_axi_wdata;
        seen_s_axi_wstrb <= s_axi_wstrb;
        seen_s_axi_wvalid <= s_axi_wvalid;
        seen_s_axi_bready <= s_axi_bready;
        seen_s_axi_araddr <= s_axi_araddr;
        seen_s_axi_arvalid <= s_axi_arvalid;
        seen_s_axi_rready <= s_axi_rready;
    end
`elsif BUS_WISHBONE
    reg wb_cyc /*verilator public_flat_rw*/;
    reg wb_stb /*verilator public_flat_rw*/;
    reg wb_we /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS-1:0] wb_adr /*verilator public_flat_rw*/;
    reg [3:0] wb_sel /*verilator public_flat_rw*/;
    reg [31:0] wb_dat_w /*verilator public_flat_rw*/;
    wire wb_ack /*verilator public_flat_rw*/;
    wire [31:0] wb_dat_r /*verilator public_flat_rw*/;
    reg seen_wb_cyc /*verilator public_flat_rw*/;
    reg seen_wb_stb /*verilator public_flat_rw*/;
    reg seen_wb_we /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS-1:0] seen_wb_adr /*verilator public_flat_rw*/;
    reg [3:0] seen_wb_sel /*verilator public_flat_rw*/;
    reg [31:0] seen_wb_dat_w /*verilator public_flat_rw*/;
    always @(posedge clk) begin
        seen_wb_cyc <= wb_cyc;
        seen_wb_stb <= wb_stb;
        seen_wb_we <= wb_we;
        seen_wb_adr <= wb_adr;
        seen_wb_sel <= wb_sel;
        seen_wb_dat_w <= wb_dat_w;
    end
`elsif BUS_APB
    reg [ADDRESS_BITS+1:0] s_apb_paddr /*verilator public_flat_rw*/;
    reg s_apb_psel /*verilator public_flat_rw*/;
    reg s_apb_penable /*verilator public_flat_rw*/;
    reg s_apb_pwrite /*verilator public_flat_rw*/;
    reg [31:0] s_apb_pwdata /*verilator public_flat_rw*/;
    reg [3:0] s_apb_pstrb /*verilator public_flat_rw*/;
    wire s_apb_pready /*verilator public_flat_rw*/;
    wire s_apb_pslverr /*verilator public_flat_rw*/;
    wire [31:0] s_apb_prdata /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS+1:0] seen_s_apb_paddr /*verilator public_flat_rw*/;
    reg seen_s_apb_psel /*verilator public_flat_rw*/;
    reg seen_s_apb_penable /*verilator public_flat_rw*/;
    reg seen_s_apb_pwrite /*verilator public_flat_rw*/;
    reg [31:0] seen_s_apb_pwdata /*verilator public_flat_rw*/;
    reg [3:0] seen_s_apb_pstrb /*verilator public_flat_rw*/;
    always @(posedge clk) begin
        seen_s_apb_paddr <= s_apb_paddr;
        seen_s_apb_psel <= s_apb_psel;
        seen_s_apb_penable <= s_apb_penable;
        seen_s_apb_pwrite <= s_apb_pwrite;
        seen_s_apb_pwdata <= s_apb_pwdata;
        seen_s_apb_pstrb <= s_apb_pstrb;
    end
`else
    reg [ADDRESS_BITS-1:0] avs_s0_address /*verilator public_flat_rw*/;
    reg avs_s0_read /*verilator public_flat_rw*/;
    reg avs_s0_write /*verilator public_flat_rw*/;
    reg [31:0] avs_s0_writedata /*verilator public_flat_rw*/;
    reg [3:0] avs_s0_byteenable /*verilator public_flat_rw*/;
    wire [31:0] avs_s0_readdata /*verilator public_flat_rw*/;
    wire avs_s0_readdatavalid /*verilator public_flat_rw*/;
    wire avs_s0_waitrequest /*verilator public_flat_rw*/;
`endif

    wire [PIXELS*COLOUR_BITS-1:0] vga_r, vga_g, vga_b;
    wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk;

    ray_caster_module dut (
        .clk(clk),
        .reset(reset),
`ifdef BUS_AXI4LITE
        .s_axi_awaddr(seen_s_axi_awaddr),
        .s_axi_awvalid(seen_s_axi_awvalid),
        .s_axi_wdata(seen_s_axi_wdata),
        .s_axi_wstrb(seen_s_axi_wstrb),
        .s_axi_wvalid(seen_s_axi_wvalid),
        .s_axi_bready(seen_s_axi_bready),
        .s_axi_araddr(seen_s_axi_araddr),
        .s_axi_arvalid(seen_s_axi_arvalid),
        .s_axi_rready(seen_s_axi_rready),
        .s_axi_awready(s_axi_awready),
        .s_axi_wready(s_axi_wready),
        .s_axi_bresp(s_axi_bresp),
        .s_axi_bvalid(s_axi_bvalid),
        .s_axi_arready(s_axi_arready),
        .s_axi_rdata(s_axi_rdata),
        .s_axi_rresp(s_axi_rresp),
        .s_axi_rvalid(s_axi_rvalid),
`elsif BUS_WISHBONE
        .wb_cyc(seen_wb_cyc),
        .wb_stb(seen_wb_stb),
        .wb_we(seen_wb_we),
        .wb_adr(seen_wb_adr),
        .wb_sel(seen_wb_sel),
        .wb_dat_w(seen_wb_dat_w),
        .wb_ack(wb_ack),
        .wb_dat_r(wb_dat_r),
`elsif BUS_APB
        .s_apb_paddr(seen_s_apb_paddr),
        .s_apb_psel(seen_s_apb_psel),
        .s_apb_penable(seen_s_apb_penable),
        .s_apb_pwrite(seen_s_apb_pwrite),
        .s_apb_pwdata(seen_s_apb_pwdata),
        .s_apb_pstrb(seen_s_apb_pstrb),
        .s_apb_pready(s_apb_pready),
        .s_apb_pslverr(s_apb_pslverr),
        .s_apb_prdata(s_apb_prdata),
`else
        .avs_s0_address(avs_s0_address),
        .avs_s0_read(avs_s0_read),
        .avs_s0_write(avs_s0_write),
        .avs_s0_writedata(avs_s0_writedata),
        .avs_s0_byteenable(avs_s0_byteenable),
        .avs_s0_readdata(avs_s0_readdata),
        .avs_s0_readdatavalid(avs_s0_readdatavalid),
        .avs_s0_waitrequest(avs_s0_waitrequest),
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

    // Cycles of rendering since the last StartScreen. A netlist does not keep the names, and has none.
    reg [31:0] busy_cycles /*verilator public_flat_rw*/;
    initial busy_cycles = 0;
`ifndef NETLIST
    always @(posedge clk)
        if (dut.progress_start_screen)
            busy_cycles = 0;
        else if (dut.progress_busy)
            busy_cycles = busy_cycles + 1;
`endif

    // A waveform of part of a frame, for who asks for one.
`ifdef WAVE_WINDOW
    wave_window window (
        .clk(clk),
        .start_screen(dut.progress_start_screen)
    );
`endif

    line_sink #(
        .COLOUR_BITS(COLOUR_BITS),
        .H_TOTAL(H_TOTAL),
        .HS_ACTIVE(HS_ACTIVE),
        .CLOCKS_PER_PIXEL(CLOCKS_PER_PIXEL),
        .PIXELS(PIXELS)
    ) sink (
        .clk(clk),
        .reset(reset),
        .vga_r(vga_r),
        .vga_g(vga_g),
        .vga_b(vga_b),
        .vga_hs(vga_hs),
        .vga_vs(vga_vs),
        .vga_blank_n(vga_blank_n),
        .vga_sync_n(vga_sync_n),
        .vga_clk(vga_clk)
    );
endmodule
