// SPDX-License-Identifier: MIT
// Drives a clock on a pin: low while clk is high, with no more delay than the pins of registers.

module clock_pin (
    input  wire clk,
    output wire pin
);

// Bit 0 leaves at the rising edge of clk, bit 1 at the falling one.
SB_IO #(.PIN_TYPE(6'b010000)) driver (.PACKAGE_PIN(pin), .OUTPUT_CLK(clk), .CLOCK_ENABLE(1'b1), .D_OUT_0(1'b0), .D_OUT_1(1'b1));

endmodule
