// SPDX-License-Identifier: MIT
// Top of a Tiny Tapeout project: one built-in scene on the community's VGA Pmod, at one pixel per clock.

module tt_um_raycaster (
    input  wire [7:0] ui_in,            // not used
    output wire [7:0] uo_out,           // hsync, blue 0, green 0, red 0, vsync, blue 1, green 1, red 1
    input  wire [7:0] uio_in,           // not used
    output wire [7:0] uio_out,
    output wire [7:0] uio_oe,           // all are inputs
    input  wire       ena,              // high while the project is selected
    input  wire       clk,
    input  wire       rst_n             // may change at any time
);

// Register address and bits, as in raycaster_regs.h.
localparam [3:0] CONTROL = 4'h4;
localparam [31:0] RUN = 32'h1, COMMIT = 32'h2;

wire [1:0] red, green, blue;
wire hsync, vsync, wait_request;
wire unused = &{1'b0, ui_in, uio_in, ena};

reg [1:0] settled;
always @(posedge clk)
    settled <= {settled[0], rst_n};
wire reset = !settled[1];

// One write starts the ray tracer.
reg started;
always @(posedge clk)
    if (reset)
        started <= 1'b0;
    else if (!wait_request)
        started <= 1'b1;

ray_caster_module tracer (
    .clk(clk),
    .reset(reset),
    .avs_s0_address(CONTROL),
    .avs_s0_read(1'b0),
    .avs_s0_write(!started),
    .avs_s0_writedata(RUN | COMMIT),
    .avs_s0_byteenable(4'b1111),
    .avs_s0_readdata(),
    .avs_s0_readdatavalid(),
    .avs_s0_waitrequest(wait_request),
    .irq(),
    .vga_r(red),
    .vga_g(green),
    .vga_b(blue),
    .vga_hs(hsync),
    .vga_vs(vsync),
    .vga_blank_n(),
    .vga_sync_n(),
    .vga_clk()
);

assign uo_out = {hsync, blue[0], green[0], red[0], vsync, blue[1], green[1], red[1]};
assign uio_out = 8'b0;
assign uio_oe = 8'b0;

endmodule
