// SPDX-License-Identifier: MIT
// The beam engine's colours compared with the golden model's definition, at full width. The blend starts with the
// colour that the last ray sees; each mirror before it adds its colour and keeps as many quarters of the blend as it
// mirrors, two if MIXES is 0. Nothing is rounded before the end. From the first ray that found nothing on, the
// background is seen.
//
// Assumed, as the registers guarantee: no more reflections than the design has; mirrors of 0 to 4 quarters; a picture
// that is constant while a pixel is computed. The seen colours may change in every cycle.
//
// [proof]
// claim = """a pixel is the golden model's blend of its rays, with mirrors of half, or one of any quarters, at \
// full width"""
// modules = ["colour_blend", "colour_mix if MIRRORS and MIXES", "colour_mean if MIRRORS and not MIXES", "colour_seen"]
// parameters = { MIRRORS = "REFLECTIONS", LATENCY = "BLEND_LATENCY" }
// induction = "LATENCY"
// reach = "LATENCY + 2"
// quick = ["beam two reflections=2", "beam two materials"]
// designs = ["beam two reflections=1,3,4"]
// [faults]
// "beam-vga240-s2-u1-r2-m2-c8" = ["colour_mean_1.other[8] 0", "colour_mean.reflections edge",
//   "colour_seen.reached 1"]
// "beam-vga240-s2-u1-r2-m1-c8-materials" = ["colour_mix.apart short", "colour_mix.mirror[0] unless mirror[1]",
//   "colour_seen.mirror as seen_mirror"]

module blend_exact;
localparam SEEN_BITS = MIXES ? 28 : 25, WIDE = 12 + 2 * MIRRORS;
colour_blend dut (.*);

// The rays, the first in the lowest bits.
wire [MIRRORS:0] found;
wire [24*MIRRORS+23:0] colours;
wire [3*MIRRORS+2:0] quarters;
reg [LATENCY:0] age = 0;
always @(posedge clk) age <= {age, 1'b1};
always @* begin
    assume (picture_reflections <= MIRRORS);
    if (age[0]) assume ($stable(picture_reflections) && $stable(picture_background));
end
generate
    genvar ray;
    for (ray = 0; ray <= MIRRORS; ray = ray + 1) begin: rays
        wire [SEEN_BITS-1:0] saw = seen[ray*SEEN_BITS +: SEEN_BITS];
        assign {found[ray], colours[24*ray +: 24]} = {saw[SEEN_BITS-1], saw[23:0]};
        assign quarters[3*ray +: 3] = MIXES ? saw >> 24 & 7 : 2;
        always @* assume (quarters[3*ray +: 3] <= 4);
    end
endgenerate

// A product with a case for each factor, so that the solver can treat them one by one.
function [WIDE-1:0] times(input [2:0] factor, input [WIDE-1:0] value);
    times = factor == 4 ? value << 2 : factor == 3 ? (value << 1) + value : factor == 2 ? value << 1
        : factor == 1 ? value : 0;
endfunction
function [7:0] defined(input integer channel, input [MIRRORS:0] hit, input [24*MIRRORS+23:0] colour,
                       input [3*MIRRORS+2:0] mirror, input [23:0] nothing, input [2:0] last);
    integer each;
    reg reached;
    reg [8*MIRRORS+7:0] seen_there;
    reg [WIDE-1:0] total;
    begin
        reached = 1;
        for (each = 0; each <= MIRRORS; each = each + 1) begin
            reached = reached && hit[each];
            seen_there[8*each +: 8] = reached ? colour[24*each + 8*channel +: 8] : nothing[8*channel +: 8];
        end
        total = 0;
        for (each = MIRRORS; each >= 0; each = each - 1) begin
            if (each == last) total = seen_there[8*each +: 8];
            else if (each < last)
                total = (times(4 - mirror[3*each +: 3], seen_there[8*each +: 8]) << 2 * (last - 1 - each))
                    + times(mirror[3*each +: 3], total);
        end
        defined = total >> 2 * last;
    end
endfunction

generate
    genvar channel;
    for (channel = 0; channel < 3; channel = channel + 1) begin: channels
        reg [7:0] expected [0:LATENCY-1];
        integer stage;
        always @(posedge clk) begin
            expected[0] <= defined(channel, found, colours, quarters, picture_background, picture_reflections);
            for (stage = 1; stage < LATENCY; stage = stage + 1) expected[stage] <= expected[stage-1];
        end
        always @* if (age[LATENCY-1])
            assert (pixel_word[channel*COLOUR_BITS +: COLOUR_BITS] == expected[LATENCY-1] >> 8 - COLOUR_BITS);
    end
endgenerate

always @* cover (age[LATENCY-1] && pixel_word == {3{8'd77}} && picture_reflections == MIRRORS);
endmodule
