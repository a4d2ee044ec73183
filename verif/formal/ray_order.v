// SPDX-License-Identifier: MIT
// The control of the rays: the rectangles that it visits and when, the number of rays, and that it ends.
//
// The tag of group_run.v replaces the position of the rectangle's plane, so that it can be followed to the z buffer.
//
// A rectangle takes as long as a division, or one cycle in the exact engine, where rectangles follow each other in a
// pipeline.
//
// Any ray may run towards any plane, in any cycle. All other assumptions are in group_run.v.
//
// [proof]
// claim = """each rectangle that a ray may hit is visited once and in order, and ends early if behind all; \
// reflections + 1 rays, done within the budget's cycles"""
// modules = ["ray_control if SEED", "exact_control if not SEED", "ray_sequencer", "rect_sequencer"]
// induction = 1
// reach = "RUN_BOUND + 2 if RECTANGLES == 2 and REFLECTIONS == 1 and STEPS < 5 else 0"
// quick = [
//   "tiny rectangles=2 reflections=1 culling=1,0 steps=9,8,7,6,5,4,3",
//   "tiny rectangles=4 reflections=2 culling=1 steps=9,8,7,6,5,4,3",
//   "exact tiny rectangles=2 reflections=1 culling=1", "exact tiny rectangles=4 reflections=2 culling=1",
// ]
// designs = [
//   "tiny rectangles=2,3,4 reflections=0,1,2 culling=1,0 steps=9,8,7,6,5,4,3",
//   "tiny two reflections=3,4 culling=1,0 steps=3,9",
//   "one-unit divider_bits=1",  # the control of the default design
//   "exact tiny rectangles=2,3,4 reflections=0,1,2,3,4 culling=1", "exact one-unit", "exact one-unit reflections=4",
// ]
// [parameters]
// STEPS = "RECT_CYCLES"
// RESULT_LATENCY = "PASS_LATENCY"
// RUN_BOUND = "GROUP_CYCLES - 2"  # done comes two cycles before the next group may start
// [faults]
// "tiny48-u2-r2-m1-f0t-d3-c8" = ["rect_sequencer.others as candidates", "rect_sequencer.fetched unless upcoming",
//   "rect_sequencer.lowest inverted", "ray_sequencer.picture_reflections 1", "ray_sequencer.done 0 in 40",
//   "ray_sequencer.passed 1", "ray_sequencer.fate_may_hit 1", "ray_sequencer.rects_usable and fate_may_hit",
//   "ray_sequencer.fate_any_alive 0", "ray_sequencer.fate_any_alive 1", "ray_sequencer.picture_reflections 0",
//   "ray_control.steps_store_quotient as in_flight[3]", "ray_control.dividing_word as rects_rect_word"]
// "tiny48-u2-r2-m1-f3t-d3-c8" = ["ray_sequencer.in_flight[2] as in_flight[1]",
//   "ray_sequencer.rect_sequencer_i.early_out 0", "ray_control.early_out or in_flight[0]",
//   "ray_control.early_out late", "ray_control.none_towards 1", "ray_control.none_towards 0"]
// "tiny48-u2-r2-m1-f3t-d3-c8-k0" = ["ray_control.ray_sequencer_i.early_out as in_flight[1]"]
// "exact-tiny48-u2-r2-m1-c8-k1" = ["exact_control.steps_write_z_buf as in_flight[1]",
//   "exact_control.second_word as first_word", "ray_sequencer.passed 1", "rect_sequencer.cycle 1"]

