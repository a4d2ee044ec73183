// SPDX-License-Identifier: MIT
// Models of the multipliers and the block RAM of Gowin's GW2A, which Yosys's library has as black boxes, in the modes
// that Yosys uses. See Gowin's guides UG287 (DSP) and UG285 (BSRAM). Instances of unmodelled_parameter, a module
// that does not exist, refuse other modes.

`define CONTENTS \
    INIT_RAM_00 = 0, INIT_RAM_01 = 0, INIT_RAM_02 = 0, INIT_RAM_03 = 0, \
    INIT_RAM_04 = 0, INIT_RAM_05 = 0, INIT_RAM_06 = 0, INIT_RAM_07 = 0, \
    INIT_RAM_08 = 0, INIT_RAM_09 = 0, INIT_RAM_0A = 0, INIT_RAM_0B = 0, \
    INIT_RAM_0C = 0, INIT_RAM_0D = 0, INIT_RAM_0E = 0, INIT_RAM_0F = 0, \
    INIT_RAM_10 = 0, INIT_RAM_11 = 0, INIT_RAM_12 = 0, INIT_RAM_13 = 0, \
    INIT_RAM_14 = 0, INIT_RAM_15 = 0, INIT_RAM_16 = 0, INIT_RAM_17 = 0, \
    INIT_RAM_18 = 0, INIT_RAM_19 = 0, INIT_RAM_1A = 0, INIT_RAM_1B = 0, \
    INIT_RAM_1C = 0, INIT_RAM_1D = 0, INIT_RAM_1E = 0, INIT_RAM_1F = 0, \
    INIT_RAM_20 = 0, INIT_RAM_21 = 0, INIT_RAM_22 = 0, INIT_RAM_23 = 0, \
    INIT_RAM_24 = 0, INIT_RAM_25 = 0, INIT_RAM_26 = 0, INIT_RAM_27 = 0, \
    INIT_RAM_28 = 0, INIT_RAM_29 = 0, INIT_RAM_2A = 0, INIT_RAM_2B = 0, \
    INIT_RAM_2C = 0, INIT_RAM_2D = 0, INIT_RAM_2E = 0, INIT_RAM_2F = 0, \
    INIT_RAM_30 = 0, INIT_RAM_31 = 0, INIT_RAM_32 = 0, INIT_RAM_33 = 0, \
    INIT_RAM_34 = 0, INIT_RAM_35 = 0, INIT_RAM_36 = 0, INIT_RAM_37 = 0, \
    INIT_RAM_38 = 0, INIT_RAM_39 = 0, INIT_RAM_3A = 0, INIT_RAM_3B = 0, \
    INIT_RAM_3C = 0, INIT_RAM_3D = 0, INIT_RAM_3E = 0, INIT_RAM_3F = 0
`define SLICES \
        INIT_RAM_3F, INIT_RAM_3E, INIT_RAM_3D, INIT_RAM_3C, INIT_RAM_3B, INIT_RAM_3A, INIT_RAM_39, INIT_RAM_38, \
        INIT_RAM_37, INIT_RAM_36, INIT_RAM_35, INIT_RAM_34, INIT_RAM_33, INIT_RAM_32, INIT_RAM_31, INIT_RAM_30, \
        INIT_RAM_2F, INIT_RAM_2E, INIT_RAM_2D, INIT_RAM_2C, INIT_RAM_2B, INIT_RAM_2A, INIT_RAM_29, INIT_RAM_28, \
        INIT_RAM_27, INIT_RAM_26, INIT_RAM_25, INIT_RAM_24, INIT_RAM_23, INIT_RAM_22, INIT_RAM_21, INIT_RAM_20, \
        INIT_RAM_1F, INIT_RAM_1E, INIT_RAM_1D, INIT_RAM_1C, INIT_RAM_1B, INIT_RAM_1A, INIT_RAM_19, INIT_RAM_18, \
        INIT_RAM_17, INIT_RAM_16, INIT_RAM_15, INIT_RAM_14, INIT_RAM_13, INIT_RAM_12, INIT_RAM_11, INIT_RAM_10, \
        INIT_RAM_0F, INIT_RAM_0E, INIT_RAM_0D, INIT_RAM_0C, INIT_RAM_0B, INIT_RAM_0A, INIT_RAM_09, INIT_RAM_08, \
        INIT_RAM_07, INIT_RAM_06, INIT_RAM_05, INIT_RAM_04, INIT_RAM_03, INIT_RAM_02, INIT_RAM_01, INIT_RAM_00

