// SPDX-License-Identifier: MIT
// A run of the control for a group of rays, included by the properties of its order. They define `next_pass`, true in
// cycles that separate the passes of a ray over the rectangles; `wanted`, the rectangles of the current pass; and
// `dropped`, the starts in flight that go no further.
//
// Assumed, as the renderer guarantees: one cycle of reset at first; the usable rectangles, those that may be hit and
// the reflections are constant from the cycle in which the control starts until the next reset; there are at most
// REFLECTIONS reflections. Reset may come at any time, and registers are arbitrary before the first one. Assumed, as
// the units guarantee: if no ray is alive at the end of one pass, none is at the end of the next one, which is not
// traced. Otherwise any ray may be alive in any cycle.
`DUT dut (.*);
wire reset = reset_ray_caster, find_intersection = steps_find_intersection, reset_z_buf = steps_reset_z_buf,
    write_z_buf = steps_write_z_buf, add_colour = steps_add_colour, screen_to_ray = steps_screen_to_ray;
wire [RECTANGLES-1:0] usable = rects_usable, may_hit = fate_may_hit;
wire [REFLECTION_BITS-1:0] reflections = picture_reflections;
localparam TIME_BITS = $clog2(RUN_BOUND) + 1;

// A tag models the answer of the memory, in the position of the plane: one cycle after a fetch it is the fetched index.
// `surface_tags` are those in the pipeline of the exact engine.
reg [8:0] tag;
always @(posedge clk) if (rects_fetch) tag <= rects_index;
assign rects_rect_word = {2'd0, tag, 60'd0};

// Since the last reset: whether the control was enabled, and the number of cycles that it has been active.
reg started, was_done;
reg [TIME_BITS-1:0] cycles;
always @(posedge clk) begin
    started <= !reset && (started || enable);
    cycles <= reset || !(started || enable) ? 0 : cycles + !done;
    was_done <= done && !reset;
end
always @* begin
    assume (reflections <= REFLECTIONS);
    if (known && started) assume ($stable(usable) && $stable(may_hit) && $stable(reflections));
    if (known && lost) assume (!fate_any_alive);
    if (known && was_done) assert (done);
end

function [5:0] count(input [RECTANGLES-1:0] mask);
    integer i;
    begin
        count = 0;
        for (i = 0; i < RECTANGLES; i = i + 1) count = count + mask[i];
    end
endfunction

// A ray lasts from the cycle after reset_z_buf to add_colour; for a lost ray, where none was alive, that is one cycle.
// Visits are starts on the tagged plane; place counts cycles.
reg [RECTANGLES-1:0] visited;
reg tracing, lost;
reg [REFLECTION_BITS-1:0] rays;
reg [TIME_BITS-1:0] place;
wire [RECTANGLES-1:0] tagged = {{RECTANGLES-1{1'b0}}, 1'b1} << tag;
wire reflected = add_colour && rays != reflections;
always @(posedge clk) begin
    if (reset) tracing <= 0;
    else if (reset_z_buf) tracing <= !add_colour || reflected && fate_any_alive;
    lost <= !reset && reflected && !fate_any_alive;
    visited <= reset_z_buf || next_pass ? 0 : find_intersection ? visited | tagged : visited;
    rays <= screen_to_ray ? 0 : rays + add_colour;
    place <= reset_z_buf ? 0 : place + 1;
end

// Starts in flight, the latest first.
reg [TRAVEL-1:0] starts;
reg [9*TRAVEL-1:0] tags;
always @(posedge clk) begin
    starts <= reset ? 0 : {starts, find_intersection} & ~dropped;
    tags <= {tags, tag};
end

always @* if (known && started) begin
    if (find_intersection) begin
        assert (tracing && tag < RECTANGLES && (wanted & tagged) != 0);
        assert (visited < tagged);  // each once, and in ascending order
    end
    if (add_colour) assert ((lost || tracing) && starts == 0 && rays <= reflections);
    if (lost) assert (add_colour && !tracing);
    assert (steps_store_ray == reflected);
    assert (steps_reset_colour == screen_to_ray);
    assert (reset_z_buf == (screen_to_ray || add_colour));
    assert (!(reset_z_buf && write_z_buf));
    assert (screen_to_ray == (cycles == 1));
    if (tracing || lost) assert (steps_initial_ray == (rays == 0));
    if (done) assert (!tracing && !lost && rays == reflections + 1);
    else assert (cycles < RUN_BOUND);
end
always @* if (known) begin
    if (!started) assert (!done && !find_intersection && !write_z_buf && !add_colour);
    if (write_z_buf) assert (offered_position == tags[9*(TRAVEL-1) +: 9]);
end

// Invariants: the state matches the counts, and the waiting rectangles follow the visited ones.
localparam IDLE = 0, GENERATE = 1, TRACE = 2, BLEND = 3, DONE = 4;
wire [2:0] state = dut.ray_sequencer_i.state;
wire fetched = dut.ray_sequencer_i.rect_sequencer_i.fetched;
wire [RECTANGLES-1:0] waiting = dut.ray_sequencer_i.rect_sequencer_i.waiting;
wire [RECTANGLES-1:0] lowest_waiting = waiting & -waiting;
wire [RECTANGLES-1:0] any_next = {{RECTANGLES-1{1'b0}}, dut.ray_sequencer_i.rect_sequencer_i.offered};
wire [RECTANGLES-1:0] next = any_next << dut.ray_sequencer_i.rect_sequencer_i.upcoming, left = next | waiting;
always @* if (known) begin
    assert (dut.in_flight == starts);
    if (!started) assert (cycles == 0 && state == IDLE && starts == 0 && !tracing && !lost);
    else assert (state != IDLE && state <= DONE && (state == GENERATE ? cycles == 1 : cycles > 1));
    assert ((tracing || lost) == (started && (state == TRACE || state == BLEND)));
    if (state != TRACE) assert (starts == 0);
    if (state == IDLE || state == GENERATE) assert (!fetched);
    if (state == GENERATE) assert (left == (usable & may_hit));
    if (state == BLEND && tracing) assert (!fetched && left == usable);
    if (state != IDLE) begin
        assert (waiting == 0 || next < lowest_waiting && next != 0 && (next & waiting) == 0);
        assert (dut.ray_sequencer_i.rect_sequencer_i.offered == (next != 0));
    end
    if (tracing || lost) assert (rays == dut.ray_sequencer_i.bounce && rays <= reflections);
    if (lost) assert (state == BLEND && place == 0 && rays != 0);
end
