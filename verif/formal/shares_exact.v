// SPDX-License-Identifier: MIT
// The colours of the engines that sum up the colours of rays, at full width: each ray has a weight, passes on as many
// quarters of it as it mirrors, or half if MATERIALS is 0, and adds its colour with the rest. The last ray passes on
// nothing, nor, with MATERIALS, does one that found nothing. No quarter is lost. By the lemma shares, the sum is that
// of the golden model, which blends from the last ray back. From the first ray that found nothing on, the background is
// seen.
//
// Assumed, as the control guarantees: rays come one after the other, each with one addition, and all except the last
// one store a reflected ray in the same cycle; the picture's reflections are constant meanwhile. Assumed, as the
// registers guarantee: a mirror is 0 to 4 quarters, and a picture has no more reflections than the design.
//
// [proof]
// claim = "a pixel is the golden model's blend of what its rays saw one after the other, at full width"
// modules = ["colour_combiner", "colour_share", "colour_sum"]
// induction = 1
// reach = "REFLECTIONS + 5"
// quick = ["exact one-unit reflections=1", "exact one-unit reflections=2 materials"]
// designs = ["exact one-unit reflections=1,2,3,4 materials=0,1"]
// [faults]
// "exact-vga240-u1-r12-m2-c8-materials" = ["colour_share.some as half", "colour_share.found 1",
//   "colour_share.left short", "colour_sum.weighted as at_even"]
// "exact-vga240-u1-r12-m4-c8-materials" = ["colour_share.some as half", "colour_sum.share short"]
// "exact-vga240-u1-r12-m1-c8" = ["colour_share.steps_store_ray 1", "colour_combiner.missed 0"]

module shares_exact #(
    parameter MATERIALS = 0, parameter REFLECTIONS = 1, parameter COLOUR_BITS = 8, parameter SHARE_BITS = 2
) (
    input clk, input reset, input add, input found, input [23:0] colour, input [2:0] mirror, input [23:0] background,
    input [2:0] reflections
);
localparam SUM_BITS = 7 + SHARE_BITS;

reg running = 1'b0, reached;
reg [2:0] rays, last_reflections;
wire is_last = rays == reflections, hit = reached && found;
wire [2:0] quarters = MATERIALS ? mirror : 3'd2;
reg [SHARE_BITS-1:0] weight;
// Without materials, half is still passed on after the background was reached, as only the background follows.
wire [SHARE_BITS+2:0] product = is_last || MATERIALS && !hit ? 0 : weight * quarters;
wire [SHARE_BITS-1:0] passed = product >> 2;
always @(posedge clk) begin
    last_reflections <= reflections;
    if (reset) begin
        running <= 1'b1;
        reached <= 1'b1;
        rays <= 0;
        weight <= 1 << SHARE_BITS - 1;
    end
    else if (add) begin
        reached <= hit;
        rays <= rays + 1;
        weight <= passed;
    end
end
always @* begin
    assume (mirror <= 4);
    assume (reflections <= REFLECTIONS);
    if (add) assume (running && !reset && rays <= reflections);
    if (running && rays > 0) assume (reflections == last_reflections);
    if (add) assert (product[1:0] == 0);
end

wire [3*COLOUR_BITS-1:0] pixel;
wire missed;
generate
    if (MATERIALS) begin: design
        colour_combiner dut (
            .clk(clk), .found(found), .found_colour(colour), .found_mirror(mirror), .missed(missed),
            .steps_reset_colour(reset), .steps_add_colour(add), .steps_store_ray(add && !is_last),
            .picture_background(background), .pixel_word(pixel)
        );
    end
    else begin: design
        colour_combiner dut (
            .clk(clk), .found(found), .found_colour(colour), .missed(missed), .steps_reset_colour(reset),
            .steps_add_colour(add), .steps_store_ray(add && !is_last), .picture_background(background),
            .pixel_word(pixel)
        );
    end
endgenerate