module gowin_product #(
    parameter WIDTH = 18, REGISTERS = 0
) (
    input wire [WIDTH-1:0] a, b,
    input wire a_signed, b_signed, a_shifted, b_shifted,
    output wire [2*WIDTH-1:0] product
);
    wire signed [WIDTH:0] left = {a_signed & a[WIDTH-1], a};
    wire signed [WIDTH:0] right = {b_signed & b[WIDTH-1], b};
    wire signed [2*WIDTH+1:0] whole = left * right;

    assign product = a_shifted === 1'b0 && b_shifted === 1'b0 ? whole[2*WIDTH-1:0] : {2*WIDTH{1'bx}};

    generate
        if (REGISTERS)
            unmodelled_parameter registers();
    endgenerate
endmodule

module MULT9X9 #(
    parameter AREG = 0, BREG = 0, OUT_REG = 0, PIPE_REG = 0, ASIGN_REG = 0, BSIGN_REG = 0, SOA_REG = 0,
    MULT_RESET_MODE = "SYNC"
) (
    input wire CLK, CE, RESET, ASIGN, BSIGN, ASEL, BSEL,
    input wire [8:0] A, B, SIA, SIB,
    output wire [17:0] DOUT
);
    gowin_product #(
        .WIDTH(9), .REGISTERS(AREG || BREG || OUT_REG || PIPE_REG || ASIGN_REG || BSIGN_REG || SOA_REG)
    ) product (
        .a(A), .b(B), .a_signed(ASIGN), .b_signed(BSIGN), .a_shifted(ASEL), .b_shifted(BSEL), .product(DOUT)
    );
endmodule

module MULT18X18 #(
    parameter AREG = 0, BREG = 0, OUT_REG = 0, PIPE_REG = 0, ASIGN_REG = 0, BSIGN_REG = 0, SOA_REG = 0,
    MULT_RESET_MODE = "SYNC"
) (
    input wire CLK, CE, RESET, ASIGN, BSIGN, ASEL, BSEL,
    input wire [17:0] A, B, SIA, SIB,
    output wire [35:0] DOUT
);
    gowin_product #(
        .WIDTH(18), .REGISTERS(AREG || BREG || OUT_REG || PIPE_REG || ASIGN_REG || BSIGN_REG || SOA_REG)
    ) product (
        .a(A), .b(B), .a_signed(ASIGN), .b_signed(BSIGN), .a_shifted(ASEL), .b_shifted(BSEL), .product(DOUT)
    );
endmodule

module MULT36X36 #(
    parameter AREG = 0, BREG = 0, OUT0_REG = 0, OUT1_REG = 0, PIPE_REG = 0, ASIGN_REG = 0, BSIGN_REG = 0,
    MULT_RESET_MODE = "SYNC"
) (
    input wire CLK, CE, RESET, ASIGN, BSIGN,
    input wire [35:0] A, B,
    output wire [71:0] DOUT
);
    gowin_product #(
        .WIDTH(36), .REGISTERS(AREG || BREG || OUT0_REG || OUT1_REG || PIPE_REG || ASIGN_REG || BSIGN_REG)
    ) product (
        .a(A), .b(B), .a_signed(ASIGN), .b_signed(BSIGN), .a_shifted(1'b0), .b_shifted(1'b0), .product(DOUT)
    );
endmodule

