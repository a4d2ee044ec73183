// SPDX-License-Identifier: MIT
// The bench of a system with a processor: a clock, the design running a program, a line sink, a receiver for the serial
// port, and a tap on the ray tracer's bus that reports to Python what was written and when.
//
// Python touches only the signals marked public.

`timescale 1ns / 1ns

module system_bench #(
    parameter ADDRESS_BITS = 8,     // bits of the bus's word address
    parameter BUTTONS = 5,
    parameter CLOCKS_PER_BIT = 217, // clocks per bit of the serial port
    parameter COLOUR_BITS = 8,      // bits per channel
    parameter H_TOTAL = 800,        // pixels per line, blanking included
    parameter HS_ACTIVE = 0,        // level of HS during its pulse
    parameter CLOCKS_PER_PIXEL = 2, // 1 or 2
    parameter PIXELS = 1            // pixels per pixel clock, 1 or 2
) (`CLOCK_PORT);
    `OWN_CLOCK

    // Driven by Python
    reg ready /*verilator public_flat_rw*/;
    reg [BUTTONS-1:0] buttons /*verilator public_flat_rw*/;
    initial begin
        ready = 1'b0;
        buttons = 0;
    end

    wire uart_tx;
    wire [PIXELS*COLOUR_BITS-1:0] vga_r, vga_g, vga_b;
    wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk;

    ray_caster_system dut (
        .*
    );

    // The design is still in reset at the clock edge at which reset falls; the monitor's clock runs from the next on.
    // Before the first reset, which takes a clock to come, the outputs are those at power-up.
    reg was_reset, powers_up;
    initial begin
        was_reset = 1'b1;
        powers_up = 1'b1;
    end
    always @(posedge clk) begin
        if (dut.reset)
            powers_up <= 1'b0;
        was_reset <= dut.reset || powers_up;
    end

    line_sink #(
        .COLOUR_BITS(COLOUR_BITS),
        .H_TOTAL(H_TOTAL),
        .HS_ACTIVE(HS_ACTIVE),
        .CLOCKS_PER_PIXEL(CLOCKS_PER_PIXEL),
        .PIXELS(PIXELS)
    ) sink (
        .reset(was_reset),
        .*
    );

    // The processor stopped at an instruction or an access that it does not support.
    wire halted /*verilator public_flat_rw*/ = dut.processor_host_i.picorv32_i.trap;

    // The tap: every write that the ray tracer accepts, and every StartScreen, with the clock at whose end it happened.
    // With lists of frames (WHOLE_FRAMES), the committed scene may go live later, and a picture may be shown again.
    wire writes = dut.ray_caster_module_i.avs_s0_write && !dut.ray_caster_module_i.avs_s0_waitrequest && !dut.reset;
    wire starts = dut.ray_caster_module_i.progress_start_screen && !dut.reset;
`ifdef WHOLE_FRAMES
    wire takes = dut.ray_caster_module_i.progress_take_scene;
    wire stands = dut.ray_caster_module_i.progress_frames_again;
    wire underrun = 1'b0;
`else
    wire takes = starts;
    wire stands = 1'b0;
    wire underrun = dut.ray_caster_module_i.progress_underrun;
`endif
    reg [31:0] clocks;
    reg bus_write /*verilator public_flat_rw*/;
    reg bus_start_screen /*verilator public_flat_rw*/;
    reg bus_takes_scene /*verilator public_flat_rw*/;         // with StartScreen: the committed scene goes live
    reg bus_again /*verilator public_flat_rw*/;               // with StartScreen: the last picture is shown again
    reg [31:0] bus_clock /*verilator public_flat_rw*/;
    reg [ADDRESS_BITS-1:0] bus_address /*verilator public_flat_rw*/;
    reg [3:0] bus_byteenable /*verilator public_flat_rw*/;
    reg [31:0] bus_writedata /*verilator public_flat_rw*/;
    reg bus_event /*verilator public_flat_rw*/;               // toggles when these are new
    reg [31:0] underruns /*verilator public_flat_rw*/;        // clocks in which a row was not complete in time
    initial begin
        clocks = 0;
        bus_event = 1'b0;
        underruns = 0;
    end
    always @(posedge clk) begin
        if (writes || starts) begin
            bus_write = writes;
            bus_start_screen = starts;
            bus_takes_scene = takes;
            bus_again = stands;
            bus_clock = clocks;
            bus_address = dut.ray_caster_module_i.avs_s0_address;
            bus_byteenable = dut.ray_caster_module_i.avs_s0_byteenable;
            bus_writedata = dut.ray_caster_module_i.avs_s0_writedata;
            bus_event = ~bus_event;
        end
        if (underrun && !dut.reset)
            underruns = underruns + 1;
        clocks = clocks + 1;
    end

    // The receiver samples each bit in its middle: the start bit, eight bits from the lowest on, the stop bit.
    integer uart_bits, uart_wait;
    reg [7:0] uart_byte /*verilator public_flat_rw*/;
    reg uart_event /*verilator public_flat_rw*/;              // toggles when uart_byte is new
    reg [31:0] uart_faults /*verilator public_flat_rw*/;      // start bits that are too short, missing stop bits
    initial begin
        uart_bits = 0;
        uart_event = 1'b0;
        uart_faults = 0;
    end
    always @(posedge clk)
        if (uart_bits == 0) begin
            if (!dut.reset && uart_tx === 1'b0) begin
                uart_bits = 10;
                uart_wait = CLOCKS_PER_BIT / 2;
            end
        end
        else if (uart_wait != 0)
            uart_wait = uart_wait - 1;
        else begin
            if (uart_tx !== 1'b0 && uart_bits == 10 || uart_tx !== 1'b1 && uart_bits == 1)
                uart_faults = uart_faults + 1;
            if (uart_bits != 10 && uart_bits != 1)
                uart_byte = {uart_tx, uart_byte[7:1]};
            if (uart_bits == 1)
                uart_event = ~uart_event;
            uart_bits = uart_bits - 1;
            uart_wait = CLOCKS_PER_BIT - 1;
        end
endmodule
