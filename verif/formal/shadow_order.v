// SPDX-License-Identifier: MIT
// The control of the exact engine with LIGHT=1: which rectangles each pass of rays and each shadow pass tests, and when.
//
// The tag of group_run.v replaces the position of the rectangle's plane, so that it can be followed to the write.
//
// Assumed besides group_run.v, as the units guarantee: if no ray is alive at the end of one pass, none is at the end of
// the next one, which is not traced. Otherwise any ray may be alive, and any hit point in question, in any cycle.
//
// [proof]
// claim = """a pass of rays and a shadow pass each test every rectangle that they may hit once and in order; a shadow \
// pass follows if a hit point is in question, ends early only if none is, and none of its tests reaches a z buffer"""
// modules = ["exact_control", "ray_sequencer", "rect_sequencer", "shadow_sequencer"]
// induction = 1
// reach = "RUN_BOUND + 2 if RECTANGLES == 2 and REFLECTIONS == 1 else 0"
// quick = ["exact tiny light rectangles=2 reflections=1"]
// designs = [
//   "exact tiny light rectangles=2,3,4 reflections=0,1,2,3,4", "exact one-unit light reflections=1,4",
// ]
// parameters = { RUN_BOUND = "GROUP_CYCLES - 2" }  # done comes two cycles before the next group may start
// [faults]
// "exact-tiny48-u2-r2-m1-c8-light" = ["ray_sequencer.shadow_pass_awaited 0", "shadow_sequencer.any_in_question 1",
//   "ray_sequencer.shadow_pass_stop 0 in 20", "shadow_sequencer.aimed late", "ray_sequencer.shadow_pass_start 0 in 20",
//   "ray_sequencer.stop as reset_ray_caster in 20", "exact_control.from_light 0 in 24"]

module shadow_order #(
    parameter RECTANGLES = 2, parameter INDEX_BITS = 1, parameter REFLECTIONS = 1, parameter REFLECTION_BITS = 3,
    parameter AIM_CYCLES = 4, parameter RUN_BOUND = 50
) (
    input clk, input reset, input enable, input [RECTANGLES-1:0] usable, input [REFLECTION_BITS-1:0] reflections,
    input [RECTANGLES-1:0] may_hit, input any_alive, input any_in_question
);
localparam TRAVEL = 3;  // from a rectangle's start to its write
localparam TIME_BITS = $clog2(RUN_BOUND) + 1;
localparam BOUNDS_BITS = 4 * 9, SURFACE_BITS = 2 + 9 + 24, RECT_BITS = SURFACE_BITS + BOUNDS_BITS;
localparam POSITION = 24;

wire done, fetch, screen_to_ray, initial_ray, find_intersection, reset_z_buf, write_z_buf, write_shadow, reset_colour,
    add_colour, store_ray;
