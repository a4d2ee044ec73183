// SPDX-License-Identifier: MIT
// A board with only its clock and its buttons connected; dvi_device is generated for the board's pins. The output of
// the DVI connector goes into a file, one hexadecimal digit per bit time, which is half a cycle of shift_clk: clock,
// red, green, blue. The output of the serial port goes into another file.

`timescale 1ns / 1ps

module dvi_bench;
    // Symbols must be stable for this many cycles of shift_clk before and after they are sampled.
    localparam real STILL_CYCLES = 1.5;
    localparam real SERIAL_BIT_NS = 1e9 / 115200;

    reg reset = 1'b1;
    reg [5:0] buttons = 6'b000000;      // down, up, right, left, back, forward
    wire [3:0] link;
    wire serial;
    reg [5:0] held;
    reg recording = 1'b0;
    realtime changed = 0, taken = 0, rose = 0, still = 0;
    integer bits, late_ns, file, count, text, place;
    reg [7:0] character;
    integer unsteady = 0;

    dvi_device device (
        .reset(reset),
        .buttons(buttons),
        .link(link),
        .serial(serial)
    );

    `define LINK device.top.board.serialiser

    // Changes near the edge that samples them arrive a cycle early, or not, in the synchroniser of the two clocks.
    always @(posedge device.top.board.shift_clk) begin
        #0.1;
        if ($random % 2)
            `LINK.arriving = `LINK.held_pixel;
    end

    always @(`LINK.blue_lane.held, `LINK.green_lane.held, `LINK.red_lane.held) begin
        changed = $realtime;
        if (recording && changed - taken < still)
            unsteady = unsteady + 1;
    end

    always @(posedge device.top.board.shift_clk)
        if (recording && `LINK.blue_lane.load_here) begin
            taken = $realtime;
            if (taken - changed < still)
                unsteady = unsteady + 1;
        end

    // Samples each bit in its middle, timed from the start bit.
    initial begin
        text = $fopen("serial.txt", "w");
        wait (serial === 1'b1);
        forever begin
            @(negedge serial) #(SERIAL_BIT_NS / 2);
            for (place = 0; place < 8; place = place + 1)
                #SERIAL_BIT_NS character[place] = serial;
            #SERIAL_BIT_NS $fwrite(text, "%c", character);
        end
    end

    // +bits: bit times to record; +buttons: buttons held all the time; +late_ns: extra duration of reset.
    initial begin
        if (!$value$plusargs("bits=%d", bits))
            bits = 0;
        if (!$value$plusargs("buttons=%b", held))
            held = 6'b000000;
        if (!$value$plusargs("late_ns=%d", late_ns))
            late_ns = 0;
        #1000 #(late_ns) reset = 1'b0;
        buttons = held;
        file = $fopen("gpdi.txt", "w");
        // By then reset has ended, and the serialiser has found the pixels.
        #5000;
        @(posedge device.top.board.shift_clk) rose = $realtime;
        @(posedge device.top.board.shift_clk) still = STILL_CYCLES * ($realtime - rose);
        recording = 1'b1;
        // Samples within a bit, soon after its edge.
        for (count = 0; count < bits; count = count + 1) begin
            @(device.top.board.shift_clk) #0.5;
            $fwrite(file, "%h", link);
        end
        $fclose(file);
        $fclose(text);
        $display("unsteady %0d", unsteady);
        $finish;
    end
endmodule
