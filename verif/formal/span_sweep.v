// SPDX-License-Identifier: MIT
// A pass of the sweep: between its first column and `stop` the winner is seen, in a gap nothing; at `stop` the heir is.
//
// Seen in a column is the entry that is met there and is before all others that are. Which of two entries is before the
// other may change at one column: any column, for any pair, which is all that is used of a line. So the proof holds for
// any function in place of the products. The picked column is an arbitrary one, so what is asserted there holds for
// all. Three entries are the fewest with which two can follow at the same column while a third one is seen.
//
// Passes have no state in common but what a pass sets when it starts, so all have the same constant inputs here.
//
// Assumed: a cycle of reset at first; entries of different rectangles, none of them empty, within the chain; the winner
// is seen at the first column, or nothing is, except for what begins there; in the picked column the order of three is
// no circle, by the lemma `nearer`; answers to this block's questions only, one after each. That one of two entries is
// before the other is the lemma `one-is-before`, and the count of columns `sign-change`.
//
// [proof]
// claim = "a span is what is seen in each of its columns, its heir is what is seen after it, and every pass ends"
// modules = ["sweep"]
// induction = 1
// reach = 30
// quick = ["span tiny rectangles=3"]
// designs = ["span rows=180 scale=6 pixels=2 turn light patterns materials rectangles=3"]
// [faults]
// "span-tiny48-s2-u2-r3-m1-l11520-c8" = ["sweep.follows 0", "sweep.meets 1", "sweep.nearer inverted",
//   "sweep.nearer_heir 1", "sweep.same 1", "sweep.same_heir 1", "sweep.sooner 1", "sweep.crossing increased",
//   "sweep.rivalled 0", "sweep.inherited 1", "sweep.answer_left edge", "sweep.answer_right 0", "sweep.later inverted",
//   "sweep.bound as stop", "sweep.last as bound", "sweep.left as column", "sweep.in_time 1", "sweep.outlasts 0",
//   "sweep.opens 1", "sweep.shortened 0", "sweep.held 1", "sweep.left_over 0", "sweep.chain_stop increased"]

module span_sweep;
localparam C = COLUMN_BITS, N = EYE_BITS - 1, E = ENTRY_BITS;
sweep dut (.*);

// The table, the order of its entries, and the pass.
(* anyconst *) reg [3*E-1:0] entries;
(* anyconst *) reg [C-1:0] change_01, change_02, change_12, p;
(* anyconst *) reg from_01, from_02, from_12;
(* anyconst *) reg [1:0] seen;
(* anyconst *) reg [1:0] count;
(* anyconst *) reg [C-1:0] column, chain_stop;
(* anyconst *) reg gap;
(* anyconst *) reg [E-1:0] nobody;

wire [E-1:0] entry_0 = entries[E-1:0], entry_1 = entries[2*E-1:E], entry_2 = entries[3*E-1:2*E];
wire [E-1:0] first_seen = seen == 0 ? entry_0 : seen == 1 ? entry_1 : entry_2;
wire [2:0] met_p, met_first, met_stop, met_left, met_right;
wire [8:0] before_p, before_first;  // bit 3 i + j: entry i is before entry j
genvar a, b;
generate
    for (a = 0; a < 3; a = a + 1) begin
        wire [E-1:0] one = entries[a*E +: E];
        wire [C-1:0] start_a = one[C +: C], stop_a = one[0 +: C];
        wire [1:0] index_a = one[E-1 -: 2], axis_a = one[E-3 -: 2];
        wire is = a < count;
        assign met_p[a] = is && start_a <= p && p < stop_a;
        assign met_first[a] = is && start_a <= column && column < stop_a;
        assign met_stop[a] = is && start_a <= stop && stop < stop_a;
        assign met_left[a] = is && start_a <= dut.asked_left && dut.asked_left < stop_a;
        assign met_right[a] = is && start_a <= dut.asked_right && dut.asked_right < stop_a;
        always @* if (is) begin
            assume (start_a < stop_a && stop_a <= chain_stop && axis_a != 3);
            if (gap && met_first[a]) assume (start_a == column);
            if (!gap && met_first[a] && seen != a) assume (before_first[3*seen + a]);
        end
        for (b = 0; b < 3; b = b + 1) begin
            assign before_p[3*a + b] = before(a, b, p);
            assign before_first[3*a + b] = before(a, b, column);
            always @* if (is && b < a) assume (index_a != entries[b*E + E - 1 -: 2]);
        end
    end
