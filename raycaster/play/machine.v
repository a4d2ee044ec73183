// SPDX-License-Identifier: MIT
// Top level for a loop in C++: a system with a processor, or the ray tracer alone, whose bus the loop drives. Events on
// the ray tracer's bus are brought out.
//
// SYSTEM: the system's module, defined if there is a processor. TAPS: number of 32-bit signals of a ray unit that the
// module `taps` brings out, defined if there is one. WHOLE_FRAMES: defined if the design draws into lists of frames.

module machine #(
    parameter BUTTONS = 5,
    parameter COLOUR_BITS = 8,
    parameter ADDRESS_BITS = 6
) (
    input  wire                    clk,
    input  wire                    ready,
    input  wire [BUTTONS-1:0]      buttons,         // with a processor
    input  wire                    host_read,       // without a processor; read and write are held until accepted
    input  wire                    host_write,
    input  wire [ADDRESS_BITS-1:0] host_address,
    input  wire [31:0]             host_writedata,
    output wire                    host_waitrequest,
    output wire                    host_readdatavalid,
    output wire [31:0]             host_readdata,
    output wire                    uart_tx,
    output wire [COLOUR_BITS-1:0]  vga_r,
    output wire [COLOUR_BITS-1:0]  vga_g,
    output wire [COLOUR_BITS-1:0]  vga_b,
    output wire                    vga_hs,
    output wire                    vga_vs,
    output wire                    vga_blank_n,
    output wire                    vga_clk,
    output wire                    busy,            // computing a picture
    output wire                    start_screen,    // a picture begins after this clock
    output wire                    takes_scene,     // the committed scene goes live with this clock
    output wire                    again,           // with start_screen, the last picture is shown again
    output wire                    late,            // a row's time ends before the row is complete
    output wire                    written,         // the ray tracer accepts a write with this clock
    output wire [ADDRESS_BITS-1:0] address,
    output wire [3:0]              byteenable,
    output wire [31:0]             writedata
`ifdef TAPS
    ,
    input  wire [7:0]              tapped_unit,
    output wire [32*`TAPS-1:0]     tapped
`endif
);

wire vga_sync_n, reset;

`ifdef SYSTEM
`define MODULE system.ray_caster_module_i
assign reset = system.reset;
assign host_waitrequest = 1'b0;
assign host_readdatavalid = 1'b0;
assign host_readdata = 32'b0;

`SYSTEM system (
    .clk(clk),
    .ready(ready),
    .buttons(buttons),
    .uart_tx(uart_tx),
    .vga_r(vga_r),
    .vga_g(vga_g),
    .vga_b(vga_b),
    .vga_hs(vga_hs),
    .vga_vs(vga_vs),
    .vga_blank_n(vga_blank_n),
    .vga_sync_n(vga_sync_n),
    .vga_clk(vga_clk)
);
`else
`define MODULE ray_caster_module_i
assign reset = !ready;
assign uart_tx = 1'b1;

ray_caster_module ray_caster_module_i (
    .clk(clk),
    .reset(reset),
    .avs_s0_address(host_address),
    .avs_s0_read(host_read),
    .avs_s0_write(host_write),
    .avs_s0_writedata(host_writedata),
    .avs_s0_byteenable(4'b1111),
    .avs_s0_readdata(host_readdata),
    .avs_s0_readdatavalid(host_readdatavalid),
    .avs_s0_waitrequest(host_waitrequest),
    .irq(),
    .vga_r(vga_r),
    .vga_g(vga_g),
    .vga_b(vga_b),
    .vga_hs(vga_hs),
    .vga_vs(vga_vs),
    .vga_blank_n(vga_blank_n),
    .vga_sync_n(vga_sync_n),
    .vga_clk(vga_clk)
);
`endif

assign busy = `MODULE.progress_busy;
assign start_screen = `MODULE.progress_start_screen && !reset;
`ifdef WHOLE_FRAMES
assign takes_scene = `MODULE.progress_take_scene && !reset;
assign again = `MODULE.progress_frames_again;
assign late = 1'b0;
`else
assign takes_scene = start_screen;
assign again = 1'b0;
assign late = `MODULE.progress_underrun;
`endif
assign written = `MODULE.avs_s0_write && !`MODULE.avs_s0_waitrequest && !reset;
assign address = `MODULE.avs_s0_address;
assign byteenable = `MODULE.avs_s0_byteenable;
assign writedata = `MODULE.avs_s0_writedata;

`ifdef TAPS
taps taps (
    .unit(tapped_unit),
    .values(tapped)
);
`endif

endmodule