module ray_order;
localparam DIVIDES = STEPS > 1;
localparam TRAVEL = DIVIDES ? STEPS + 4 : 3;  // from a rectangle's start to its offer to the z buffer
localparam EARLY = 3;  // from the start of a rectangle that ends early to the next start
localparam ENDS_EARLY = CULLING && STEPS > EARLY;
`include "group_run.v"
wire next_pass = 0;
wire [RECTANGLES-1:0] wanted = rays == 0 ? usable & may_hit : usable;

// If no ray runs towards the rectangle in the cycle after its start, it ends early two cycles after the start.
wire ended;
wire [TRAVEL-1:0] dropped = ended << 2;
generate
    if (ENDS_EARLY) begin: early
        reg last_any_towards;
        always @(posedge clk) last_any_towards <= fate_any_towards;
        assign ended = starts[1] && !last_any_towards;
        always @* cover (done && started && some_early && !some_lost);
    end
    else assign ended = 0;
endgenerate

// A division: loaded 2 cycles after the start, stored STEPS later, offered 2 later.
reg [7:0] since_load;
wire [8:0] first_tag, second_tag;  // of the rectangles in the pipeline
generate
    if (DIVIDES) begin: divisions
        assign {first_tag, second_tag} = {tag, dut.dividing_word[60 +: 9]};
        always @(posedge clk)
            since_load <= reset || ended || (since_load >= STEPS && !steps_load_divider) ? STEPS
                : steps_load_divider ? 1 : since_load + 1;
        always @* if (known) begin
            assert (steps_load_divider == starts[1]);
            assert (steps_store_quotient == starts[1+STEPS]);
            // The plane while the divider is loaded, and the one whose quotients are valid.
            if (steps_load_divider) assert (tag == tags[9 +: 9]);
            if (starts[2+STEPS]) assert (offered_position == tags[9*(2+STEPS) +: 9]);
            // The divider is never loaded before it is finished, or its division ended early.
            if (steps_load_divider) assert (since_load >= STEPS);
            if (since_load < STEPS) assert (since_load != 0 && (starts >> since_load) & 2);
        end
    end
    else assign {first_tag, second_tag} = {dut.first_word[24 +: 9], dut.second_word[24 +: 9]};
endgenerate

// The timing of a ray: the end of the tests that have begun, and the end of the last one that did not end early, 0 if
// there was none. Slots follow each other, and the ray is blended when nothing is in flight any more.
reg [TIME_BITS-1:0] tests_end, kept_end;
wire [TIME_BITS-1:0] kept_result = kept_end == 0 ? 0 : kept_end + RESULT_LATENCY - 1;
wire [TIME_BITS-1:0] blend_at = kept_result > tests_end + 1 ? kept_result : tests_end + 1;
always @(posedge clk) begin
    if (reset_z_buf) tests_end <= 0;
    else if (find_intersection) tests_end <= tests_end + STEPS;
    else if (ended) tests_end <= tests_end - (STEPS - EARLY);
    if (reset_z_buf) kept_end <= 0;
    else if (DIVIDES ? starts[1] && !ended : find_intersection) kept_end <= DIVIDES ? tests_end : tests_end + STEPS;
end
always @* if (known && started && tracing) begin
    if (find_intersection) assert (place == tests_end);
    assert (add_colour == (place == blend_at));
    if (add_colour) assert (visited == wanted);
end

// The control ends within the cycles of the budget's formula for the usable rectangles, and takes exactly as many if
// nothing was skipped. Done stays high.
wire [TIME_BITS-1:0] pass = usable == 0 ? 2 : count(usable) * STEPS + RESULT_LATENCY;
wire [TIME_BITS-1:0] rays_cycles = (rays[0] ? pass : 0) + (rays[1] ? 2 * pass : 0) + (rays[2] ? 4 * pass : 0);
reg some_early, some_lost;
wire spared = some_early || some_lost || (usable & ~may_hit) != 0;
always @(posedge clk) begin
    some_early <= started && (some_early || ended);
    some_lost <= started && (some_lost || reflected && !fate_any_alive);
end
always @* if (known && started) begin
    if (done) assert (cycles <= 2 + rays_cycles && (spared || cycles == 2 + rays_cycles));
end

// Invariants besides those of group_run.v: starts in flight are at least STEPS cycles apart.
wire [CYCLE_BITS-1:0] cycle = dut.ray_sequencer_i.rect_sequencer_i.cycle;
wire starting = state == TRACE && fetched && cycle == 0;
wire [RECTANGLES-1:0] taken = starting ? visited | tagged : visited;
wire [TIME_BITS-1:0] whole_tests = count(visited) * STEPS;
always @* if (known) begin
    assert (dut.ray_sequencer_i.early_out == ended && write_z_buf == starts[TRAVEL-1]);
    if (started && state == GENERATE) assert (!some_early && !some_lost);
    if (tracing || lost) begin
        assert (cycles <= 2 + rays_cycles + place && (spared || cycles == 2 + rays_cycles + place));
    end
    if (lost) assert (some_lost);
    if (tracing) begin
        assert (cycle < STEPS);
        assert ((state == BLEND) == (place == blend_at));
        assert (place <= blend_at);
        assert (tests_end <= whole_tests && (some_early || tests_end == whole_tests));
        assert (kept_end <= tests_end && (some_early || kept_end == tests_end || fetched));
    end
    if (state == TRACE) begin
        if (fetched) begin
            assert ((taken | left) == wanted && (taken & left) == 0);
            assert (left == 0 || taken < next);
            assert (tag < RECTANGLES);
            if (cycle == 0) assert ((wanted & tagged) != 0 && visited < tagged);
            else assert (visited != 0);
            assert (place == (cycle == 0 ? tests_end : tests_end - STEPS + cycle));
        end
        else begin
            assert (visited == wanted && left == (place == tests_end ? 0 : usable));
            assert (place >= tests_end);
        end
        if (!fetched || cycle == 0) assert ((starts & ((1 << (STEPS - 1)) - 1)) == 0);
    end
end
genvar age;
generate
    for (age = 0; age < TRAVEL; age = age + 1) begin: ages
        always @* if (known && starts[age]) begin
            assert (place > age && ((starts << (STEPS - 1)) >> age & ((1 << (STEPS - 1)) - 1)) == 0);
            if (!DIVIDES)
                assert ((age == 0 ? first_tag : age == 1 ? second_tag : offered_position) == tags[9*age +: 9]);
            else if (age < 2) assert (fetched && cycle == age + 1 && first_tag == tags[9*age +: 9]);
            else if (age < 2 + STEPS) assert (second_tag == tags[9*age +: 9] && since_load == age - 1);
            else assert (offered_position == tags[9*age +: 9]);
            if (age >= 2 || !DIVIDES) assert (kept_end != 0 && kept_end + age + 1 >= place + STEPS);
        end
        // The last one that did not end early is in flight for this long.
        always @* if (known && state == TRACE && kept_end != 0 && kept_end + age + 1 == place + STEPS)
            assert ((age >= 2 || !DIVIDES) && starts[age]);
    end
    for (age = 1; age < STEPS; age = age + 1) begin: each_cycle
        always @* if (known && state == TRACE && fetched && cycle == age)
            assert (starts[age-1] && (starts & ((1 << (age - 1)) - 1)) == 0);
    end
endgenerate

// Covers the end of a run in which nothing is skipped, and of runs that skip what they can.
always @* cover (done && started && !spared && &usable && reflections == REFLECTIONS);
always @* cover (done && started && some_lost);
endmodule
