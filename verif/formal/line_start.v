// SPDX-License-Identifier: MIT
// The start of each line with a camera that turns, at full width and with any function instead of multiplication: from
// AIM_LATENCY cycles after start_line, aim is the first column's slope, view distance * forward - centre * right +
// row_slope * up, which fits its bits by slope-in-range. After the sweep with it, aim is the growth per step: right, or
// with two pixels per clock first the second column's slope, and then twice right. Each sweep except the first starts
// when the previous one ends.
//
// Assumed, as rect_setup guarantees: its last load comes at least LATENCY cycles after its start. Assumed about the
// renderer: lines start at least AIM_LATENCY cycles apart, and the camera is constant along a line.
//
// [proof]
// claim = "with a turning camera, a line gets its first column's slope, and then the growth per step, at full width"
// modules = ["line_starter"]
// any_product = true
// parameters = { SLOPE_BITS = "SLOPE_BITS + 1", LATENCY = "SETUP_LATENCY" }
// induction = "AIM_LATENCY + 1"
// reach = 14
// quick = ["beam two turn"]
// designs = ["beam two pairs turn"]
// [faults]
// "beam-vga240-s2-u1-r2-m1-c8-turn" = ["line_starter.ages[3] 0", "line_starter.y_product signed-short",
//   "line_starter.factor negated", "line_starter.start_sweep as ages[1]"]

module line_start;
wire [3*SLOPE_BITS-1:0] aim = {aim_z, aim_y, aim_x};

// Cycles since the start of the line and of a sweep, up to the latency; sweeps that have ended in the line.
reg ready = 1'b0;
reg [2:0] age, sweep_age;
reg [1:0] ended;
reg signed [FACTOR_BITS-1:0] height;
wire ends = loaded && ended < PIXELS;
always @(posedge clk) begin
    ready <= ready || reset;
    age <= reset ? 0 : start_line ? 1 : age == 0 || age == AIM_LATENCY ? age : age + 1;
    sweep_age <= start_sweep ? 1 : sweep_age == LATENCY ? sweep_age : sweep_age + 1;
    ended <= reset ? PIXELS : start_line ? 0 : ended + ends;
    if (age == 3) height <= row_slope;
end
always @* begin
    assume (ready || reset);
    if (start_line) assume (age == 0 || age == AIM_LATENCY);
    if (age != 0) assume ($stable(camera_word));
    if (loaded) assume (!start_line && (age == 0 || age == AIM_LATENCY) && sweep_age == LATENCY && !$past(ends));
    if ($past(ends)) assume (!start_line);
    if (ready) begin
        assert (age <= AIM_LATENCY && ended <= PIXELS);
        assert (start_sweep == (age == 2 || ends));
        assert (enter == (ends ? 1 << ended : 0));
        if (age != AIM_LATENCY && age != 0) assert (ended == 0);
    end
end

// The factors are not constants here, so that the function replaces their products too.
(* anyconst *) reg signed [FACTOR_BITS-1:0] view, first_column;
always @* assume (view == VIEW_DISTANCE && first_column == -CENTRE);
wire [2:0] to_end = {ended == 2, ended == 1, ended == 0};
line_starter dut (.*);
always @* if (ready) assert (dut.sweeps == to_end[PIXELS-1:0]);
generate
    genvar axis;
    for (axis = 0; axis < 3; axis = axis + 1) begin: along
        wire signed [BASIS_BITS-1:0] forward = camera_word[(8-axis)*BASIS_BITS +: BASIS_BITS];
        wire signed [BASIS_BITS-1:0] right = camera_word[(5-axis)*BASIS_BITS +: BASIS_BITS];
        wire signed [BASIS_BITS-1:0] up = camera_word[(2-axis)*BASIS_BITS +: BASIS_BITS];
        wire signed [SLOPE_BITS-1:0] ahead = view * forward, aside = first_column * right, upward = height * up;
        wire signed [SLOPE_BITS-1:0] rising = row_slope * up;
        wire signed [SLOPE_BITS-1:0] sum = ahead + aside + upward, second = sum + right;
        wire signed [SLOPE_BITS-1:0] step = PIXELS > 1 ? right + right : right;
        wire signed [SLOPE_BITS-1:0] seen = aim[axis*SLOPE_BITS +: SLOPE_BITS];
        always @* if (ready && !$past(ends)) begin
            if (age == 2) assert (seen == 0);
            if (age == 3) assert (seen == ahead);
            if (age == 4) assert (seen == ahead + aside);
            if (age == AIM_LATENCY) assert (seen == (ended == 0 ? sum : ended < PIXELS ? second : step));
        end
        always @* if (ready && $past(ends)) assert (age == 0 || age == AIM_LATENCY);
    end
endgenerate

always @* cover (ready && age == AIM_LATENCY && ended == 0 && loaded);
endmodule
