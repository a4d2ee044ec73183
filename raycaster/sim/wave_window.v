// SPDX-License-Identifier: MIT
// Writes a waveform of some rows only: everything below the bench, while they are drawn and while they are shown.
//
// Plusargs: window_file=path; window_from and window_to, clocks since the StartScreen from which the scene is shown.
// For whole frames also row_from and row_to: from the start of the row with the first number to that of the row with
// the second one, or to the end of the frame, and row_rest clocks more; and window_last, clocks after which the window
// closes although nothing is shown.
// Python arms the window when the scene is committed, so that the next StartScreen shows or draws the scene. It ends the
// simulation when the window closes.

`timescale 1ns / 1ns

module wave_window (
    input wire clk,
    input wire start_screen
);
    wire row, busy, shown;  // strobe, a row starts; a frame is being drawn; StartScreen, from which the scene is shown
`ifdef WHOLE_FRAMES
    assign row = bench.dut.span_renderer_i.next_row;
    assign busy = bench.dut.progress_busy;
    assign shown = bench.dut.progress_frames_shown;
`else
    assign row = 1'b0;
    assign busy = 1'b0;
    assign shown = start_screen;
`endif

    reg armed /*verilator public_flat_rw*/;
    reg closed /*verilator public_flat_rw*/;
    reg opened, writes, wrote, ends, drawing, drawn;
    string file;
    integer from, to, row_from, row_to, row_rest, last, clocks, rows, rest, since;
    initial begin
        armed = 1'b0;
        closed = 1'b0;
        opened = 1'b0;
        writes = 1'b0;
        wrote = 1'b0;
        ends = 1'b0;
        drawing = 1'b0;
        drawn = 1'b0;
        clocks = -1;
        rows = 0;
        rest = 0;
        since = 0;
        last = 2147483647;
        if (!$value$plusargs("window_file=%s", file) || !$value$plusargs("window_from=%d", from)
                || !$value$plusargs("window_to=%d", to)) begin
            $display("wave_window: a plusarg is missing");
            $finish;
        end
        if (!$value$plusargs("row_from=%d", row_from) || !$value$plusargs("row_to=%d", row_to)
                || !$value$plusargs("row_rest=%d", row_rest) || !$value$plusargs("window_last=%d", last))
            drawn = 1'b1;
    end

    // A bit of the row before is written too, as only values before an edge count.
    always @(posedge clk) begin
        if (row)
            rows = rows + 1;
        if (armed && !drawn && busy && rows >= row_from)
            drawing = 1'b1;
        if (drawing && !drawn) begin
            if (rows > row_to || !busy)
                drawn = 1'b1;
            rest = row_rest;
        end
        if (rest > 0)
            rest = rest - 1;

        if (clocks >= 0)
            clocks = clocks + 1;
        else if (armed && shown)
            clocks = 0;
        if (armed)
            since = since + 1;

        ends = clocks >= to || (clocks < 0 && since >= last);
        writes = rest > 0 || clocks >= from || ends;
    end

    // Between two edges, so that the first edge written is a whole one. At the end the file is open, as Verilator writes
    // the rest only then.
    always @(negedge clk) begin
        if (writes && !opened) begin
            opened = 1'b1;
            $dumpfile(file);
            $dumpvars(0, bench);
        end else if (opened) begin
`ifdef VERILATOR
            // It ignores $dumpoff and $dumpon; this is the flag that $dumpvars sets.
            $c("vlSymsp->__Vm_dumping = ", writes, ";");
`else
            if (writes && !wrote) $dumpon;
            if (!writes && wrote) $dumpoff;
`endif
        end
        wrote = writes;
        closed = ends;
    end
endmodule
