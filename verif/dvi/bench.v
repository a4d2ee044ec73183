// SPDX-License-Identifier: MIT
// A board with only its oscillator, its buttons and its outputs connected; device is generated for the board's wiring.
// Each value that a monitor samples goes into a file, in hexadecimal: of a DVI link one per bit time, which is half a
// cycle of shift_clk: clock, red, green, blue; of a DAC or a transmitter one per edge that it samples. The output of the
// serial port goes into another file.

`timescale 1ns / 1ps

module board_bench;
    localparam real SERIAL_BIT_NS = 1e9 / 115200;
    // The longest time until the PLL has locked, reset has ended, and a link has found the pixels.
    localparam real SETTLED_NS = 5000;
    localparam integer MASKS = 8;

    reg reset = 1'b1;
    reg [5:0] buttons = 6'b000000;      // down, up, right, left, back, forward
    reg recording = 1'b0;
    reg serial_in = 1'b1;
    reg [MASKS*6-1:0] pressed;
    integer values, again, each, late_ns, file, count, text, place;
    realtime started;
    reg [7:0] character;

    device device (.reset(reset), .buttons(buttons), .serial_in(serial_in));

    // Samples each bit in its middle, timed from the start bit.
    initial begin
        text = $fopen("serial.txt", "w");
        wait (device.serial === 1'b1);
        forever begin
            @(negedge device.serial) #(SERIAL_BIT_NS / 2);
            for (place = 0; place < 8; place = place + 1)
                #SERIAL_BIT_NS character[place] = device.serial;
            #SERIAL_BIT_NS $fwrite(text, "%c", character);
        end
    end

    // +sends: number of bytes in sends.txt that a computer sends to the serial port; +bit_ps: time of a bit.
    reg [7:0] sent [0:4095];
    integer sends, bit_ps, byte_at, bit_at;
    initial
        if ($value$plusargs("sends=%d", sends) && $value$plusargs("bit_ps=%d", bit_ps)) begin
            $readmemh("sends.txt", sent, 0, sends - 1);
            wait (recording);
            for (byte_at = 0; byte_at < sends; byte_at = byte_at + 1)
                for (bit_at = 0; bit_at < 10; bit_at = bit_at + 1) begin
                    serial_in = bit_at == 0 ? 1'b0 : bit_at == 9 ? 1'b1 : sent[byte_at][bit_at - 1];
                    #(bit_ps / 1000.0);
                end
        end

    // +values: number of values to record; +again: to record after another reset, 0 for no other reset; +pressed:
    // buttons, the first ones lowest, each for a number of values, +each; +late_ns: extra duration of reset.
    initial begin
        if (!$value$plusargs("values=%d", values) || !$value$plusargs("again=%d", again)
            || !$value$plusargs("pressed=%b", pressed) || !$value$plusargs("each=%d", each)
            || !$value$plusargs("late_ns=%d", late_ns))
            $finish;
        #1000 #(late_ns) reset = 1'b0;
        record(values, "0.txt", 1'b1);
        if (again > 0) begin
            reset = 1'b1;
            buttons = 6'b000000;
            #SETTLED_NS $display("held %h", device.value);
            reset = 1'b0;
            record(again, "1.txt", 1'b0);
        end
        $fclose(text);
        $display("unsteady %0d", device.unsteady);
        $finish;
    end

    task record(input integer total, input [5*8-1:0] name, input presses);
        begin
            if (presses)
                buttons = pressed[5:0];
            #SETTLED_NS file = $fopen(name, "w");
            recording = 1'b1;
            @(device.sample) started = $realtime;
            // Samples within a value, soon after its edge.
            for (count = 0; count < total; count = count + 1) begin
                if (presses && count % each == 0 && count / each < MASKS)
                    buttons = pressed[count / each * 6 +: 6];
                @(device.sample) #0.5;
                $fwrite(file, "%h\n", device.value);
            end
            recording = 1'b0;
            $display("rate %0.6f", total * 1000 / ($realtime - started));
            $fclose(file);
        end
    endtask
endmodule
