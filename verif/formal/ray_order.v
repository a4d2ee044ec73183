// SPDX-License-Identifier: MIT
// The control of the rays: the rectangles that it visits and when, the number of rays, and that it ends.
//
// The tag of group_run.v replaces the position of the rectangle's plane, so that it can be followed to the z buffer.
//
// A rectangle takes as long as a division, or one cycle in the exact engine, where rectangles follow each other in a
// pipeline.
//
// Assumed besides group_run.v, as the units guarantee: if no ray is alive at the end of one pass, none is at the end of
// the next one, which is not traced. Otherwise any ray may be alive, and run towards any plane, in any cycle.
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

module ray_order #(
    parameter RECTANGLES = 2, parameter INDEX_BITS = 1, parameter STEPS = 9, parameter CYCLE_BITS = 4,
    parameter REFLECTIONS = 1, parameter REFLECTION_BITS = 3, parameter RESULT_LATENCY = 6, parameter RUN_BOUND = 50,
    parameter CULLING = 1
) (
    input clk, input reset, input enable, input [RECTANGLES-1:0] usable, input [REFLECTION_BITS-1:0] reflections,
    input [RECTANGLES-1:0] may_hit, input any_towards, input any_alive
);
localparam DIVIDES = STEPS > 1;
localparam TRAVEL = DIVIDES ? STEPS + 4 : 3;  // from a rectangle's start to its offer to the z buffer
localparam EARLY = 3;  // from the start of a rectangle that ends early to the next start
localparam ENDS_EARLY = CULLING && STEPS > EARLY;
localparam TIME_BITS = $clog2(RUN_BOUND) + 1;

wire done, fetch, screen_to_ray, initial_ray, find_intersection, reset_z_buf, write_z_buf, reset_colour, add_colour,
    store_ray;
wire [INDEX_BITS-1:0] index;
reg [8:0] tag;

