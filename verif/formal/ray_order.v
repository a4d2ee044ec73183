// SPDX-License-Identifier: MIT
// The control of the rays: which rectangles it visits and when, how many rays, and that it ends.
//
// The memory's answer is modelled by a tag: a cycle after a fetch the plane at hand is the one with the fetched index,
// and the tag takes the place of the rectangle's plane, so that it can be followed to the z buffer.
//
// Assumed, as the renderer has it: one cycle of reset at first; the usable rectangles and the reflections hold still
// from the cycle in which the control starts, until the next reset; reflections are at most what was configured. Reset
// may come at any time, and registers hold anything before the first one.

module ray_order #(
    parameter RECTANGLES = 2, parameter INDEX_BITS = 1, parameter STEPS = 9, parameter SLOT_BITS = 4,
    parameter REFLECTIONS = 1, parameter RESULT_LATENCY = 6, parameter RUN_BOUND = 50
) (
    input clk, input reset, input enable, input [RECTANGLES-1:0] usable, input [1:0] reflections
);
localparam TRAVEL = STEPS + 4;  // from a rectangle's start to its offer to the z buffer

wire done, fetch, screen_to_ray, initial_ray, find_intersection, load_divider, store_quotient, reset_z_buf, write_z_buf,
    reset_color, add_color, store_ray;
wire [INDEX_BITS-1:0] index;
wire [8:0] finishing;
reg [8:0] tag;

