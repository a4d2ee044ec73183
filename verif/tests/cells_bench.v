// SPDX-License-Identifier: MIT
// Compares a netlist of `cells` with its Verilog, `wanted_cells`, on random values: every bit that the Verilog knows,
// until the first cycle in which bits differ.

`timescale 1ns / 1ps

module cells_bench;
    localparam WIDTH = 731;

    reg clk = 1'b0, enable, clear;
    reg [35:0] a, b;
    reg [8:0] at, from;
    reg [3:0] write;
    wire [WIDTH-1:0] wanted, made;
    integer cycle, place, seed, unequal = 0, known = 0;

    `define PORTS(out) ( \
        clk, enable, clear, a, b, at, from, write, \
        out[8:0], out[44:9], out[80:45], out[116:81], out[152:117], out[188:153], out[224:189], out[260:225], \
        out[278:261], out[296:279], out[315:297], out[334:316], out[353:335], out[372:354], out[391:373], \
        out[403:392], out[423:404], out[442:424], out[478:443], out[514:479], out[530:515], out[574:531], \
        out[618:575], out[662:619], out[706:663], out[730:707] )
    wanted_cells rtl `PORTS(wanted);
    cells netlist `PORTS(made);

    initial begin
        if (!$value$plusargs("seed=%d", seed))
            seed = 0;
        for (cycle = 0; cycle < 400 && unequal == 0; cycle = cycle + 1) begin
            a = {$random(seed), $random(seed)};
            b = {$random(seed), $random(seed)};
            at = $random(seed) & 9'h107;
            from = $random(seed) & 9'h107;
            write = cycle % 2 ? $random(seed) : 4'b0000;
            enable = cycle < 8 || $random(seed) & 3;
            clear = cycle < 8 || $random(seed) % 8 == 0;
            #1;
            if (^wanted !== 1'bx)
                known = known + 1;
            if (made !== wanted)
                for (place = 0; place < WIDTH; place = place + 1)
                    if (wanted[place] !== 1'bx && made[place] !== wanted[place]) begin
                        $display("cycle %0d, output bit %0d: wanted %b, got %b", cycle, place, wanted[place],
                                 made[place]);
                        unequal = unequal + 1;
                    end
            #4 clk = 1'b1;
            #5 clk = 1'b0;
        end
        $display("%0d bits differ; %0d cycles have no unknown bit", unequal, known);
        $finish;
    end
endmodule