// A rectangle: its surface, which is axis, position and colour, then four bounds.
localparam BOUNDS_BITS = 4 * 9, SURFACE_BITS = 2 + 9 + 24, RECT_BITS = SURFACE_BITS + BOUNDS_BITS;
localparam POSITION = 24 + BOUNDS_BITS;
wire [RECT_BITS-1:0] rect = {2'd0, tag, 24'd0, {BOUNDS_BITS{1'b0}}};

// Signals in the control of either engine between start and offer, and the tag in its pipeline.
wire load_divider, store_quotient;
wire [8:0] first_tag, second_tag, offered_tag;
generate
    if (DIVIDES) begin: engine
        ray_control dut (
            .clk(clk), .reset_ray_caster(reset), .enable(enable), .picture_reflections(reflections), .done(done),
            .rects_usable(usable), .rects_index(index), .rects_fetch(fetch), .rects_rect_word(rect),
            .fate_may_hit(may_hit), .fate_any_alive(any_alive), .steps_screen_to_ray(screen_to_ray), .steps_initial_ray(initial_ray),
            .steps_find_intersection(find_intersection), .steps_load_divider(load_divider),
            .steps_store_quotient(store_quotient), .steps_reset_z_buf(reset_z_buf), .steps_write_z_buf(write_z_buf),
            .steps_reset_colour(reset_colour), .steps_add_colour(add_colour), .steps_store_ray(store_ray),
            .offered_word(offered)
        );
        // A port of a control that ends rectangles early; with any other control, a wire without a reader.
        (* hierconn *) wire \dut.fate_any_towards ;
        assign \dut.fate_any_towards = any_towards;
        (* hierconn *) wire [RECT_BITS-1:0] \dut.dividing_word ;
        wire [RECT_BITS-1:0] offered;
        assign first_tag = tag;
        assign second_tag = \dut.dividing_word [POSITION+:9];
        assign offered_tag = offered[POSITION+:9];
    end
    else begin: engine
        exact_control dut (
            .clk(clk), .reset_ray_caster(reset), .enable(enable), .picture_reflections(reflections), .done(done),
            .rects_usable(usable), .rects_index(index), .rects_fetch(fetch), .rects_rect_word(rect),
            .fate_may_hit(may_hit), .fate_any_alive(any_alive), .steps_screen_to_ray(screen_to_ray), .steps_initial_ray(initial_ray),
            .steps_find_intersection(find_intersection), .steps_reset_z_buf(reset_z_buf),
            .steps_write_z_buf(write_z_buf), .steps_reset_colour(reset_colour), .steps_add_colour(add_colour),
            .steps_store_ray(store_ray), .offered_word(offered)
        );
        assign load_divider = 0;
        assign store_quotient = 0;
        (* hierconn *) wire [SURFACE_BITS-1:0] \dut.first_word ;
        (* hierconn *) wire [SURFACE_BITS-1:0] \dut.second_word ;
        wire [SURFACE_BITS-1:0] offered;
        assign first_tag = \dut.first_word [POSITION-BOUNDS_BITS+:9];
        assign second_tag = \dut.second_word [POSITION-BOUNDS_BITS+:9];
        assign offered_tag = offered[POSITION-BOUNDS_BITS+:9];
    end
endgenerate

`include "group_run.v"
reg last_any_towards;
always @(posedge clk) last_any_towards <= any_towards;

// A ray lasts from the cycle after reset_z_buf to add_colour; for a lost ray, where none was alive, that is one cycle.
// Visits are starts on the tagged plane; place counts cycles.
reg [RECTANGLES-1:0] visited;
reg tracing, lost;
reg [REFLECTION_BITS-1:0] rays;
reg [TIME_BITS-1:0] place;
wire [RECTANGLES-1:0] tagged = {{RECTANGLES-1{1'b0}}, 1'b1} << tag;
wire [RECTANGLES-1:0] wanted = rays == 0 ? usable & may_hit : usable;
wire reflected = add_colour && rays != reflections;
always @(posedge clk) begin
    if (reset) tracing <= 0;
    else if (reset_z_buf) tracing <= !add_colour || reflected && any_alive;
    lost <= !reset && reflected && !any_alive;
    visited <= reset_z_buf ? 0 : find_intersection ? visited | tagged : visited;
    rays <= screen_to_ray ? 0 : rays + add_colour;
    place <= reset_z_buf ? 0 : place + 1;
end
always @* if (known && lost) assume (!any_alive);
always @* if (known && started) begin
    if (find_intersection) begin
        assert (tracing && tag < RECTANGLES);
        assert ((wanted & tagged) != 0);
        assert (visited < tagged);  // each once, and in ascending order
    end
    if (add_colour) assert ((lost || tracing && visited == wanted) && rays <= reflections);
    if (lost) assert (add_colour && !tracing);
    assert (store_ray == reflected);
    assert (reset_colour == screen_to_ray);
    assert (reset_z_buf == (screen_to_ray || add_colour));
    assert (!(reset_z_buf && write_z_buf));
    assert (screen_to_ray == (cycles == 1));
    if (tracing || lost) assert (initial_ray == (rays == 0));
    if (done) assert (!tracing && !lost && rays == reflections + 1);
end
always @* if (known && !started) assert (!done && !find_intersection && !write_z_buf && !add_colour);

// Starts in flight. If no ray runs towards the rectangle in the cycle after its start, it ends early two cycles after
// the start, and goes no further.
reg [TRAVEL-1:0] starts;
reg [8:0] tags [0:TRAVEL-1];
wire ended = ENDS_EARLY && starts[1] && !last_any_towards;
always @(posedge clk) begin: follow
    integer i;
    starts[0] <= !reset && find_intersection;
    tags[0] <= tag;
    for (i = 1; i < TRAVEL; i = i + 1) begin
        starts[i] <= !reset && starts[i-1] && !(i == 2 && ended);
        tags[i] <= tags[i-1];
    end
end
always @* if (known) begin
    assert (write_z_buf == starts[TRAVEL-1]);
    if (write_z_buf) assert (offered_tag == tags[TRAVEL-1]);
    // No result is in flight when the ray is blended.
    if (add_colour) assert (starts == 0);
end

// A division: loaded 2 cycles after the start, stored STEPS later, offered 2 later.
reg [7:0] since_load;
always @(posedge clk) since_load <= reset || ended || (since_load >= STEPS && !load_divider) ? STEPS
    : load_divider ? 1 : since_load + 1;
generate
    if (DIVIDES) begin: divisions
        always @* if (known) begin
            assert (load_divider == starts[1]);
            assert (store_quotient == starts[1+STEPS]);
            // The plane while the divider is loaded, and the one whose quotients are valid.
            if (load_divider) assert (tag == tags[1]);
            if (starts[2+STEPS]) assert (offered_tag == tags[2+STEPS]);
            // The divider is never loaded before it is finished, or its division ended early.
            if (load_divider) assert (since_load >= STEPS);
            if (since_load < STEPS) assert (since_load != 0 && (starts >> since_load) & 2);
        end
    end
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
end

// The control ends within the cycles of the budget's formula for the usable rectangles, and takes exactly as many if
// nothing was skipped. Done stays high.
wire [TIME_BITS-1:0] pass = usable == 0 ? 2 : count(usable) * STEPS + RESULT_LATENCY;
wire [TIME_BITS-1:0] rays_cycles = (rays[0] ? pass : 0) + (rays[1] ? 2 * pass : 0) + (rays[2] ? 4 * pass : 0);
reg some_early, some_lost;
wire spared = some_early || some_lost || (usable & ~may_hit) != 0;
always @(posedge clk) begin
    some_early <= started && (some_early || ended);
    some_lost <= started && (some_lost || reflected && !any_alive);
end
always @* if (known && started) begin
    if (done) assert (cycles <= 2 + rays_cycles && (spared || cycles == 2 + rays_cycles));
    else assert (cycles < RUN_BOUND);
end

// Counters in range.
(* hierconn *) wire [CYCLE_BITS-1:0] \engine.dut.ray_sequencer_i.rect_sequencer_i.cycle ;
(* hierconn *) wire [REFLECTION_BITS-1:0] \engine.dut.ray_sequencer_i.bounce ;
always @* if (known && tracing) begin
    assert (\engine.dut.ray_sequencer_i.rect_sequencer_i.cycle < STEPS);
    assert (\engine.dut.ray_sequencer_i.bounce <= reflections);
end

// Invariants: the state matches the counts, the waiting rectangles follow the visited ones, and starts in flight are at
// least STEPS cycles apart.
(* hierconn *) wire [2:0] \engine.dut.ray_sequencer_i.state ;
(* hierconn *) wire \engine.dut.ray_sequencer_i.rect_sequencer_i.fetched ;
(* hierconn *) wire \engine.dut.ray_sequencer_i.rect_sequencer_i.offered ;
(* hierconn *) wire [INDEX_BITS-1:0] \engine.dut.ray_sequencer_i.rect_sequencer_i.upcoming ;
(* hierconn *) wire [RECTANGLES-1:0] \engine.dut.ray_sequencer_i.rect_sequencer_i.waiting ;
(* hierconn *) wire \engine.dut.ray_sequencer_i.early_out ;
(* hierconn *) wire [TRAVEL-1:0] \engine.dut.in_flight ;
localparam IDLE = 0, GENERATE = 1, TRACE = 2, BLEND = 3, DONE = 4;
wire [2:0] state = \engine.dut.ray_sequencer_i.state ;
wire [CYCLE_BITS-1:0] cycle = \engine.dut.ray_sequencer_i.rect_sequencer_i.cycle ;
wire fetched = \engine.dut.ray_sequencer_i.rect_sequencer_i.fetched ;
wire [RECTANGLES-1:0] waiting = \engine.dut.ray_sequencer_i.rect_sequencer_i.waiting ;
wire [RECTANGLES-1:0] lowest_waiting = waiting & -waiting;
wire [RECTANGLES-1:0] offered = {{RECTANGLES-1{1'b0}}, \engine.dut.ray_sequencer_i.rect_sequencer_i.offered } << \engine.dut.ray_sequencer_i.rect_sequencer_i.upcoming ;
wire [RECTANGLES-1:0] left = offered | waiting;
wire starting = state == TRACE && fetched && cycle == 0;
wire [RECTANGLES-1:0] taken = starting ? visited | tagged : visited;
wire [TIME_BITS-1:0] whole_tests = count(visited) * STEPS;
always @* if (known) begin
    assert (\engine.dut.in_flight == starts && \engine.dut.ray_sequencer_i.early_out == ended);
    if (!started) assert (cycles == 0 && state == IDLE && starts == 0 && !tracing && !lost);
    else assert (state != IDLE && state <= DONE && (state == GENERATE ? cycles == 1 : cycles > 1));
    assert ((tracing || lost) == (started && (state == TRACE || state == BLEND)));
    if (state != TRACE) assert (starts == 0);
    if (started && state == GENERATE) assert (!some_early && !some_lost);
    if (state == IDLE || state == GENERATE) assert (!fetched);
    if (state == GENERATE) assert (left == (usable & may_hit));
    if (state == BLEND && tracing) assert (!fetched && left == usable);
    if (state != IDLE) begin
        assert (waiting == 0 || offered < lowest_waiting && offered != 0 && (offered & waiting) == 0);
        assert (\engine.dut.ray_sequencer_i.rect_sequencer_i.offered == (offered != 0));
    end
    if (tracing || lost) begin
        assert (rays == \engine.dut.ray_sequencer_i.bounce );
        assert (cycles <= 2 + rays_cycles + place && (spared || cycles == 2 + rays_cycles + place));
    end
    if (lost) assert (state == BLEND && place == 0 && rays != 0 && some_lost);
    if (tracing) begin
        assert ((state == BLEND) == (place == blend_at));
        assert (place <= blend_at);
        assert (tests_end <= whole_tests && (some_early || tests_end == whole_tests));
        assert (kept_end <= tests_end && (some_early || kept_end == tests_end || fetched));
    end
    if (state == TRACE) begin
        if (fetched) begin
            assert ((taken | left) == wanted && (taken & left) == 0);
            assert (left == 0 || taken < offered);
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
            if (!DIVIDES) assert ((age == 0 ? first_tag : age == 1 ? second_tag : offered_tag) == tags[age]);
            else if (age < 2) assert (fetched && cycle == age + 1 && first_tag == tags[age]);
            else if (age < 2 + STEPS) assert (second_tag == tags[age] && since_load == age - 1);
            else assert (offered_tag == tags[age]);
            if (age >= 2 || !DIVIDES) assert (kept_end != 0 && kept_end + age + 1 >= place + STEPS);
        end
        // The last one that did not end early is in flight for this long.
        always @* if (known && state == TRACE && kept_end != 0 && kept_end + age + 1 == place + STEPS)
            assert ((age >= 2 || !DIVIDES) && starts[age]);
    end
    for (age = 1; age < STEPS; age = age + 1) begin: cycles
        always @* if (known && state == TRACE && fetched && cycle == age)
            assert (starts[age-1] && (starts & ((1 << (age - 1)) - 1)) == 0);
    end
endgenerate

// Covers the end of a run in which nothing is skipped, and of runs that skip what they can.
always @* cover (done && started && !spared && &usable && reflections == REFLECTIONS);
always @* cover (done && started && some_lost);
generate
    if (ENDS_EARLY) begin: ending_early
        always @* cover (done && started && some_early && !some_lost);
    end
endgenerate
endmodule
