// SPDX-License-Identifier: MIT
// The video generator compared with a reference that only knows the standard: a half, a column and a line of the total
// frame, with the blanking first, and the sync pulses as pixel counts from its start. With two pixels per clock, a
// column is a pair of them. With one clock per pixel there is only one half, and vga_clk is the clock itself.
//
// Nothing is assumed about the inputs: reset may come at any time, and the colours are arbitrary. The frame's strobes
// are functions of the reference position, which visits every place of the frame once; in addition, start_row is
// counted to come ROWS times per frame. The invariants at the end tie the generator's registers to the reference, which
// makes the proof inductive at any size of screen.
//
// [proof]
// claim = "sync, blanking and strobes come exactly at the standard's counts, for any inputs"
// modules = ["video_generator", "pixel_clock if LEAD"]
// parameters = { COLOUR_BITS = "COLOUR_BITS * PIXELS" }
// induction = 1
// quick = [
//   "vga240: one-unit", "vga200: one-unit rows=200", "tiny48: one-unit screen=tiny", "toy: alone=video",
//   "beam tiny48: beam two screen=tiny scale=1", "beam 1080, 2 pixels: beam two pairs",
// ]
// [faults]
// "toy" = ["video_generator.hs late in 30", "video_generator.vs late in 60", "video_generator.x edge in 40",
//   "video_generator.vga_hs as pixel_red", "video_generator.vga_b as pixel_blue", "video_generator.vga_r late",
//   "video_generator.scan_start_screen late in 80", "video_generator.line_repeat 0 in 200"]
// "beam 1080, 2 pixels" = ["video_generator.in_columns late in 130"]

module video_timing #(
    parameter H_VISIBLE = 640, parameter H_FRONT = 16, parameter H_SYNC = 96, parameter H_BACK = 48,
    parameter H_HIGH = 0,
    parameter V_VISIBLE = 480, parameter V_FRONT = 10, parameter V_SYNC = 2, parameter V_BACK = 33,
    parameter V_HIGH = 0,
    parameter DOUBLING = 2, parameter ROWS = 240, parameter COLOUR_BITS = 8,
    parameter CLOCKS = 2, parameter LEAD = 0,   // clocks per pixel; pixels by which columns are announced early
    parameter X_BITS = 11, parameter Y_BITS = 10, parameter REPEAT_BITS = 1
) (
    input clk, input reset,
    input [COLOUR_BITS-1:0] red, input [COLOUR_BITS-1:0] green, input [COLOUR_BITS-1:0] blue
);
localparam H_BLANK = H_FRONT + H_SYNC + H_BACK, H_TOTAL = H_BLANK + H_VISIBLE;
localparam V_BLANK = V_FRONT + V_SYNC + V_BACK, V_TOTAL = V_BLANK + V_VISIBLE;
localparam OUTPUTS = 3 * COLOUR_BITS + 4;

wire start_screen, start_row, visible_line, next_column;
wire [COLOUR_BITS-1:0] vga_r, vga_g, vga_b;
wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk;

video_generator dut (
    .clk(clk), .reset(reset), .scan_start_screen(start_screen), .scan_start_row(start_row),
    .scan_visible_line(visible_line), .scan_next_column(next_column), .pixel_word({red, green, blue}),
    .vga_r(vga_r), .vga_g(vga_g), .vga_b(vga_b), .vga_hs(vga_hs), .vga_vs(vga_vs), .vga_blank_n(vga_blank_n),
    .vga_sync_n(vga_sync_n), .vga_clk(vga_clk)
);

// The system is reset once before anything is checked.
reg known = 0;
always @(posedge clk) known <= 1;
always @* if (!known) assume (reset);

// The position that is prepared, and the one on the outputs, a pixel behind, if there was one since reset.
reg half;
wire first_half = CLOCKS == 1 || !half, last_half = CLOCKS == 1 || half;
reg [11:0] column, line, shown_column, shown_line;
reg showing;
always @(posedge clk) begin
    if (reset) begin
        half <= 0;
        column <= 0;
        line <= 0;
        showing <= 0;
        shown_column <= 0;
        shown_line <= 0;
    end
    else begin
        half <= !half;
        if (last_half) begin
            column <= column == H_TOTAL - 1 ? 0 : column + 1;
            if (column == H_TOTAL - 1) line <= line == V_TOTAL - 1 ? 0 : line + 1;
            showing <= 1;
            shown_column <= column;
            shown_line <= line;
        end
    end
end

// The expected outputs. The vertical pulse starts and ends where a horizontal one starts.
wire h_active = showing && shown_column >= H_FRONT && shown_column < H_FRONT + H_SYNC;
wire past_v_start = shown_line > V_FRONT || (shown_line == V_FRONT && shown_column >= H_FRONT);
wire past_v_end = shown_line > V_FRONT + V_SYNC || (shown_line == V_FRONT + V_SYNC && shown_column >= H_FRONT);
wire v_active = showing && past_v_start && !past_v_end;
wire picture = showing && shown_column >= H_BLANK && shown_line >= V_BLANK;

