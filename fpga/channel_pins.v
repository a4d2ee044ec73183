// SPDX-License-Identifier: MIT

`timescale 1ns/10ps

// Connects a colour channel to the pins of its DAC, aligned at the top bit. A DAC with more bits gets the channel
// repeated from its top bit on, so that all ones are full scale and all zeros are black; one with fewer gets the upper
// bits.
module channel_pins #(
    parameter BITS = 8,
    parameter PINS = 8
) (
    input  wire [BITS-1:0] channel,
    output wire [PINS-1:0] pins
);

genvar i;
generate
    for (i = 0; i < PINS; i = i + 1) begin : pin
        assign pins[PINS - 1 - i] = channel[BITS - 1 - i % BITS];
    end
endgenerate

endmodule
