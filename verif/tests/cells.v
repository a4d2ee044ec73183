// SPDX-License-Identifier: MIT
// Products and memories in all forms that a flow maps to hard multipliers and block RAM.

// A word is written by lanes and read by another port. A word that is being written is read as it was.
module pair #(
    parameter WIDTH = 9, BITS = 4, LANES = 1
) (
    input wire clk,
    input wire [BITS-1:0] at, from,
    input wire [LANES-1:0] write,
    input wire read, clear,
    input wire [WIDTH-1:0] data,
    output reg [WIDTH-1:0] seen
);
    localparam LANE = WIDTH / LANES;
    (* ram_style = "block" *) reg [WIDTH-1:0] words [0:(1<<BITS)-1];
    integer lane;

    always @(posedge clk) begin
        for (lane = 0; lane < LANES; lane = lane + 1)
            if (write[lane])
                words[at][LANE * lane +: LANE] <= data[LANE * lane +: LANE];
        if (clear)
            seen <= 0;
        else if (read)
            seen <= words[from];
    end
endmodule

// One port, which writes or reads. MODE: while it writes, it reads 0 nothing, 1 the new word, 2 the old word.
module single #(
    parameter WIDTH = 9, BITS = 4, LANES = 1, MODE = 0
) (
    input wire clk,
    input wire [BITS-1:0] at,
    input wire [LANES-1:0] write,
    input wire enable, clear,
    input wire [WIDTH-1:0] data,
    output reg [WIDTH-1:0] seen
);
    localparam LANE = WIDTH / LANES;
    (* ram_style = "block" *) reg [WIDTH-1:0] words [0:(1<<BITS)-1];
    integer lane;

    always @(posedge clk)
        if (enable) begin
            for (lane = 0; lane < LANES; lane = lane + 1)
                if (write[lane])
                    words[at][LANE * lane +: LANE] <= data[LANE * lane +: LANE];
            if (MODE == 2 || write == 0)
                seen <= words[at];
            else if (MODE == 1)
                seen <= data;
            if (clear)
                seen <= 0;
        end
endmodule

// Bytes, of which four are read at a time.
module wide #(
    parameter BITS = 11
) (
    input wire clk,
    input wire [BITS-1:0] at,
    input wire [BITS-3:0] from,
    input wire write, read,
    input wire [8:0] data,
    output reg [35:0] seen
);
    (* ram_style = "block" *) reg [8:0] words [0:(1<<BITS)-1];

    always @(posedge clk) begin
        if (write)
            words[at] <= data;
        if (read)
            seen <= {words[{from, 2'd3}], words[{from, 2'd2}], words[{from, 2'd1}], words[{from, 2'd0}]};
    end
endmodule

module known #(
    parameter WIDTH = 18, BITS = 9
) (
    input wire clk,
    input wire [BITS-1:0] from,
    output reg [WIDTH-1:0] seen
);
    (* ram_style = "block" *) reg [WIDTH-1:0] words [0:(1<<BITS)-1];
    integer word;

    initial
        for (word = 0; word < 1 << BITS; word = word + 1)
            words[word] = word * 64'h9e3779b97f4a7c15 >> 20;

    always @(posedge clk)
        seen <= words[from];
endmodule