// A block RAM whose bytes have 9 bits, or 8 of these. With 8, words are smaller than a byte. An asynchronous reset makes
// what is read unknown.
module gowin_ram #(
    parameter BYTE = 9, WIDTH_A = 36, WIDTH_B = 36, MODE_A = 0, MODE_B = 0, READ_MODES = 0, RESET_MODE = "SYNC",
    SELECT_A = 3'b000, SELECT_B = 3'b000,
    parameter [64*32*BYTE-1:0] INIT = 0
) (
    input wire clk_a, clk_b, enable_a, enable_b, write_a, write_b, reset_a, reset_b,
    input wire [2:0] select_a, select_b,
    input wire [13:0] address_a, address_b,
    input wire [4*BYTE-1:0] data_a, data_b,
    output wire [4*BYTE-1:0] seen_a, seen_b
);
    function [18431:0] contents;
        input unused;
        integer place;
        begin
            contents = 18432'b0;
            for (place = 0; place < 2048; place = place + 1)
                contents[9 * place +: BYTE] = INIT[BYTE * place +: BYTE];
        end
    endfunction

    wire [35:0] wide_a, wide_b, wide_data_a, wide_data_b;
    wire asynchronous = RESET_MODE != "SYNC" && {reset_a, reset_b} !== 2'b00;

    block_ram #(
        .WIDTH_A(WIDTH_A), .WIDTH_B(WIDTH_B), .MODE_A(MODE_A), .MODE_B(MODE_B), .CONTENTS(contents(1'b0))
    ) ram (
        .clk_a(clk_a), .enable_a(enable_a && select_a === SELECT_A), .write_a(write_a), .reset_a(reset_a),
        .address_a(address_a), .data_a(wide_data_a), .seen_a(wide_a),
        .clk_b(clk_b), .enable_b(enable_b && select_b === SELECT_B), .write_b(write_b), .reset_b(reset_b),
        .address_b(address_b), .data_b(wide_data_b), .seen_b(wide_b)
    );

    genvar lane;
    generate
        for (lane = 0; lane < 4; lane = lane + 1) begin: lanes
            assign wide_data_a[9 * lane +: 9] = data_a[BYTE * lane +: BYTE];
            assign wide_data_b[9 * lane +: 9] = data_b[BYTE * lane +: BYTE];
            assign seen_a[BYTE * lane +: BYTE] = asynchronous ? {BYTE{1'bx}} : wide_a[9 * lane +: BYTE];
            assign seen_b[BYTE * lane +: BYTE] = asynchronous ? {BYTE{1'bx}} : wide_b[9 * lane +: BYTE];
        end
        if (READ_MODES)
            unmodelled_parameter output_register();
    endgenerate
endmodule

module SPX9 #(
    parameter READ_MODE = 0, WRITE_MODE = 0, BIT_WIDTH = 36, BLK_SEL = 3'b000, RESET_MODE = "SYNC",
    parameter [287:0]
    `CONTENTS
) (
    input wire CLK, CE, OCE, RESET, WRE,
    input wire [2:0] BLKSEL,
    input wire [13:0] AD,
    input wire [35:0] DI,
    output wire [35:0] DO
);
    gowin_ram #(
        .BYTE(9), .WIDTH_A(BIT_WIDTH), .MODE_A(WRITE_MODE), .SELECT_A(BLK_SEL), .READ_MODES(READ_MODE),
        .RESET_MODE(RESET_MODE), .INIT({`SLICES})
    ) ram (
        .clk_a(CLK), .enable_a(CE), .write_a(WRE), .reset_a(RESET), .select_a(BLKSEL), .address_a(AD), .data_a(DI),
        .seen_a(DO),
        .clk_b(1'b0), .enable_b(1'b0), .write_b(1'b0), .reset_b(1'b0), .select_b(3'b000), .address_b(14'b0),
        .data_b(36'b0), .seen_b()
    );
endmodule

module SP #(
    parameter READ_MODE = 0, WRITE_MODE = 0, BIT_WIDTH = 32, BLK_SEL = 3'b000, RESET_MODE = "SYNC",
    parameter [255:0]
    `CONTENTS
) (
    input wire CLK, CE, OCE, RESET, WRE,
    input wire [2:0] BLKSEL,
    input wire [13:0] AD,
    input wire [31:0] DI,
    output wire [31:0] DO
);
    gowin_ram #(
        .BYTE(8), .WIDTH_A(BIT_WIDTH), .MODE_A(WRITE_MODE), .SELECT_A(BLK_SEL), .READ_MODES(READ_MODE),
        .RESET_MODE(RESET_MODE), .INIT({`SLICES})
    ) ram (
        .clk_a(CLK), .enable_a(CE), .write_a(WRE), .reset_a(RESET), .select_a(BLKSEL), .address_a(AD), .data_a(DI),
        .seen_a(DO),
        .clk_b(1'b0), .enable_b(1'b0), .write_b(1'b0), .reset_b(1'b0), .select_b(3'b000), .address_b(14'b0),
        .data_b(32'b0), .seen_b()
    );
endmodule

module SDPX9B #(
    parameter READ_MODE = 0, BIT_WIDTH_0 = 36, BIT_WIDTH_1 = 36, BLK_SEL_0 = 3'b000, BLK_SEL_1 = 3'b000,
    RESET_MODE = "SYNC",
    parameter [287:0]
    `CONTENTS
) (
    input wire CLKA, CLKB, CEA, CEB, OCE, RESETA, RESETB,
    input wire [2:0] BLKSELA, BLKSELB,
    input wire [13:0] ADA, ADB,
    input wire [35:0] DI,
    output wire [35:0] DO
);
    gowin_ram #(
        .BYTE(9), .WIDTH_A(BIT_WIDTH_0), .WIDTH_B(BIT_WIDTH_1), .SELECT_A(BLK_SEL_0), .SELECT_B(BLK_SEL_1),
        .READ_MODES(READ_MODE), .RESET_MODE(RESET_MODE), .INIT({`SLICES})
    ) ram (
        .clk_a(CLKA), .enable_a(CEA), .write_a(1'b1), .reset_a(RESETA), .select_a(BLKSELA), .address_a(ADA),
        .data_a(DI), .seen_a(),
        .clk_b(CLKB), .enable_b(CEB), .write_b(1'b0), .reset_b(RESETB), .select_b(BLKSELB), .address_b(ADB),
        .data_b(36'b0), .seen_b(DO)
    );
endmodule

module SDPB #(
    parameter READ_MODE = 0, BIT_WIDTH_0 = 32, BIT_WIDTH_1 = 32, BLK_SEL_0 = 3'b000, BLK_SEL_1 = 3'b000,
    RESET_MODE = "SYNC",
    parameter [255:0]
    `CONTENTS
) (
    input wire CLKA, CLKB, CEA, CEB, OCE, RESETA, RESETB,
    input wire [2:0] BLKSELA, BLKSELB,
    input wire [13:0] ADA, ADB,
    input wire [31:0] DI,
    output wire [31:0] DO
);
    gowin_ram #(
        .BYTE(8), .WIDTH_A(BIT_WIDTH_0), .WIDTH_B(BIT_WIDTH_1), .SELECT_A(BLK_SEL_0), .SELECT_B(BLK_SEL_1),
        .READ_MODES(READ_MODE), .RESET_MODE(RESET_MODE), .INIT({`SLICES})
    ) ram (
        .clk_a(CLKA), .enable_a(CEA), .write_a(1'b1), .reset_a(RESETA), .select_a(BLKSELA), .address_a(ADA),
        .data_a(DI), .seen_a(),
        .clk_b(CLKB), .enable_b(CEB), .write_b(1'b0), .reset_b(RESETB), .select_b(BLKSELB), .address_b(ADB),
        .data_b(32'b0), .seen_b(DO)
    );
endmodule

module DPX9B #(
    parameter READ_MODE0 = 0, READ_MODE1 = 0, WRITE_MODE0 = 0, WRITE_MODE1 = 0, BIT_WIDTH_0 = 18, BIT_WIDTH_1 = 18,
    BLK_SEL_0 = 3'b000, BLK_SEL_1 = 3'b000, RESET_MODE = "SYNC",
    parameter [287:0]
    `CONTENTS
) (
    input wire CLKA, CLKB, CEA, CEB, OCEA, OCEB, WREA, WREB, RESETA, RESETB,
    input wire [2:0] BLKSELA, BLKSELB,
    input wire [13:0] ADA, ADB,
    input wire [17:0] DIA, DIB,
    output wire [17:0] DOA, DOB
);
    wire [17:0] high_a, high_b;

    gowin_ram #(
        .BYTE(9), .WIDTH_A(BIT_WIDTH_0), .WIDTH_B(BIT_WIDTH_1), .MODE_A(WRITE_MODE0), .MODE_B(WRITE_MODE1),
        .SELECT_A(BLK_SEL_0), .SELECT_B(BLK_SEL_1), .READ_MODES(READ_MODE0 || READ_MODE1), .RESET_MODE(RESET_MODE),
        .INIT({`SLICES})
    ) ram (
        .clk_a(CLKA), .enable_a(CEA), .write_a(WREA), .reset_a(RESETA), .select_a(BLKSELA), .address_a(ADA),
        .data_a({18'b0, DIA}), .seen_a({high_a, DOA}),
        .clk_b(CLKB), .enable_b(CEB), .write_b(WREB), .reset_b(RESETB), .select_b(BLKSELB), .address_b(ADB),
        .data_b({18'b0, DIB}), .seen_b({high_b, DOB})
    );
endmodule

module DPB #(
    parameter READ_MODE0 = 0, READ_MODE1 = 0, WRITE_MODE0 = 0, WRITE_MODE1 = 0, BIT_WIDTH_0 = 16, BIT_WIDTH_1 = 16,
    BLK_SEL_0 = 3'b000, BLK_SEL_1 = 3'b000, RESET_MODE = "SYNC",
    parameter [255:0]
    `CONTENTS
) (
    input wire CLKA, CLKB, CEA, CEB, OCEA, OCEB, WREA, WREB, RESETA, RESETB,
    input wire [2:0] BLKSELA, BLKSELB,
    input wire [13:0] ADA, ADB,
    input wire [15:0] DIA, DIB,
    output wire [15:0] DOA, DOB
);
    wire [15:0] high_a, high_b;

    gowin_ram #(
        .BYTE(8), .WIDTH_A(BIT_WIDTH_0), .WIDTH_B(BIT_WIDTH_1), .MODE_A(WRITE_MODE0), .MODE_B(WRITE_MODE1),
        .SELECT_A(BLK_SEL_0), .SELECT_B(BLK_SEL_1), .READ_MODES(READ_MODE0 || READ_MODE1), .RESET_MODE(RESET_MODE),
        .INIT({`SLICES})
    ) ram (
        .clk_a(CLKA), .enable_a(CEA), .write_a(WREA), .reset_a(RESETA), .select_a(BLKSELA), .address_a(ADA),
        .data_a({16'b0, DIA}), .seen_a({high_a, DOA}),
        .clk_b(CLKB), .enable_b(CEB), .write_b(WREB), .reset_b(RESETB), .select_b(BLKSELB), .address_b(ADB),
        .data_b({16'b0, DIB}), .seen_b({high_b, DOB})
    );
endmodule