ray_control dut (
    .clk(clk), .reset_ray_caster(reset), .enable(enable), .reflections(reflections), .done(done),
    .rects_usable(usable), .rects_index(index), .rects_fetch(fetch), .rects_rect_axis(2'd0),
    .rects_rect_position(tag), .rects_rect_u_low(9'd0), .rects_rect_u_high(9'd0), .rects_rect_v_low(9'd0),
    .rects_rect_v_high(9'd0), .rects_rect_colour(24'd0), .steps_screen_to_ray(screen_to_ray),
    .steps_initial_ray(initial_ray), .steps_find_intersection(find_intersection), .steps_load_divider(load_divider),
    .steps_store_quotient(store_quotient), .steps_reset_z_buf(reset_z_buf), .steps_write_z_buf(write_z_buf),
    .steps_reset_color(reset_color), .steps_add_color(add_color), .steps_store_ray(store_ray),
    .finishing_rect_axis(), .finishing_rect_position(finishing), .finishing_rect_u_low(), .finishing_rect_u_high(),
    .finishing_rect_v_low(), .finishing_rect_v_high(), .finishing_rect_colour()
);

always @(posedge clk) if (fetch) tag <= index;

// Since the last reset: whether the control was enabled, and for how many cycles it has been at work.
reg known = 0;
reg started;
reg [15:0] cycles;
reg [RECTANGLES-1:0] last_usable;
reg [1:0] last_reflections;
always @(posedge clk) begin
    known <= 1;
    started <= !reset && (started || enable);
    cycles <= reset || !(started || enable) ? 0 : cycles + !done;
    last_usable <= usable;
    last_reflections <= reflections;
end
always @* begin
    if (!known) assume (reset);
    assume (reflections <= REFLECTIONS);
    if (known && started) assume (usable == last_usable && reflections == last_reflections);
end

// A ray: from the cycle after reset_z_buf to add_color. Visits are starts on the tagged plane; place counts cycles.
reg [RECTANGLES-1:0] visited;
reg tracing;
reg [1:0] rays;
reg [15:0] place;
wire [RECTANGLES-1:0] tagged = {{RECTANGLES-1{1'b0}}, 1'b1} << tag;
always @(posedge clk) begin
    if (reset) tracing <= 0;
    else if (reset_z_buf) tracing <= !add_color || rays != reflections;
    visited <= reset_z_buf ? 0 : find_intersection ? visited | tagged : visited;
    rays <= screen_to_ray ? 0 : rays + add_color;
    place <= reset_z_buf ? 0 : place + 1;
end
always @* if (known && started) begin
    if (find_intersection) begin
        assert (tracing && tag < RECTANGLES);
        assert ((usable & tagged) != 0);
        assert (visited < tagged);  // each once, and in ascending order
    end
    if (add_color) assert (tracing && visited == usable && rays <= reflections);
    assert (store_ray == (add_color && rays != reflections));
    assert (reset_color == screen_to_ray);
    assert (reset_z_buf == (screen_to_ray || add_color));
    assert (screen_to_ray == (cycles == 1));
    if (tracing) assert (initial_ray == (rays == 0));
    if (done) assert (!tracing && rays == reflections + 1);
end
always @* if (known && !started) assert (!done && !find_intersection && !write_z_buf && !add_color);

// It ends, in a number of cycles that is known: that of the budget's formula for the usable rectangles. Done stays.
function [5:0] count(input [RECTANGLES-1:0] mask);
    integer i;
    begin
        count = 0;
        for (i = 0; i < RECTANGLES; i = i + 1) count = count + mask[i];
    end
endfunction
wire [15:0] pass = usable == 0 ? 2 : count(usable) * STEPS + RESULT_LATENCY;
wire [15:0] rays_cycles = rays[1] ? (rays[0] ? 3 * pass : 2 * pass) : rays[0] ? pass : 0;
reg was_done;
always @(posedge clk) was_done <= done && !reset;
always @* if (known && started) begin
    if (done) assert (cycles == 2 + rays_cycles);
    else assert (cycles < RUN_BOUND);
    if (was_done) assert (done);
end

// Each start on its way: loaded after 2 cycles, stored STEPS later, offered 2 later, with the rectangle it belongs to.
reg [TRAVEL-1:0] starts;
reg [8:0] tags [0:TRAVEL-1];
always @(posedge clk) begin: follow
    integer i;
    starts <= reset ? 0 : {starts, find_intersection};
    tags[0] <= tag;
    for (i = 1; i < TRAVEL; i = i + 1) tags[i] <= tags[i-1];
end
always @* if (known) begin
    assert (load_divider == starts[1]);
    assert (store_quotient == starts[1+STEPS]);
    assert (write_z_buf == starts[3+STEPS]);
    // The plane at hand while the divider is loaded, and the one whose quotients stand.
    if (load_divider) assert (tag == tags[1]);
    if (starts[2+STEPS]) assert (finishing == tags[2+STEPS]);
    if (starts[3+STEPS]) assert (finishing == tags[3+STEPS]);
    // No result is still under way when the ray is blended.
    if (add_color) assert (starts << 1 == 0);
end

// The divider is never loaded before it is finished.
reg [7:0] since_load;
always @(posedge clk) since_load <= reset || (since_load >= STEPS && !load_divider) ? STEPS
    : load_divider ? 1 : since_load + 1;
always @* if (known && load_divider) assert (since_load >= STEPS);

// Counters in range.
(* hierconn *) wire [SLOT_BITS-1:0] \dut.ray_sequencer_i.rect_sequencer_i.slot ;
(* hierconn *) wire [1:0] \dut.ray_sequencer_i.bounce ;
always @* if (known && tracing) begin
    assert (\dut.ray_sequencer_i.rect_sequencer_i.slot < STEPS);
    assert (\dut.ray_sequencer_i.bounce <= reflections);
end

// Invariants: the state machine is where the counts say, what waits follows what was visited, and everything in flight
// started at a slot's begin.
(* hierconn *) wire [2:0] \dut.ray_sequencer_i.state ;
(* hierconn *) wire \dut.ray_sequencer_i.rect_sequencer_i.fetched ;
(* hierconn *) wire \dut.ray_sequencer_i.rect_sequencer_i.offered ;
(* hierconn *) wire [INDEX_BITS-1:0] \dut.ray_sequencer_i.rect_sequencer_i.upcoming ;
(* hierconn *) wire [RECTANGLES-1:0] \dut.ray_sequencer_i.rect_sequencer_i.waiting ;
(* hierconn *) wire [TRAVEL-1:0] \dut.in_flight ;
(* hierconn *) wire [8:0] \dut.dividing_rect_position ;
localparam IDLE = 0, GENERATE = 1, TRACE = 2, BLEND = 3, DONE = 4;
wire [2:0] state = \dut.ray_sequencer_i.state ;
wire [SLOT_BITS-1:0] slot = \dut.ray_sequencer_i.rect_sequencer_i.slot ;
wire [RECTANGLES-1:0] waiting = \dut.ray_sequencer_i.rect_sequencer_i.waiting ;
wire [RECTANGLES-1:0] lowest_waiting = waiting & -waiting;
wire [RECTANGLES-1:0] offered = {{RECTANGLES-1{1'b0}}, \dut.ray_sequencer_i.rect_sequencer_i.offered } << \dut.ray_sequencer_i.rect_sequencer_i.upcoming ;
wire [RECTANGLES-1:0] left = offered | waiting;
wire starting = state == TRACE && \dut.ray_sequencer_i.rect_sequencer_i.fetched && slot == 0;
wire [RECTANGLES-1:0] taken = starting ? visited | tagged : visited;
wire [15:0] started_slots = count(visited) * STEPS;
wire [15:0] extra = place - started_slots;  // cycles since the last rectangle's slot, once nothing is fetched
always @* if (known) begin
    assert (\dut.in_flight == starts);
    if (!started) assert (state == IDLE && starts == 0 && !tracing);
    else assert (state != IDLE && state <= DONE);
    assert (tracing == (started && (state == TRACE || state == BLEND)));
    if (started && state == GENERATE) assert (cycles == 1 && starts == 0);
    if (started && state == DONE) assert (starts == 0);
    if (state == IDLE || state == GENERATE) assert (!\dut.ray_sequencer_i.rect_sequencer_i.fetched );
    if (state == GENERATE || state == BLEND && usable != 0) assert (!\dut.ray_sequencer_i.rect_sequencer_i.fetched && left == usable);
    if (state != IDLE) assert (waiting == 0 || offered < lowest_waiting && offered != 0 && (offered & waiting) == 0);
    if (tracing) begin
        assert (rays == \dut.ray_sequencer_i.bounce );
        assert (cycles == 2 + rays_cycles + place);
        assert (place < pass);
        assert ((state == BLEND) == (place == pass - 1));
    end
    if (state == TRACE) begin
        if (\dut.ray_sequencer_i.rect_sequencer_i.fetched ) begin
            assert ((taken | left) == usable && (taken & left) == 0);
            assert (left == 0 || taken < offered);
            assert (tag < RECTANGLES);
            if (slot == 0) assert ((usable & tagged) != 0 && visited < tagged);
            else assert (visited != 0);
            assert (place == (slot == 0 ? started_slots : started_slots - STEPS + slot));
        end
        else begin
            assert (visited == usable && left == (extra == 0 ? 0 : usable));
            assert (place >= started_slots && extra <= 4);
            if (usable == 0) assert (extra == 0);
        end
    end
end
always @* if (known && since_load < STEPS) assert (since_load != 0 && (starts >> since_load) & 2);

genvar age;
generate
    for (age = 0; age < TRAVEL; age = age + 1) begin: ages
        always @* if (known && starts[age]) begin
            if (state == TRACE) assert (slot == (age + 1) % STEPS && place > age);
            if (age < 2) assert (tag == tags[age]);
            else if (age < 2 + STEPS) assert (\dut.dividing_rect_position == tags[age]);
            else assert (finishing == tags[age]);
            if (age >= 2 && age < 2 + STEPS) assert (since_load == age - 1);
        end
    end
    for (age = 1; age < STEPS; age = age + 1) begin: slots
        always @* if (known && state == TRACE && \dut.ray_sequencer_i.rect_sequencer_i.fetched && slot == age)
            assert (starts[age-1] && (starts & ((1 << (age - 1)) - 1)) == 0);
    end
    for (age = 0; age <= 4; age = age + 1) begin: extras
        always @* if (known && state == TRACE && !\dut.ray_sequencer_i.rect_sequencer_i.fetched && usable != 0 && extra == age) begin
            assert (slot == age % STEPS);
            assert (starts[STEPS+age-1] && (starts & ((1 << (STEPS + age - 1)) - 1)) == 0);
        end
    end
endgenerate

// A run with everything in it ends.
always @* cover (done && started && &usable && reflections == REFLECTIONS);
endmodule
