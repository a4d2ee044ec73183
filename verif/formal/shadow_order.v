// SPDX-License-Identifier: MIT
// The control of the exact engine with LIGHT=1: the rectangles that each pass of rays and of shadows tests, and when.
//
// The tag of group_run.v replaces the position of the rectangle's plane, so that it can be followed to the write.
//
// Any hit point may be in question, in any cycle. All other assumptions are in group_run.v.
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

module shadow_order;
localparam TRAVEL = 3;  // from a rectangle's start to its write
`include "group_run.v"
wire [AIM_CYCLES-1:0] aim = steps_aim;
wire any_in_question = fate_any_in_question, write_shadow = steps_write_shadow;

// A pass of rays lasts from the cycle after reset_z_buf until aim, which lasts AIM_CYCLES. A shadow pass follows in the
// next cycle if any hit point is in question then, and lasts until add_colour. A shadow pass is dark from the cycle
// after one in which no hit point is in question, and then drops the tests in flight.
localparam NONE = 0, RAYS = 1, AIM = 2, SHADOW = 3, BLENDING = 4;
reg [2:0] pass;
reg dark;
wire next_pass = aim != 0;
wire [RECTANGLES-1:0] wanted_rays = rays == 0 ? usable & may_hit : usable, wanted = pass == RAYS ? wanted_rays : usable;
wire [TRAVEL-1:0] dropped = {TRAVEL{pass == SHADOW && !any_in_question}};
always @(posedge clk) begin
    if (reset) pass <= NONE;
    else if (reset_z_buf) pass <= !add_colour || reflected && fate_any_alive ? RAYS : NONE;
    else if (aim[AIM_CYCLES-1]) pass <= any_in_question ? SHADOW : BLENDING;
    else if (pass == RAYS && visited == wanted && starts[TRAVEL-2:0] == 0 && !find_intersection) pass <= AIM;
    dark <= !reset && !reset_z_buf && pass == SHADOW && (dark || !any_in_question);
end

always @* if (known && started) begin
    if (find_intersection) assert (pass == RAYS || pass == SHADOW);
    assert (write_z_buf == (pass == RAYS && starts[TRAVEL-1]));
    assert (write_shadow == (pass == SHADOW && starts[TRAVEL-1]));
    if (write_shadow) assert (offered_position == tags[9*(TRAVEL-1) +: 9] && !reset_z_buf);
    if (aim != 0) assert (starts == 0);
    assert ((aim != 0) == (pass == AIM));
    if (add_colour) assert (lost || pass == BLENDING || pass == SHADOW && (dark || visited == usable));
end

// The control ends within the cycles of the budget's formula.
wire [TIME_BITS-1:0] rays_end = count(wanted_rays) + 2;  // the last write
wire [TIME_BITS-1:0] light_from = rays_end + AIM_CYCLES + 1;
wire [TIME_BITS-1:0] most = 2 * count(usable) + AIM_CYCLES + 7;
wire [TIME_BITS-1:0] rays_cycles = (rays[0] ? most : 0) + (rays[1] ? 2 * most : 0) + (rays[2] ? 4 * most : 0);
always @* if (known && started && done) assert (cycles <= 2 + rays_cycles);

// Invariants besides those of group_run.v.
localparam WAITING = 0, AIMING = 1, TESTING = 2;
wire [1:0] light = dut.shadow_sequencer_i.state;
wire [AIM_CYCLES-1:0] one_hot = dut.shadow_sequencer_i.cycle;
wire [RECTANGLES-1:0] taken = visited | tagged;
reg [TIME_BITS-1:0] time_of_light;
wire [TIME_BITS-1:0] time_in_pass = pass == SHADOW ? place - time_of_light : place;
always @(posedge clk) if (aim[AIM_CYCLES-1]) time_of_light <= place + 1;
always @* if (known) begin
    assert (tracing == (pass != NONE) && light <= TESTING && pass <= BLENDING);
    assert (dut.ray_sequencer_i.rect_sequencer_i.cycle == 0 || !started || !fetched);
    if (!started) assert (light == WAITING);
    if (started) begin
        assert ((state == BLEND) == add_colour && (light == AIMING) == (pass == AIM));
        assert ((light == TESTING) == (pass == SHADOW && state == TRACE));
        if (pass == BLENDING) assert (add_colour);
    end
    if (dark) assert (pass == SHADOW && starts == 0 && (state != TRACE || !fetched));
    if (light == AIMING) assert (one_hot != 0 && (one_hot & (one_hot - 1)) == 0);
    if (light == WAITING && pass == RAYS && place != 0) assert (one_hot == 1);
    if (tracing || lost) assert (cycles <= 2 + rays_cycles + place);
    if (pass == RAYS) assert (state == TRACE && place <= rays_end);
    if (pass == AIM) assert (!fetched && left == usable && visited == (aim[0] ? wanted_rays : 0));
    if (pass == SHADOW) begin
        assert (time_of_light <= light_from && place >= time_of_light);
        assert (time_in_pass <= count(usable) + 2 + add_colour);
    end
    if (pass == BLENDING) assert (place <= light_from);
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
end
wire [26:0] pipeline = {offered_position, dut.second_word[24 +: 9], dut.first_word[24 +: 9]};
genvar age;
generate
    for (age = 0; age < TRAVEL; age = age + 1) begin: ages
        always @* if (known && starts[age]) begin
            assert (pipeline[9*age +: 9] == tags[9*age +: 9]);
            assert (time_in_pass > age && time_in_pass <= count(wanted) + age);
        end
    end
    for (age = 0; age < AIM_CYCLES; age = age + 1) begin: aims
        always @* if (known && aim[age]) assert (place <= rays_end + 1 + age);
    end
endgenerate

// Covers the end of a run with every shadow pass whole, and of one in which shadow passes end early.
reg ever_dark, ever_blend;
always @(posedge clk) begin
    ever_dark <= started && (ever_dark || dark);
    ever_blend <= started && (ever_blend || pass == BLENDING || lost);
end
always @* cover (done && started && !ever_dark && !ever_blend && &usable && reflections == REFLECTIONS);
always @* cover (done && started && ever_dark && &usable);
always @* cover (done && started && ever_blend);
endmodule
