// SPDX-License-Identifier: MIT
// One contest of the beam engine at full width, with any function instead of multiplication: the nearer of two
// candidates, by cross-multiplication, is passed on with all its fields, or the first one if they tie.
//
// Assumed about products with a factor wider than a multiplier is the lemma product-in-parts. All inputs may change in
// every cycle.
//
// [proof]
// claim = "the nearer of two candidates wins, by cross-multiplication, or the first if they tie, at full width"
// modules = ["nearest_of_two"]
// any_product = true
// induction = "LATENCY"
// reach = "LATENCY + 2"
// quick = ["beam two", "beam two pairs", "beam two turn patterns reflections=4"]
// designs = ["beam two turn", "beam two pairs turn"]
// parameters = { LATENCY = "CONTEST_LATENCY" }
// [faults]
// "beam-vga240-s2-u1-r2-m4-c8-turn-patterns" = ["nearest_of_two.second_product edge",
//   "nearest_of_two.second_high as first_high", "nearest_of_two.second_more[11] 0",
//   "nearest_of_two.second_1_valid 1"]
// "beam-vga180-s6-u2-r2-m1-c8-turn" = ["nearest_of_two.second_high short"]
// "beam-vga180-s6-u2-r2-m1-c8" = ["nearest_of_two.first_product as second_product",
//   "nearest_of_two.second_way short", "nearest_of_two.second_way as second_product"]

module contest_products;
localparam N = NUMERATOR_BITS, E = DENOMINATOR_BITS, WAY_BITS = N + E, MULTIPLIER_BITS = 18;

nearest_of_two dut (.*);

wire [WAY_BITS-1:0] first_way = first_numerator * second_denominator;
wire [WAY_BITS-1:0] second_way = second_numerator * first_denominator;
generate
    if (E > MULTIPLIER_BITS) begin: parts
        function [WAY_BITS-1:0] above(input [WAY_BITS-1:0] n, input [E-1:0] e);
            integer place;
            begin
                above = 0;
                for (place = MULTIPLIER_BITS; place < E; place = place + 1)
                    if (e[place]) above = above + (n << place);
            end
        endfunction
        wire [N+MULTIPLIER_BITS-1:0] first_below = first_numerator * second_denominator[MULTIPLIER_BITS-1:0];
        wire [N+MULTIPLIER_BITS-1:0] second_below = second_numerator * first_denominator[MULTIPLIER_BITS-1:0];
        always @* begin
            assume (first_way == first_below + above(first_numerator, second_denominator));
            assume (second_way == second_below + above(second_numerator, first_denominator));
        end
    end
endgenerate

reg [LATENCY-1:0] age = 0;
reg [LATENCY*CANDIDATE_BITS-1:0] expected;
always @(posedge clk) begin
    age <= {age, 1'b1};
    expected <= {expected, second_valid && (!first_valid || second_way < first_way) ? second_word : first_word};
end
always @* if (age[LATENCY-1]) assert (nearest_word == expected[LATENCY*CANDIDATE_BITS-1 -: CANDIDATE_BITS]);

always @* cover (age[LATENCY-1] && nearest_valid && nearest_index == 1);
endmodule
