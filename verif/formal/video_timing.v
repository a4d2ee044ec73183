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
// induction = 1
// quick = [
//   "vga240: one-unit", "vga200: one-unit rows=200", "tiny48: one-unit screen=tiny", "toy: alone=video",
//   "span tiny48: span two screen=tiny scale=1", "span 1080, 2 pixels: span two pairs",
// ]
// [faults]
// "toy" = ["video_generator.hs late in 30", "video_generator.vs late in 60", "video_generator.x edge in 40",
//   "video_generator.vga_hs as pixel_red", "video_generator.vga_b as pixel_blue", "video_generator.vga_r late",
//   "video_generator.scan_start_screen late in 80", "video_generator.line_repeat 0 in 200"]
// "span 1080, 2 pixels" = ["video_generator.in_columns late in 130"]

module video_timing;
localparam H_BLANK = H_FRONT + H_SYNC + H_BACK, H_TOTAL = H_BLANK + H_VISIBLE;
localparam V_BLANK = V_FRONT + V_SYNC + V_BACK, V_TOTAL = V_BLANK + V_VISIBLE;
localparam LIGHT_BITS = COLOUR_BITS * PIXELS, OUTPUTS = 3 * LIGHT_BITS + 4;

video_generator dut (.*);

// The position that is prepared, and the one on the outputs, a pixel behind, if there was one since reset.
reg half;
wire first_half = CLOCKS == 1 || !half, last_half = CLOCKS == 1 || half;
reg [11:0] column, line, shown_column, shown_line;
reg showing;
always @(posedge clk) begin
    if (reset) {half, column, line, showing, shown_column, shown_line} <= 0;
    else begin
        half <= !half;
        if (last_half) begin
            column <= column == H_TOTAL - 1 ? 0 : column + 1;
            if (column == H_TOTAL - 1) line <= line == V_TOTAL - 1 ? 0 : line + 1;
            {showing, shown_column, shown_line} <= {1'b1, column, line};
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
reg [3*LIGHT_BITS-1:0] taken;
always @(posedge clk) if (last_half) taken <= {pixel_red, pixel_green, pixel_blue};

always @* if (known) begin
    assert (vga_hs == (h_active ? H_HIGH : !H_HIGH));
    assert (vga_vs == (v_active ? V_HIGH : !V_HIGH));
    assert (vga_blank_n == picture);
    assert ({vga_r, vga_g, vga_b} == (picture ? taken : 0));
    assert (!vga_sync_n);
    assert (CLOCKS == 1 || vga_clk == half);
end

// Except in reset, outputs change only at the falling edge of the pixel clock.
wire [OUTPUTS-1:0] outputs = {vga_r, vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n};
always @* if (known && CLOCKS == 2 && !$past(reset) && !($past(vga_clk) && !vga_clk)) assert ($stable(outputs));

// The renderer's strobes: StartScreen a row ahead of the picture, start_row at each row's first line, next_column at
// each column's end, or with a lead at its beginning.
wire line_begins = first_half && column == 0;
wire [11:0] picture_line = line - V_BLANK, column_ahead = column + LEAD;
wire [11:0] picture_column = column_ahead - H_BLANK;
wire in_columns = column_ahead >= H_BLANK && column_ahead < H_TOTAL;
always @* if (known) begin
    assert (scan_start_screen == (line_begins && line == V_BLANK - DOUBLING));
    assert (scan_start_row == (line_begins && line >= V_BLANK && picture_line % DOUBLING == 0));
    assert (scan_visible_line == in_columns);
    assert (scan_next_column == (last_half && in_columns && picture_column % DOUBLING == DOUBLING - 1));
end

// Rows since StartScreen: all ROWS when the next StartScreen comes.
reg [11:0] rows_seen;
reg screen_seen;
always @(posedge clk) begin
    if (reset || scan_start_screen) {screen_seen, rows_seen} <= {!reset, 12'b0};
    else if (scan_start_row) rows_seen <= rows_seen + 1;
end
always @* if (known && screen_seen) begin
    assert (rows_seen <= ROWS);
    if (scan_start_screen) assert (rows_seen == ROWS);
end

// Invariants: the reference is in range, its shown position is behind the prepared one, and the generator's registers
// match the position.
wire signed [15:0] x = dut.x, y = dut.y;
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
    assert (dut.pixel_end == last_half);
    assert (dut.pixel_repeat == (in_columns ? picture_column % DOUBLING : 0));
    assert (dut.line_repeat == (y < 0 ? 0 : picture_line % DOUBLING));
    if (screen_seen) begin
        if (line >= V_BLANK) assert (rows_seen == row_of_line + !row_begins);
        else if (line < V_BLANK - DOUBLING || scan_start_screen) assert (rows_seen == ROWS);
        else assert (rows_seen == 0);
    end
end
endmodule
