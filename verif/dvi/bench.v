// SPDX-License-Identifier: MIT
// The ULX3S with nothing but its clock and its buttons. What its DVI connector sends goes into a file, a hexadecimal
// digit for each bit time, half a cycle of shift_clk: clock, red, green, blue; what its serial port says into another.

`timescale 1ns / 1ps

module dvi_bench;
    // Symbols must hold still for so many cycles of shift_clk before and after they are taken.
    localparam real STILL_CYCLES = 1.5;
    localparam real SERIAL_BIT_NS = 1e9 / 115200;

    reg clk_25mhz = 1'b0;
    reg [6:0] btn = 7'b0000000;         // the power button is pressed, which resets
    wire [7:0] led;
    wire [3:0] gpdi_dp;
    wire ftdi_rxd, wifi_gpio0;
    reg [6:0] held;
    reg recording = 1'b0;
    realtime changed = 0, taken = 0, rose = 0, still = 0;
    integer bits, late_ns, file, count, text, place;
    reg [7:0] character;
    integer unsteady = 0;

    always #20 clk_25mhz = ~clk_25mhz;

    ulx3s board (
        .clk_25mhz(clk_25mhz),
        .btn(btn),
        .led(led),
        .gpdi_dp(gpdi_dp),
        .ftdi_rxd(ftdi_rxd),
        .wifi_gpio0(wifi_gpio0)
    );

    always @(board.blue, board.green, board.red) begin
        changed = $realtime;
        if (recording && changed - taken < still)
            unsteady = unsteady + 1;
    end

    always @(posedge board.shift_clk)
        if (recording && board.serialiser.blue_lane.load) begin
            taken = $realtime;
            if (taken - changed < still)
                unsteady = unsteady + 1;
        end

    // From the start bit on, each bit in its middle.
    initial begin
        text = $fopen("serial.txt", "w");
        wait (ftdi_rxd === 1'b1);
        forever begin
            @(negedge ftdi_rxd) #(SERIAL_BIT_NS / 2);
            for (place = 0; place < 8; place = place + 1)
                #SERIAL_BIT_NS character[place] = ftdi_rxd;
            #SERIAL_BIT_NS $fwrite(text, "%c", character);
        end
    end

    // +bits: bit times to record; +buttons: those of btn that are held all the time; +late_ns: added to the reset.
    initial begin
        if (!$value$plusargs("bits=%d", bits))
            bits = 0;
        if (!$value$plusargs("buttons=%b", held))
            held = 7'b0000000;
        if (!$value$plusargs("late_ns=%d", late_ns))
            late_ns = 0;
        #1000 #(late_ns) btn = held | 7'b0000001;
        file = $fopen("gpdi.txt", "w");
        // Reset has ended by then, and the serialiser found the pixels.
        #5000;
        @(posedge board.shift_clk) rose = $realtime;
        @(posedge board.shift_clk) still = STILL_CYCLES * ($realtime - rose);
        recording = 1'b1;
        // Within a bit, soon after its edge.
        for (count = 0; count < bits; count = count + 1) begin
            @(board.shift_clk) #0.5;
            $fwrite(file, "%h", gpdi_dp);
        end
        $fclose(file);
        $fclose(text);
        $display("unsteady %0d", unsteady);
        $finish;
    end
endmodule
