// SPDX-License-Identifier: MIT
// Writes a waveform of part of a frame only: everything below the bench, from some clocks after StartScreen on.
//
// Plusargs: window_file=path, window_from and window_to, both in clocks. Python arms the window when the scene is
// committed, so that the next StartScreen shows the scene. It ends the simulation when the window closes, as Verilator
// cannot stop writing.

`timescale 1ns / 1ns

module wave_window (
    input wire clk,
    input wire start_screen
);
    reg armed /*verilator public_flat_rw*/;
    reg closed /*verilator public_flat_rw*/;
    string file;
    integer from, to, clocks;
    initial begin
        armed = 1'b0;
        closed = 1'b0;
        clocks = -1;
        if (!$value$plusargs("window_file=%s", file) || !$value$plusargs("window_from=%d", from)
                || !$value$plusargs("window_to=%d", to)) begin
            $display("wave_window: a plusarg is missing");
            $finish;
        end
    end

    always @(posedge clk) begin
        if (clocks >= 0)
            clocks = clocks + 1;
        else if (armed && start_screen)
            clocks = 0;
        if (clocks == from) begin
            $dumpfile(file);
            $dumpvars(0, bench);
        end
        if (clocks == to)
            closed = 1'b1;
    end
endmodule