endgenerate
always @* begin
    assume (count <= 3 && column < chain_stop);
    if (!gap) assume (seen < count && met_first[seen]);
    if (met_p == 7) begin
        assume (!(before_p[1] && before_p[5] && before_p[6]));
        assume (!(before_p[3] && before_p[7] && before_p[2]));
    end
end

// The column in which the order of two changes, and the order from there on.
function [C:0] changed(input [1:0] i, input [1:0] j);
    changed =
        {i, j} == 4'b0001 ? {from_01, change_01} : {i, j} == 4'b0010 ? {from_02, change_02} :
        {i, j} == 4'b0110 ? {from_12, change_12} : {i, j} == 4'b0100 ? {!from_01, change_01} :
        {i, j} == 4'b1000 ? {!from_02, change_02} : {!from_12, change_12};
endfunction
function before(input [1:0] i, input [1:0] j, input [C-1:0] c);
    reg [E-1:0] one, other;
    reg [C:0] change;
    begin
        one = i == 0 ? entry_0 : i == 1 ? entry_1 : entry_2;
        other = j == 0 ? entry_0 : j == 1 ? entry_1 : entry_2;
        change = changed(i, j);
        before = one[E-3 -: 2] == other[E-3 -: 2]
            ? {one[2*C +: N], one[E-1 -: 2]} < {other[2*C +: N], other[E-1 -: 2]}
            : change[C] ^ c < change[C-1:0];
    end
endfunction

assign winner_word = gap ? nobody : first_seen;

// The table, and a pass from its start to its end.
reg runs;
reg [1:0] tested, present, heir_number;
reg [E-1:0] tested_word;
always @(posedge clk) begin
    if (reset) runs <= 0;
    else if (start || done) runs <= start;
    if (read) {tested, tested_word} <= {place, place == 0 ? entry_0 : place == 1 ? entry_1 : entry_2};
    if (dut.begins || dut.advance) present <= tested;
    if (dut.take) heir_number <= present;
end
wire [E-1:0] tested_entry = tested == 0 ? entry_0 : tested == 1 ? entry_1 : entry_2;
wire [E-1:0] present_entry = present == 0 ? entry_0 : present == 1 ? entry_1 : entry_2;
wire [E-1:0] heir_entry = heir_number == 0 ? entry_0 : heir_number == 1 ? entry_1 : entry_2;
always @* if (runs) assume (!start);

// Questions and answers.
wire scan = dut.state == 1, order = dut.state == 2, cross = dut.state == 3, rivals = dut.state == 4;
wire next = dut.state == 5;
reg asked, divides;
reg [1:0] rival;
reg [C-1:0] left, right;
wire [1:0] other = rivals ? heir_number : seen;
wire [E-1:0] other_entry = rivals ? heir_entry : first_seen;
wire [C:0] change = changed(present, rival);
wire above_left = before(present, rival, left), above_right = before(present, rival, right);
always @(posedge clk) begin
    if (reset) {asked, divides} <= 0;
    else begin
        asked <= asks_ask || asked && !answer_valid;
        divides <= asks_divide || divides && !answer_divided;
    end
    if (asks_ask) {rival, left, right} <= {other, dut.asked_left, dut.asked_right};
end
always @* begin
    if (!asked) assume (!answer_valid);
    if (!divides) assume (!answer_divided);
    if (answer_valid) assume ((answer_left < 0) != above_left && (answer_right < 0) != above_right);
    if (answer_divided) assume (answer_columns == (change - left) % (1 << C));
    if (known && asks_ask) begin
        assert ((!asked || answer_valid) && (!divides || answer_divided));
        assert (present != other && dut.asked_left <= dut.asked_right);
        assert (met_left[present] && met_right[present] && met_left[other] && met_right[other]);
        assert (asks_query_left == dut.asked_left && asks_query_right == dut.asked_right);
        assert ({asks_query_axis_1, asks_query_back_1} == present_entry[2*C+N +: 3]);
        assert ({asks_query_axis_2, asks_query_back_2} == other_entry[2*C+N +: 3]);
        assert (asks_query_factor_1 == other_entry[2*C +: N] && asks_query_factor_2 == present_entry[2*C +: N]);
        assert (asks_query_strict == (present_entry[E-1 -: 2] > other_entry[E-1 -: 2]));
    end
    if (known && asks_divide) begin
        assert (answer_valid && !above_left && above_right);
        assert (asks_division_value == answer_left && asks_division_growth == answer_growth);
    end
end

