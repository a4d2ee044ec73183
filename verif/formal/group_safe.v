// SPDX-License-Identifier: MIT
// Culling at full width: a rectangle that a ray of the group hits is never left out. `ray` is an arbitrary ray of the
// group, so what is asserted for it holds for all.
//
// Products and bounds are arbitrary numbers that grow linearly along the row; row-setup proves that they are products.
// Assumed about them: the lemma between, and that they fit their bits at the group's end, as at its start.
//
// [proof]
// claim = "no rectangle that a ray of the group hits is left out, at full width"
// modules = ["group_tester"]
// induction = 2
// reach = 4
// quick = ["exact culling=1"]
// designs = ["engine=seed"]
// [parameters]
// WALK_BITS = "WIDE_WALK_BITS"
// GROWTH_BITS = "WIDE_BITS"
// [faults]
// "exact-vga240-u4-r12-m1-c8-k1" = ["group_tester.end_least_p edge", "group_tester.end_way_p signed-short",
//   "group_tester.back inverted", "group_tester.behind or end_back", "group_tester.same_way_1 1"]

module group_safe;
localparam WIDE = WALK_BITS + UNIT_BITS + 2;

group_tester dut (.*);
(* anyseq *) reg [5*WALK_BITS-1:0] at_ray;
(* anyseq *) reg [UNIT_BITS-1:0] ray;
(* anyseq *) reg [INDEX_BITS-1:0] rectangle;
wire [1:0] axis = facet_axis;
wire signed [WALK_BITS-1:0] way_q = $signed(facet_way_q);
wire signed [DISTANCE_BITS-1:0] distance = facet_distance;

// Five values, the way along p and the low and high bounds on p and on q, at both ends of the group and at `ray`.
wire signed [WALK_BITS-1:0] first [0:4], there [0:4];
wire signed [WIDE-1:0] last [0:4];
generate
    genvar each;
    for (each = 0; each < 5; each = each + 1) begin: walks
        wire signed [GROWTH_BITS-1:0] a_column = growth_word[(4-each)*GROWTH_BITS +: GROWTH_BITS];
        wire signed [WIDE-1:0] reach = a_column * UNITS;
        assign first[each] = start_word[(4-each)*WALK_BITS +: WALK_BITS];
        assign last[each] = first[each] + reach;
        assign there[each] = at_ray[(4-each)*WALK_BITS +: WALK_BITS];
        always @* assume (last[each] >= -(1 <<< WALK_BITS - 1) && last[each] < 1 <<< WALK_BITS - 1);
    end
    for (each = 1; each < 5; each = each + 1) begin: between
        wire signed [WIDE-1:0] way_first = each < 3 ? first[0] : way_q, way_last = each < 3 ? last[0] : way_q;
        wire signed [WIDE-1:0] way_there = each < 3 ? there[0] : way_q;
        always @* begin
            if (way_first < first[each] && way_last < last[each]) assume (way_there < there[each]);
            if (way_first > first[each] && way_last > last[each]) assume (way_there > there[each]);
        end
    end
endgenerate
wire signed [SLOPE_BITS+1:0] column_there = column_slope + $signed({1'b0, ray});
wire forward = axis == 1 ? column_there > 0 : axis == 2 ? row_slope > 0 : 1'b1;
wire back = axis == 1 ? column_there < 0 : axis == 2 ? row_slope < 0 : 1'b0;

// The cross-multiplied definition: ahead, and within the bounds, which a negative slope swaps.
wire hits_forward = distance > 0 && forward && there[1] <= there[0] && there[0] <= there[2] && there[3] <= way_q
    && way_q <= there[4];
wire hits_back = distance < 0 && back && there[2] <= there[0] && there[0] <= there[1] && there[4] <= way_q
    && way_q <= there[3];

reg [1:0] hits = 2'b00;
always @(posedge clk) hits <= {hits, load[rectangle] && (hits_forward || hits_back)};
always @* begin
    assume (axis < 3 && ray < UNITS && rectangle < RECTANGLES);
    if (hits[1]) assert (may_hit[$past(rectangle, 2)]);
end

always @* cover (hits[1]);
always @* cover (may_hit == 5);
endmodule
