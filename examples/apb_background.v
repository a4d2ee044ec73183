// SPDX-License-Identifier: MIT
// The ray tracer in your own plain Verilog design, behind APB: this writes a background and starts it.
// For `make verilog BUS=apb SCREEN=tiny UNITS=8 RECTANGLES=3`; other designs have other widths.

module apb_background #(
    parameter [23:0] BACKGROUND = 24'h204060    // red, green, blue from the highest bits on
) (
    input  wire       clk,                      // frequency: see the constraints file
    input  wire       reset,                    // synchronous, active high
    output wire [7:0] red, green, blue,
    output wire       hs, vs, blank_n
);
    // Addresses and bits of registers, from raycaster_regs.h
    localparam CONTROL = 7'h10, BACKGROUND_COLOUR = 7'h24;
    localparam RUN = 32'h1, COMMIT = 32'h2;

    // Two writes, each a setup cycle and then enable until the ray tracer is ready.
    reg [1:0] written;
    reg enable;
    wire ready;
    wire select = written != 2;
    always @(posedge clk)
        if (reset) {written, enable} <= 0;
        else begin
            enable <= select && !(enable && ready);
            if (enable && ready) written <= written + 1;
        end

    ray_caster_module tracer (
        .clk(clk),
        .reset(reset),
        .s_apb_paddr(written == 0 ? BACKGROUND_COLOUR : CONTROL),
        .s_apb_psel(select),
        .s_apb_penable(enable),
        .s_apb_pwrite(1'b1),
        .s_apb_pwdata(written == 0 ? {8'b0, BACKGROUND} : RUN | COMMIT),
        .s_apb_pstrb(4'b1111),
        .s_apb_pready(ready),
        .s_apb_pslverr(),
        .s_apb_prdata(),
        .irq(),
        .vga_r(red),
        .vga_g(green),
        .vga_b(blue),
        .vga_hs(hs),
        .vga_vs(vs),
        .vga_blank_n(blank_n),
        .vga_sync_n(),
        .vga_clk()
    );
endmodule