// The colours when the shown pixel was sampled.
reg [COLOUR_BITS-1:0] taken_red, taken_green, taken_blue;
always @(posedge clk) if (last_half) begin
    taken_red <= red;
    taken_green <= green;
    taken_blue <= blue;
end

always @* if (known) begin
    assert (vga_hs == (h_active ? H_HIGH : !H_HIGH));
    assert (vga_vs == (v_active ? V_HIGH : !V_HIGH));
    assert (vga_blank_n == picture);
    assert (vga_r == (picture ? taken_red : 0));
    assert (vga_g == (picture ? taken_green : 0));
    assert (vga_b == (picture ? taken_blue : 0));
    assert (!vga_sync_n);
    assert (CLOCKS == 1 || vga_clk == half);
end

// Except in reset, outputs change only at the falling edge of the pixel clock.
wire [OUTPUTS-1:0] outputs = {vga_r, vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n};
reg [OUTPUTS-1:0] last_outputs;
reg last_clk, last_reset;
always @(posedge clk) begin
    last_outputs <= outputs;
    last_clk <= vga_clk;
    last_reset <= reset;
end
always @* if (known && CLOCKS == 2 && !last_reset && !(last_clk && !vga_clk)) assert (outputs == last_outputs);

// The renderer's strobes: StartScreen a row ahead of the picture, start_row at each row's first line, next_column at
// each column's end, or with a lead at its beginning.
wire line_begins = first_half && column == 0;
wire [11:0] picture_line = line - V_BLANK, column_ahead = column + LEAD;
wire [11:0] picture_column = column_ahead - H_BLANK;
wire in_columns = column_ahead >= H_BLANK && column_ahead < H_TOTAL;
always @* if (known) begin
    assert (start_screen == (line_begins && line == V_BLANK - DOUBLING));
    assert (start_row == (line_begins && line >= V_BLANK && picture_line % DOUBLING == 0));
    assert (visible_line == in_columns);
    assert (next_column == (last_half && in_columns && picture_column % DOUBLING == (LEAD ? 0 : DOUBLING - 1)));
end

// Rows since StartScreen: all ROWS when the next StartScreen comes.
reg [11:0] rows_seen;
reg screen_seen;
always @(posedge clk) begin
    if (reset) begin
        rows_seen <= 0;
        screen_seen <= 0;
    end
    else if (start_screen) begin
        rows_seen <= 0;
        screen_seen <= 1;
    end
    else if (start_row) rows_seen <= rows_seen + 1;
end
always @* if (known && screen_seen) begin
    assert (rows_seen <= ROWS);
    if (start_screen) assert (rows_seen == ROWS);
end

// Invariants: the reference is in range, its shown position is behind the prepared one, and the generator's registers
// match the position.
(* hierconn *) wire signed [X_BITS-1:0] \dut.x ;
(* hierconn *) wire signed [Y_BITS-1:0] \dut.y ;
(* hierconn *) wire \dut.pixel_end ;
(* hierconn *) wire [REPEAT_BITS-1:0] \dut.pixel_repeat , \dut.line_repeat ;
wire signed [15:0] x = \dut.x , y = \dut.y ;
wire signed [15:0] position_x = $signed({4'b0, column}) - H_BLANK, position_y = $signed({4'b0, line}) - V_BLANK;
wire wrapped = shown_column == H_TOTAL - 1;
wire [11:0] row_of_line = picture_line / DOUBLING;
wire row_begins = line_begins && picture_line % DOUBLING == 0;
always @* if (known) begin
    assert (column < H_TOTAL && line < V_TOTAL);
    assert (shown_column < H_TOTAL && shown_line < V_TOTAL);
    if (showing) begin
        assert (column == (wrapped ? 0 : shown_column + 1));
        assert (line == (!wrapped ? shown_line : shown_line == V_TOTAL - 1 ? 0 : shown_line + 1));
    end
    else assert (column == 0 && line == 0);
    assert (x == position_x && x >= -H_BLANK && x < H_VISIBLE);
    assert (y == position_y && y >= -V_BLANK && y < V_VISIBLE);
    assert (\dut.pixel_end == last_half);
    assert (\dut.pixel_repeat == (in_columns ? picture_column % DOUBLING : 0));
    assert (\dut.line_repeat == (y < 0 ? 0 : picture_line % DOUBLING));
    if (screen_seen) begin
        if (line >= V_BLANK) assert (rows_seen == row_of_line + !row_begins);
        else if (line < V_BLANK - DOUBLING || start_screen) assert (rows_seen == ROWS);
        else assert (rows_seen == 0);
    end
end
endmodule