wire [AIM_CYCLES-1:0] aim;
wire [INDEX_BITS-1:0] index;
reg [8:0] tag;
wire [RECT_BITS-1:0] rect = {2'd0, tag, 24'd0, {BOUNDS_BITS{1'b0}}};
wire [SURFACE_BITS-1:0] offered_surface;
wire [8:0] offered_tag = offered_surface[POSITION+:9];

exact_control dut (
    .clk(clk), .reset_ray_caster(reset), .enable(enable), .picture_reflections(reflections), .done(done),
    .rects_usable(usable), .rects_index(index), .rects_fetch(fetch), .rects_rect_word(rect), .fate_may_hit(may_hit),
    .fate_any_alive(any_alive), .fate_any_in_question(any_in_question), .steps_screen_to_ray(screen_to_ray),
    .steps_initial_ray(initial_ray), .steps_find_intersection(find_intersection), .steps_reset_z_buf(reset_z_buf),
    .steps_write_z_buf(write_z_buf), .steps_reset_colour(reset_colour), .steps_add_colour(add_colour),
    .steps_store_ray(store_ray), .steps_aim(aim), .steps_write_shadow(write_shadow), .offered_word(offered_surface)
);

`include "group_run.v"

// A pass of rays lasts from the cycle after reset_z_buf until aim, which lasts AIM_CYCLES. A shadow pass follows in the
// next cycle if any hit point is in question then, and lasts until add_colour. A shadow pass is dark from the cycle
// after one in which no hit point is in question.
localparam NONE = 0, RAYS = 1, AIM = 2, SHADOW = 3, BLEND = 4;
reg [2:0] pass;
reg dark, lost;
reg [RECTANGLES-1:0] visited;
reg [REFLECTION_BITS-1:0] rays;
reg [TIME_BITS-1:0] time_in_ray;  // since reset_z_buf
wire [RECTANGLES-1:0] tagged = {{RECTANGLES-1{1'b0}}, 1'b1} << tag;
wire [RECTANGLES-1:0] wanted = pass == RAYS && rays == 0 ? usable & may_hit : usable;
wire reflected = add_colour && rays != reflections;
wire drop = pass == SHADOW && !any_in_question;
always @(posedge clk) begin
    if (reset) pass <= NONE;
    else if (reset_z_buf) pass <= !add_colour || reflected && any_alive ? RAYS : NONE;
    else if (aim[AIM_CYCLES-1]) pass <= any_in_question ? SHADOW : BLEND;
    else if (pass == RAYS && visited == wanted && starts[TRAVEL-2:0] == 0 && !find_intersection) pass <= AIM;
    lost <= !reset && reflected && !any_alive;
    dark <= !reset && !reset_z_buf && pass == SHADOW && (dark || !any_in_question);
    visited <= reset_z_buf || aim != 0 ? 0 : find_intersection ? visited | tagged : visited;
    rays <= screen_to_ray ? 0 : rays + add_colour;
    time_in_ray <= reset_z_buf ? 0 : time_in_ray + 1;
end
always @* if (known && lost) assume (!any_alive);

// Tests in flight; those of a shadow pass are dropped as soon as no hit point is in question.
reg [TRAVEL-1:0] starts;
reg [8:0] tags [0:TRAVEL-1];
always @(posedge clk) begin: follow
    integer i;
    for (i = 0; i < TRAVEL; i = i + 1) begin
        starts[i] <= !reset && !drop && (i == 0 ? find_intersection : starts[i-1]);
        tags[i] <= i == 0 ? tag : tags[i-1];
    end
end

always @* if (known && started) begin
    if (find_intersection) begin
        assert (pass == RAYS || pass == SHADOW);
        assert (tag < RECTANGLES && (wanted & tagged) != 0);
        assert (visited < tagged);  // each once, and in ascending order
    end
    assert (write_z_buf == (pass == RAYS && starts[TRAVEL-1]));
    assert (write_shadow == (pass == SHADOW && starts[TRAVEL-1]));
    if (write_z_buf || write_shadow) assert (offered_tag == tags[TRAVEL-1]);
    if (aim != 0) assert (pass == AIM && starts == 0);
    if (pass == AIM) assert (aim != 0);
    if (add_colour) begin
        assert (lost || pass == BLEND || pass == SHADOW && (dark || visited == usable));
        assert (starts == 0 && rays <= reflections);
    end
    if (lost) assert (add_colour && pass == NONE);
    assert (store_ray == reflected);
    assert (reset_colour == screen_to_ray);
    assert (reset_z_buf == (screen_to_ray || add_colour));
    assert (!(reset_z_buf && (write_z_buf || write_shadow)));
    assert (screen_to_ray == (cycles == 1));
    if (pass != NONE || lost) assert (initial_ray == (rays == 0));
    if (done) assert (pass == NONE && !lost && rays == reflections + 1);
end
always @* if (known && !started) assert (!done && !find_intersection && !write_z_buf && !write_shadow && !add_colour);

// The control ends within the cycles of the budget's formula.
wire [TIME_BITS-1:0] rays_end = count(rays == 0 ? usable & may_hit : usable) + 2;  // the last write
wire [TIME_BITS-1:0] light_from = rays_end + AIM_CYCLES + 1;
wire [TIME_BITS-1:0] most = 2 * count(usable) + AIM_CYCLES + 7;
wire [TIME_BITS-1:0] rays_cycles = (rays[0] ? most : 0) + (rays[1] ? 2 * most : 0) + (rays[2] ? 4 * most : 0);
always @* if (known && started) begin
    if (done) assert (cycles <= 2 + rays_cycles);
    else assert (cycles < RUN_BOUND);
end

// Invariants: the state matches the counts, and the waiting rectangles follow the visited ones.
(* hierconn *) wire [REFLECTION_BITS-1:0] \dut.ray_sequencer_i.bounce ;
(* hierconn *) wire [2:0] \dut.ray_sequencer_i.state ;
(* hierconn *) wire \dut.ray_sequencer_i.rect_sequencer_i.fetched ;
(* hierconn *) wire \dut.ray_sequencer_i.rect_sequencer_i.offered ;
(* hierconn *) wire \dut.ray_sequencer_i.rect_sequencer_i.cycle ;
(* hierconn *) wire [INDEX_BITS-1:0] \dut.ray_sequencer_i.rect_sequencer_i.upcoming ;
(* hierconn *) wire [RECTANGLES-1:0] \dut.ray_sequencer_i.rect_sequencer_i.waiting ;
(* hierconn *) wire [TRAVEL-1:0] \dut.in_flight ;
(* hierconn *) wire [1:0] \dut.shadow_sequencer_i.state ;
(* hierconn *) wire [AIM_CYCLES-1:0] \dut.shadow_sequencer_i.cycle ;
(* hierconn *) wire [SURFACE_BITS-1:0] \dut.first_word ;
(* hierconn *) wire [SURFACE_BITS-1:0] \dut.second_word ;
localparam IDLE = 0, GENERATE = 1, TRACE = 2, BLENDING = 3, DONE = 4;
localparam WAITING = 0, AIMING = 1, TESTING = 2;
wire [2:0] state = \dut.ray_sequencer_i.state ;
wire [1:0] light = \dut.shadow_sequencer_i.state ;
wire [AIM_CYCLES-1:0] one_hot = \dut.shadow_sequencer_i.cycle ;
wire fetched = \dut.ray_sequencer_i.rect_sequencer_i.fetched ;
wire [RECTANGLES-1:0] waiting = \dut.ray_sequencer_i.rect_sequencer_i.waiting ;
wire [RECTANGLES-1:0] lowest_waiting = waiting & -waiting;
wire [RECTANGLES-1:0] next = {{RECTANGLES-1{1'b0}}, \dut.ray_sequencer_i.rect_sequencer_i.offered } << \dut.ray_sequencer_i.rect_sequencer_i.upcoming ;
wire [RECTANGLES-1:0] left = next | waiting;
wire [RECTANGLES-1:0] taken = visited | tagged;
wire [TIME_BITS-1:0] time_in_pass = pass == SHADOW ? time_in_ray - time_of_light : time_in_ray;
reg [TIME_BITS-1:0] time_of_light;
always @(posedge clk) time_of_light <= aim[AIM_CYCLES-1] ? time_in_ray + 1 : time_of_light;
always @* if (known) begin
    assert (\dut.in_flight == starts);
    assert (\dut.ray_sequencer_i.rect_sequencer_i.cycle == 0 || !started || !fetched);
    if (!started) assert (cycles == 0 && state == IDLE && light == WAITING && starts == 0 && pass == NONE && !lost);
    else assert (state != IDLE && state <= DONE && (state == GENERATE ? cycles == 1 : cycles > 1));
    if (started) begin
        assert ((state == TRACE) == (pass == RAYS || pass == AIM || pass == SHADOW && !add_colour));
        assert ((state == BLENDING) == add_colour);
        assert ((light == AIMING) == (pass == AIM));
        assert ((light == TESTING) == (pass == SHADOW && state == TRACE));
        assert (light <= TESTING && pass <= BLEND);
        if (pass == BLEND) assert (add_colour);
        if (state == GENERATE || state == DONE) assert (pass == NONE && !lost);
    end
    if (dark) assert (pass == SHADOW && starts == 0);
    if (light == AIMING) assert (one_hot != 0 && (one_hot & (one_hot - 1)) == 0);
    if (light == WAITING && pass == RAYS && time_in_ray != 0) assert (one_hot == 1);
    if (state != TRACE) assert (starts == 0);
    if (state == IDLE || state == GENERATE) assert (!fetched);
    if (state == GENERATE) assert (left == (usable & may_hit));
    if (state == BLENDING && !lost) assert (!fetched && left == usable);
    if (state != IDLE) begin
        assert (waiting == 0 || next < lowest_waiting && next != 0 && (next & waiting) == 0);
        assert (\dut.ray_sequencer_i.rect_sequencer_i.offered == (next != 0));
    end
    if (pass != NONE || lost) begin
        assert (rays == \dut.ray_sequencer_i.bounce && rays <= reflections);
        assert (cycles <= 2 + rays_cycles + time_in_ray);
    end
    if (lost) assert (state == BLENDING && time_in_ray == 0 && rays != 0);
    if (pass == RAYS) assert (time_in_ray <= rays_end);
    if (pass == AIM) begin
        assert (!fetched && left == usable && visited == (aim[0] ? wanted_rays : 0));
    end
    if (pass == SHADOW) begin
        assert (time_of_light <= light_from && time_in_ray >= time_of_light);
        assert (time_in_pass <= count(usable) + 2 + add_colour);
    end
    if (pass == BLEND) assert (time_in_ray <= light_from);
    if (pass == RAYS || pass == SHADOW && state == TRACE && !dark) begin
        if (fetched) begin
            assert ((taken | left) == wanted && (taken & left) == 0);
            assert (left == 0 || taken < next);
            assert (tag < RECTANGLES && (wanted & tagged) != 0 && visited < tagged);
            assert (time_in_pass == count(visited));
        end
        else begin
            assert (visited == wanted && left == (time_in_pass == count(wanted) ? 0 : usable));
            assert (time_in_pass >= count(wanted));
        end
    end
    if (dark && state == TRACE) assert (!fetched);
end
wire [RECTANGLES-1:0] wanted_rays = rays == 0 ? usable & may_hit : usable;
genvar age;
generate
    for (age = 0; age < TRAVEL; age = age + 1) begin: ages
        always @* if (known && starts[age]) begin
            assert ((age == 0 ? \dut.first_word [POSITION+:9] : age == 1 ? \dut.second_word [POSITION+:9] : offered_tag) == tags[age]);
            assert (time_in_pass > age && time_in_pass <= count(wanted) + age);
        end
    end
endgenerate

generate
    for (age = 0; age < AIM_CYCLES; age = age + 1) begin: aims
        always @* if (known && aim[age]) assert (time_in_ray <= rays_end + 1 + age);
    end
endgenerate

// Covers the end of a run with every shadow pass whole, and of one in which shadow passes end early.
reg ever_dark, ever_blend;
always @(posedge clk) begin
    ever_dark <= started && (ever_dark || dark);
    ever_blend <= started && (ever_blend || pass == BLEND || lost);
end
always @* cover (done && started && !ever_dark && !ever_blend && &usable && reflections == REFLECTIONS);
always @* cover (done && started && ever_dark && &usable);
always @* cover (done && started && ever_blend);
endmodule
