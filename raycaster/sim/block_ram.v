// SPDX-License-Identifier: MIT
// Model of a block RAM of 18 Kbit with two ports, each with a clock, a width and a write mode; the ECP5 and Gowin's
// chips have the same. Ports of 18 and 36 bits have an enable per byte of 9 bits for writing, in the lowest bits of the
// address, which they do not need. A bit is read as unknown if the other port writes it, and is written as unknown if
// both ports write it, because the makers do not define these. What is read starts unknown.

module block_ram #(
    parameter WIDTH_A = 18, WIDTH_B = 18,       // 1, 2, 4, 9, 18 or 36
    // What a port reads while it writes. 0: as before, 1: the new word, 2: the old word.
    parameter MODE_A = 0, MODE_B = 0,
    parameter [18431:0] CONTENTS = 18432'b0
) (
    input wire clk_a, clk_b, enable_a, enable_b, write_a, write_b,
    input wire reset_a, reset_b,                // of what is read, even without enable
    input wire [13:0] address_a, address_b,
    input wire [35:0] data_a, data_b,
    output reg [35:0] seen_a, seen_b
);
    // Combined with exclusive or: bits become unknown or, where there are no unknown bits, wrong.
`ifdef VERILATOR
    localparam [35:0] UNKNOWN = ~36'b0;
`else
    localparam [35:0] UNKNOWN = 36'bx;
`endif

    reg [35:0] rows [0:511];
    integer row, byte_a, byte_b;

    initial
        for (row = 0; row < 512; row = row + 1)
            rows[row] = CONTENTS[row * 36 +: 36];

    // Place of a word in its row. Words of less than a byte leave the ninth bit unused.
    function [5:0] place;
        input integer width;
        input [4:0] address;
        case (width)
            36: place = 0;
            18: place = 18 * address[4];
            9: place = 9 * address[4:3];
            default: place = 9 * address[4:3] + address[2:0] / width * width;
        endcase
    endfunction

    function [35:0] bits;
        input integer width;
        bits = ~(~36'b0 << width);
    endfunction

    // Bits of a row that a write changes.
    function [35:0] changed;
        input integer width;
        input [4:0] address;
        case (width)
            36: changed = {{9{address[3]}}, {9{address[2]}}, {9{address[1]}}, {9{address[0]}}};
            18: changed = {{9{address[1]}}, {9{address[0]}}} << place(width, address);
            default: changed = bits(width) << place(width, address);
        endcase
    endfunction

    wire [35:0] changed_a = enable_a && write_a ? changed(WIDTH_A, address_a[4:0]) : 36'b0;
    wire [35:0] changed_b = enable_b && write_b ? changed(WIDTH_B, address_b[4:0]) : 36'b0;
    wire same = address_a[13:5] === address_b[13:5];
    wire [35:0] unknown_a = same ? changed_b & UNKNOWN : 36'b0;
    wire [35:0] unknown_b = same ? changed_a & UNKNOWN : 36'b0;
    wire [35:0] new_a = data_a << place(WIDTH_A, address_a[4:0]) ^ unknown_a;
    wire [35:0] new_b = data_b << place(WIDTH_B, address_b[4:0]) ^ unknown_b;

    function [35:0] mixed;
        input [35:0] kept, given, mask;
        mixed = kept & ~mask | given & mask;
    endfunction

    // Bytes are written apart, as the ports may write different ones of a row.
    always @(posedge clk_a) begin
        for (byte_a = 0; byte_a < 36; byte_a = byte_a + 9)
            if (changed_a[byte_a +: 9] != 0)
                rows[address_a[13:5]][byte_a +: 9] <=
                    mixed(rows[address_a[13:5]], new_a, changed_a) >> byte_a;
        if (reset_a)
            seen_a <= 36'b0;
        else if (enable_a && !(write_a && MODE_A == 0))
            seen_a <= (mixed(rows[address_a[13:5]], new_a, MODE_A == 1 ? changed_a : 36'b0) ^ unknown_a)
                >> place(WIDTH_A, address_a[4:0]) & bits(WIDTH_A);
    end

    always @(posedge clk_b) begin
        for (byte_b = 0; byte_b < 36; byte_b = byte_b + 9)
            if (changed_b[byte_b +: 9] != 0)
                rows[address_b[13:5]][byte_b +: 9] <=
                    mixed(rows[address_b[13:5]], new_b, changed_b) >> byte_b;
        if (reset_b)
            seen_b <= 36'b0;
        else if (enable_b && !(write_b && MODE_B == 0))
            seen_b <= (mixed(rows[address_b[13:5]], new_b, MODE_B == 1 ? changed_b : 36'b0) ^ unknown_b)
                >> place(WIDTH_B, address_b[4:0]) & bits(WIDTH_B);
    end

    function bad;
        input integer width;
        bad = width != 1 && width != 2 && width != 4 && width != 9 && width != 18 && width != 36;
    endfunction

    generate
        if (bad(WIDTH_A) || bad(WIDTH_B))
            unmodelled_parameter width();
    endgenerate
endmodule