// What holds after the entries below `passed`, and for the present one, if it is not among them.
wire [2:0] entries_left = dut.rest + (dut.held && !next);
wire [1:0] passed = count - entries_left;
wire [C-1:0] winner_end = gap ? chain_stop : first_seen[C-1:0];
wire begun = runs && !dut.begins;
wire within = column <= p && p < stop;
wire [C-1:0] start_now = present_entry[C +: C], end_now = present_entry[C-1:0];
wire [C-1:0] first_now = start_now > column ? start_now : column;
wire [1:0] axis_now = present_entry[E-3 -: 2], winner_axis = winner_word[E-3 -: 2];
always @* if (known) begin
    assert (dut.state <= 5 && runs == (dut.state != 0) && (runs || place == 0));
    assert (!dut.begins || (scan && !dut.held));
    assert ((runs || !dut.held) && (asked || dut.asks_rival) == (order || rivals) && !(asked && dut.asks_rival));
    assert (2'd0 + divides + dut.divided + dut.crossed == cross);
    assert (!order || asked);
    if (runs) assert (place == tested + 2'd1 && (tested == 3 || tested_word == tested_entry));
    if (dut.begins) assert (tested == 0);
    if (begun) begin
        assert (entries_left <= count && (dut.held || (scan && dut.rest == 0)));
        if (next) assert (dut.held && tested == passed);
        if (dut.held && !next) begin
            assert (present == passed && tested == passed + 2'd1 && dut.present_word == present_entry);
            assert (dut.left_1 == first_now && dut.same_1 == (axis_now == winner_axis));
            assert (dut.soon_1 == (first_now < stop));
            assert (dut.in_time_1 == (start_now <= stop && (gap ? start_now >= column
                : present != seen && end_now > column)));
            if (!gap) begin
                assert (dut.meets_1 == (start_now < winner_end) && dut.outlasts_1 == (end_now > winner_end));
                assert (dut.nearer_1 == ({present_entry[2*C +: N], present_entry[E-1 -: 2]}
                    < {first_seen[2*C +: N], first_seen[E-1 -: 2]}));
            end
        end
        assert (stop <= winner_end && (gap ? column <= stop : column < stop));
        if (!gap) assert (dut.shortened == (stop < winner_end));
        if (!gap) assert (dut.bound == (dut.shortened ? stop : winner_end - 1'b1));
        if (!inherited) assert (stop == winner_end);
        if (inherited) begin
            assert (heir_number < passed && heir_word == heir_entry && met_stop[heir_number]);
            assert (gap || heir_number != seen);
            if (!gap && p == stop && stop < winner_end) assert (before_p[3*heir_number + seen]);
        end
    end
    if (order || cross) begin
        assert (!gap && dut.held && rival == seen && present != seen && left == first_now);
        assert (left < winner_end && left <= stop && left < end_now && left <= right);
        assert (right == (end_now - 1'b1 < dut.bound ? end_now - 1'b1 : dut.bound) && axis_now != winner_axis);
    end
    if (cross) assert (!above_left && above_right && (divides || dut.crossing == change[C-1:0]));
    if (dut.crossed) assert (dut.soon_after == (change[C-1:0] < stop));
    if (rivals) begin
        assert (dut.held && inherited && (!asked || (rival == heir_number && left == stop && right == stop)));
        assert (met_stop[present] && (gap || present != seen) && axis_now != heir_entry[E-3 -: 2]);
        if (within && met_p[present]) assert (!gap && before_p[3*seen + present]);
        if (!gap && p == stop && stop < winner_end) assert (before_p[3*present + seen]);
    end
end
generate
    for (a = 0; a < 3; a = a + 1) always @* if (known && begun && met_p[a]) begin
        if (a < passed && within) assert (!gap && (seen == a || before_p[3*seen + a]));
        if (a < passed && p == stop && !(seen == a && !gap))
            assert (inherited && (heir_number == a || before_p[3*heir_number + a]));
        // The claim: the same, for all entries.
        if (done && within) assert (!gap && met_p[seen] && (seen == a || before_p[3*seen + a]));
        if (done && p == stop) assert (inherited && (heir_number == a || before_p[3*heir_number + a]));
    end
endgenerate

// Every pass ends: after an answer there is a question that has not been asked of this entry, or another entry.
always @* if (known && $past(known) && $past(begun) && begun) begin
    if (next || (scan && !$past(next))) assert (entries_left < $past(entries_left));
    if ($past(order)) assert (order || cross || rivals || next || scan);
    if ($past(rivals)) assert (rivals || scan);
    if ($past(cross)) assert (cross || rivals || next);
    if ($past(next)) assert (scan);
end

// Covers two that follow at the same column, and a crossing.
always @* cover (known && rivals && answer_valid && dut.take && !gap && stop < winner_end);
always @* cover (known && done && count == 3 && inherited && !gap && stop < winner_end && stop > column + 2);
endmodule
