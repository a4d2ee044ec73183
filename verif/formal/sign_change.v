// SPDX-License-Identifier: MIT
// The number of columns until a line changes its sign: 1 + floor(y / g), with y = f or -f - 1, and g the growth.
//
// A division is picked, and compared with long division in each stage: a digit is 1 if the remainder with the next bit
// of y is at least g, which is then subtracted. By `division-step`, y = g q + r with r < g after the last digit, and by
// `sign-change`, the sign changes q + 1 columns further. A division may start in each cycle, so others are in the
// pipeline with the picked one.
//
// Assumed: a cycle of reset at first, and a growth that fits the divisor. The claim is about counts that fit, as all do
// that lead to a column of the screen.
//
// [proof]
// claim = "the column at which a line's sign changes is 1 + floor(y / g) columns further, with a division per cycle"
// modules = ["first_change"]
// induction = 1
// reach = "CYCLES + 4"
// quick = ["span tiny rectangles=3"]
// designs = [
//   "span rows=180 scale=6 pixels=2 turn patterns materials",
//   "span rows=180 scale=6 pixels=2 turn light patterns materials",
// ]
// [faults]
// "span-tiny48-s2-u2-r3-m1-l11520-c8" = ["first_change.y increased", "first_change.size increased",
//   "divider_step.difference edge", "first_change.divisors_1 short", "first_change.remainders_3 short",
//   "first_change.under_way short", "division_stage.kept_digits late", "first_change.first_digits short"]

module sign_change;
localparam G = DIVISOR_BITS - 1, Q = QUOTIENT_BITS, STAGES = CYCLES - 2;
first_change dut (.*);

reg picked;
(* anyseq *) reg pick;
reg [5:0] age;
reg [CYCLES-1:0] started;
reg [LINE_BITS-1:0] y;
reg [G-1:0] g;
wire below = division_value[LINE_BITS-1], falls = division_growth[G];
wire [LINE_BITS-1:0] first = below ? ~division_value : division_value;
wire [G:0] size = falls ? -division_growth : division_growth;
always @(posedge clk) begin
    started <= reset ? 0 : {started, start};
    if (reset) picked <= 0;
    else if (start && pick) begin
        {picked, age} <= {1'b1, 6'd0};
        y <= first;
        g <= size[G-1:0];
    end
    else if (age == CYCLES - 1) picked <= 0;
    else age <= age + 1;
end

// Long division from the second cycle on, STAGE_BITS digits in a cycle, and one in the last if their number is odd.
wire fits = y >> Q < g;
reg [G-1:0] r;
reg [Q-1:0] q, bits;
wire [G:0] half = {r, bits[Q-1]}, half_rest = half >= g ? half - g : half;
wire [G:0] whole = {half_rest[G-1:0], bits[Q-2]}, whole_rest = whole >= g ? whole - g : whole;
wire single = STAGE_BITS == 1 || (Q % 2 && age == STAGES);
wire [G-1:0] next_r = single ? half_rest : whole_rest;
wire [Q-1:0] next_q = single ? {q, half >= g} : {q, half >= g, whole >= g};
wire [Q-1:0] next_bits = bits << (single ? 1 : 2);
always @(posedge clk) begin
    if (start && pick) {r, q, bits} <= {first[LINE_BITS-1:Q], {Q{1'b0}}, first[Q-1:0]};
    else if (age > 0 && age <= STAGES) {r, q, bits} <= {next_r, next_q, next_bits};
end

// Invariants: the line that is kept, and the outputs of each stage.
always @* if (known && picked && age == 0) begin
    assert ((dut.kept_value < 0 ? ~dut.kept_value : dut.kept_value) == y && bits == y[Q-1:0] && q == 0);
    assert ((dut.kept_growth < 0 ? -dut.kept_growth : dut.kept_growth) == g && r == y >> Q);
end
genvar i;
generate
    for (i = 0; i < STAGES; i = i + 1) always @* if (known && picked && age == i + 1) begin
        assert (bits == (y[Q-1:0] << STAGE_BITS * i) && q >> STAGE_BITS * i == 0);
        assert (dut.division_stage{i}_i.next_divisor == g);
        if (fits) assert (dut.division_stage{i}_i.next_digits == (next_bits | next_q)
            && dut.division_stage{i}_i.next_remainder == next_r);
    end
endgenerate

// The claim.
always @* begin
    if (picked) assume (!(start && pick));
    assume (!size[G]);
    if (known) assert (dut.under_way == started && done == started[CYCLES-1]);
    if (known && picked) assert (age < CYCLES && started[age]);
    if (known && picked && age == CYCLES - 1 && fits) assert (columns == (q + 1) % (1 << COLUMN_BITS));
end
always @* cover (known && picked && age == CYCLES - 1 && g == 3 && y == 8 && columns == 3);
endmodule
