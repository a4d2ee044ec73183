// SPDX-License-Identifier: MIT
// The ULX3S with nothing but its clock and its buttons; what its DVI connector sends goes into a file, a hexadecimal
// digit for each bit time of 4 ns: clock, red, green, blue.

`timescale 1ns / 1ps

module dvi_bench #(
    parameter BITS = 1000               // bit times to record
) ();
    reg clk_25mhz = 1'b0;
    reg [6:0] btn = 7'b0000000;         // the power button is pressed, which resets
    wire [7:0] led;
    wire [3:0] gpdi_dp;
    wire wifi_gpio0;
    integer file, count;

    always #20 clk_25mhz = ~clk_25mhz;

    ulx3s board (
        .clk_25mhz(clk_25mhz),
        .btn(btn),
        .led(led),
        .gpdi_dp(gpdi_dp),
        .wifi_gpio0(wifi_gpio0)
    );

    initial begin
        #1000 btn = 7'b0000001;
        file = $fopen("gpdi.txt", "w");
        // Reset has ended by then, and the serialiser found the pixels. In the middle of a bit, whose edges are those of
        // 125 MHz.
        #5000;
        @(posedge board.shift_clk) #2;
        for (count = 0; count < BITS; count = count + 1) begin
            $fwrite(file, "%h", gpdi_dp);
            #4;
        end
        $fclose(file);
        $finish;
    end
endmodule