// Invariants: a weight is at most the full one, and has a factor of 4 for each mirror that may follow. With at most two
// mirrors it is a product of two numbers 0 to 4, so the design needs only two summands; with more mirrors it
// multiplies.
function multiple_of_4(input [SHARE_BITS-1:0] number, input [2:0] times);
    multiple_of_4 = (number & (1 << 2 * times) - 1) == 0;
endfunction
function of_two_mirrors(input [SHARE_BITS-1:0] number);
    integer one, other;
    begin
        of_two_mirrors = 0;
        for (one = 0; one <= 4; one = one + 1)
            for (other = 0; other <= 4; other = other + 1)
                if (number == one * other) of_two_mirrors = 1;
    end
endfunction
(* hierconn *) wire [SHARE_BITS-1:0] \design.dut.colour_share_i.weight ;
(* hierconn *) wire [SHARE_BITS-1:0] \design.dut.colour_share_i.share ;
(* hierconn *) wire [7:0] \design.dut.colour_sum_0_i.channel , \design.dut.colour_sum_1_i.channel ;
(* hierconn *) wire [7:0] \design.dut.colour_sum_2_i.channel ;
(* hierconn *) wire [SUM_BITS-1:0] \design.dut.colour_sum_0_i.total ;
(* hierconn *) wire [SUM_BITS-1:0] \design.dut.colour_sum_1_i.total ;
(* hierconn *) wire [SUM_BITS-1:0] \design.dut.colour_sum_2_i.total ;
wire [3*SUM_BITS-1:0] totals = {
    \design.dut.colour_sum_0_i.total , \design.dut.colour_sum_1_i.total , \design.dut.colour_sum_2_i.total
};
wire [23:0] seen = {
    \design.dut.colour_sum_0_i.channel , \design.dut.colour_sum_1_i.channel , \design.dut.colour_sum_2_i.channel
};
always @* if (add) begin
    assert (\design.dut.colour_share_i.share == weight - passed);
    if (weight != 0) assert (seen == (hit ? colour : background));
end
always @* if (running) begin
    assert (rays <= reflections + 1);
    if (rays <= reflections) begin
        assert (weight == \design.dut.colour_share_i.weight );
        if (MATERIALS) assert (multiple_of_4(weight, REFLECTIONS - rays) && weight <= 1 << SHARE_BITS - 1);
        if (MATERIALS && REFLECTIONS <= 2) assert (of_two_mirrors(weight));
        if (MATERIALS) assert (reached || weight == 0);
        else assert (weight << rays == 1 << SHARE_BITS - 1);
        assert (missed == (MATERIALS ? weight == 0 : !reached));
    end
end

// A product with a case for each factor, so that the solver can treat them one by one. If the design multiplies, the
// operands are signals of the design, which are asserted to be right.
function [SUM_BITS-1:0] times(input [SHARE_BITS-1:0] share, input [7:0] saw);
    integer number;
    begin
        times = 0;
        for (number = 0; number <= 1 << SHARE_BITS - 1; number = number + 1)
            if (share == number) times = number * saw;
    end
endfunction
generate
    genvar channel;
    for (channel = 0; channel < 3; channel = channel + 1) begin: channels
        wire [7:0] saw = seen[8*channel +: 8];
        wire [SUM_BITS-1:0] shown;
        if (MATERIALS && REFLECTIONS > 2) assign shown = saw * \design.dut.colour_share_i.share ;
        else assign shown = times(weight - passed, saw);
        reg [SUM_BITS-1:0] sum;
        always @(posedge clk) begin
            if (reset) sum <= 0;
            else if (add) sum <= sum + shown;
        end
        always @* if (running) begin
            assert (totals[SUM_BITS*channel +: SUM_BITS] == sum);
            assert (pixel[COLOUR_BITS*channel +: COLOUR_BITS] == sum >> SUM_BITS - COLOUR_BITS);
        end
    end
endgenerate

always @* cover (running && rays == REFLECTIONS + 1 && reached && pixel == 24'h4d4d4d);
endmodule
