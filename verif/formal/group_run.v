// SPDX-License-Identifier: MIT
// A run of the control for a group of rays, included by the properties of its order. A tag models the answer of the
// memory: one cycle after a fetch it is the fetched index.
//
// Assumed, as the renderer guarantees: one cycle of reset at first; the usable rectangles, those that may be hit and
// the reflections are constant from the cycle in which the control starts until the next reset; there are at most
// REFLECTIONS reflections. Reset may come at any time, and registers are arbitrary before the first one.
always @(posedge clk) if (fetch) tag <= index;

// Since the last reset: whether the control was enabled, and the number of cycles that it has been active.
reg known = 0;
reg started;
reg [TIME_BITS-1:0] cycles;
reg [RECTANGLES-1:0] last_usable, last_may_hit;
reg [REFLECTION_BITS-1:0] last_reflections;
always @(posedge clk) begin
    known <= 1;
    started <= !reset && (started || enable);
    cycles <= reset || !(started || enable) ? 0 : cycles + !done;
    last_usable <= usable;
    last_may_hit <= may_hit;
    last_reflections <= reflections;
end
always @* begin
    if (!known) assume (reset);
    assume (reflections <= REFLECTIONS);
    if (known && started) begin
        assume (usable == last_usable && may_hit == last_may_hit);
        assume (reflections == last_reflections);
    end
end

function [5:0] count(input [RECTANGLES-1:0] mask);
    integer i;
    begin
        count = 0;
        for (i = 0; i < RECTANGLES; i = i + 1) count = count + mask[i];
    end
endfunction
reg was_done;
always @(posedge clk) was_done <= done && !reset;
always @* if (known && was_done) assert (done);