module cells (
    input wire clk, enable, clear,
    input wire signed [35:0] a, b,
    input wire [8:0] at, from,
    input wire [3:0] write,
    output wire [8:0] bits,
    output wire [35:0] lanes36, lanes32, once_held, once_new, once_old, rom,
    output wire [35:0] four,
    output wire [17:0] lanes18, new18,
    output reg signed [18:0] plain, enabled, cleared, later, twice,
    output reg signed [11:0] narrow,
    output reg signed [19:0] added,
    output wire signed [18:0] now,
    output reg [35:0] whole,
    output reg signed [35:0] negative,
    output reg [15:0] nine,
    output reg signed [43:0] split, long, rare, fresh,
    output reg signed [23:0] read_twice
);
    // Few addresses, so that they meet; they use the lowest and the highest bits.
    wire [13:0] high = {at[2], 11'b0, at[1:0]}, low = {from[2], 11'b0, from[1:0]};

    pair #(.WIDTH(1), .BITS(14)) pair1 (clk, high, low, write[0], enable, 1'b0, a[0], bits[0]);
    pair #(.WIDTH(2), .BITS(13)) pair2 (clk, high[13:1], low[13:1], write[0], enable, 1'b0, a[1:0], bits[2:1]);
    pair #(.WIDTH(4), .BITS(12)) pair4 (
        clk, {high[13], 8'b0, high[2:0]}, {low[13], 8'b0, low[2:0]}, write[0], enable, clear, a[3:0], bits[6:3]
    );
    single #(.WIDTH(9), .BITS(11)) nines (clk, high[13:3] ^ high[2:0], write[0], enable, 1'b0, a[8:0], once_held[8:0]);
    single #(.WIDTH(18), .BITS(10), .LANES(2), .MODE(2)) twos (
        clk, high[13:4] ^ high[3:0], write[1:0], enable, clear, a[17:0], once_held[26:9]
    );
    pair #(.WIDTH(18), .BITS(10), .LANES(2)) pair18 (
        clk, high[13:4] ^ high[3:0], low[13:4] ^ low[3:0], write[1:0], enable, clear, a[17:0], lanes18
    );
    pair #(.WIDTH(36), .LANES(4)) pair36 (clk, at[3:0], from[3:0], write, enable, clear, a, lanes36);
    pair #(.WIDTH(32), .LANES(4)) pair32 (clk, at[3:0], from[3:0], write, 1'b1, 1'b0, b[31:0], lanes32[31:0]);
    single #(.WIDTH(36), .MODE(1)) once1 (clk, at[3:0], write[0], enable, 1'b0, a, once_new);
    single #(.WIDTH(36), .LANES(4), .MODE(2)) once2 (clk, at[3:0], write, enable, 1'b0, b, once_old);
    single #(.WIDTH(18), .BITS(10), .MODE(1)) new1 (
        clk, high[13:4] ^ high[3:0], write[0], enable, 1'b0, b[17:0], new18
    );
    wide fours (clk, {high[13], 6'b0, high[1:0], b[10:9]}, low[13:5] ^ low[1:0], write[0], enable, b[8:0], four);
    known #(.WIDTH(36)) rom36 (clk, at, rom);

    assign bits[8:7] = 2'b0, lanes32[35:32] = 4'b0, once_held[35:27] = 9'b0;

    // Only `plain` and `narrow` are plain registers that alone read a product.
    wire signed [9:0] x = a[9:0];
    wire signed [8:0] y = b[8:0];
    wire signed [18:0] shared = x * (y + 9'sd3), again_too = (x + 10'sd3) * y;
    reg signed [18:0] again;

    // Each of these products takes several multipliers. Only `long` has both factors from plain registers; `left` is also
    // read elsewhere.
    reg signed [23:0] left, left_rare;
    reg signed [19:0] right, right_fresh;

    assign now = shared;

    always @(posedge clk) begin
        plain <= x * y;
        narrow <= (x + 10'sd1) * y;
        if (enable)
            enabled <= x * (y + 9'sd1);
        cleared <= clear ? 19'sd0 : (x + 10'sd2) * y;
        added <= x * (y + 9'sd2) + 20'sd1;
        later <= shared;
        again <= again_too;
        twice <= again ^ again_too;
        whole <= a[17:0] * b[17:0];
        negative <= $signed(a[17:0]) * $signed(b[17:0]);
        nine <= a[7:0] * b[7:0];
        split <= $signed(a[23:0]) * $signed(b[19:0]);
        left <= a[23:0] ^ b[30:7];
        right <= b[19:0] ^ a[35:16];
        long <= left * right;
        read_twice <= left;
        if (enable)
            left_rare <= a[25:2];
        right_fresh <= clear ? 20'sd0 : b[22:3];
        rare <= left_rare * $signed(b[20:1]);
        fresh <= $signed(a[26:3]) * right_fresh;
    end
endmodule
