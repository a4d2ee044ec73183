// SPDX-License-Identifier: MIT
// The beam engine's rectangle tests at its own widths, ray_tester or, if FOLDED, fold_tester, with any function instead
// of multiplication. A rectangle is hit if the cross-multiplied definition says so for the ray from the mirrored eye
// E': t = n / D'[a] with n = k - E'[a] is ahead, within the bounds, and beyond the last mirror or in its plane.
//
// The walk, the offsets and T are as walked-products, turned-walks and fold-products prove. Assumed about products: the
// lemmas product-in-range, next-column (n D[p] = (n - T[a]) D[p] + T[a] D[p]) and ahead-of-mirror, and that a product
// with 0 is 0. Assumed, as the lane guarantees: the rectangle and the camera are constant, as are D[x] and D[z] unless
// TURN; each input comes in the cycle in which it is read; an axis is 0, 1 or 2; the last mirror was ahead.
//
// [proof]
// claim = "a rectangle is hit if the cross-multiplied definition from the mirrored eye says so, at full width"
// modules = ["fold_tester if FOLDED", "ray_tester if not FOLDED", "bound_tester"]
// any_product = true
// induction = "TESTER_LATENCY + (FOLD_LEAD if FOLDED else 0) + 1"
// reach = "TESTER_LATENCY + (FOLD_LEAD if FOLDED else 0) + 2"
// label = "{DESIGN} {'folded' if FOLDED else 'straight'}"
// quick = ["beam two FOLDED=0,1"]
// designs = [
//   "beam two reflections=2 FOLDED=0,1", "beam two pairs FOLDED=0,1", "beam two pairs turn FOLDED=0,1",
//   "beam two turn patterns reflections=4 FOLDED=0,1",
// ]
// [faults]
// "beam-vga240-s2-u1-r2-m1-c8 straight" = ["bound_tester.low_edge as twice_low",
//   "bound_tester.twice_high signed-short", "ray_tester.ahead 1", "ray_tester.back_1 as back"]
// "beam-vga240-s2-u1-r2-m1-c8 folded" = ["fold_tester.folded_p[18] 0", "fold_tester.flipped_way_p increased",
//   "fold_tester.plane_fold_distance edge", "fold_tester.before_border_2 inverted", "fold_tester.met_2 1"]
// "beam-vga180-s6-u2-r2-m1-c8 folded" = ["fold_tester.plane_fold_shift 0", "fold_tester.folded_q as folded_p",
//   "fold_tester.e as size_a"]

module beam_tester_products #(
    parameter FOLDED = 0, parameter STAGED = 0, parameter TURN = 0, parameter PATTERNS = 0,
    parameter COORDINATE_BITS = 9, parameter LOOK_BITS = 24, parameter SLOPE_BITS = 9, parameter STEEPEST = 320,
    parameter REFLECTIONS = 1, parameter WALK_BITS = 19, parameter SHIFT_BITS = 11, parameter FOLD_BITS = 21,
    parameter NUMERATOR_BITS = 10, parameter INDEX_BITS = 1, parameter VIEW_DISTANCE = 200
) (
    input clk, input step, input signed [SHIFT_BITS:0] mirrored_x, input signed [SHIFT_BITS:0] mirrored_y,
    input signed [SHIFT_BITS:0] mirrored_z, input [2:0] any_back, input [2:0] met, input [1:0] mirror_axis,
    input [COORDINATE_BITS-1:0] mirror, input signed [SLOPE_BITS:0] any_dx, input signed [SLOPE_BITS:0] dy,
    input signed [SLOPE_BITS:0] any_dz, input [6*FOLD_BITS+3*WALK_BITS-1:0] any_fold
);
localparam LAST = (1 << COORDINATE_BITS) - 1, WIDE = SHIFT_BITS + 3, DISTANCE_BITS = COORDINATE_BITS + 1;
localparam SUM = FOLD_BITS + 3, MIRRORS = FOLDED ? REFLECTIONS : 0;

(* anyconst *) reg usable;
(* anyconst *) reg [1:0] axis;
(* anyconst *) reg [COORDINATE_BITS-1:0] x, y, z, position, u_low, u_high, v_low, v_high;
(* anyconst *) reg [LOOK_BITS-1:0] look;
(* anyconst *) reg [INDEX_BITS-1:0] index;
(* anyconst *) reg signed [SLOPE_BITS:0] same_dz;
wire signed [SLOPE_BITS:0] dx = TURN ? any_dx : VIEW_DISTANCE, dz = TURN ? any_dz : same_dz;
localparam signed [63:0] STEEP = STEEPEST;
always @* begin
    assume (axis < 3 && mirror_axis < 3);
    assume (dx >= -STEEP && dx <= STEEP && dy >= -STEEP && dy <= STEEP && dz >= -STEEP && dz <= STEEP);
end

// p is y unless the plane is on y, then x; q is z unless the plane is on z, then x.
wire on_y = axis == 1, on_z = axis == 2;
wire [1:0] p = on_y ? 0 : 1, q = on_z ? 0 : 2;
wire [2:0] back = FOLDED ? any_back : 0;
wire mirror_on_p = FOLDED && mirror_axis == p, mirror_on_q = FOLDED && mirror_axis == q;
wire mirror_on_a = FOLDED && mirror_axis == axis;
wire back_a = back[axis], back_p = back[p], back_q = back[q];
function signed [WIDE-1:0] of_three(input [1:0] which, input signed [WIDE-1:0] first, input signed [WIDE-1:0] second,
                                    input signed [WIDE-1:0] third);
    of_three = which == 0 ? first : which == 1 ? second : third;
endfunction
function signed [SLOPE_BITS:0] of_slope(input [1:0] which, input signed [SLOPE_BITS:0] first,
                                        input signed [SLOPE_BITS:0] second, input signed [SLOPE_BITS:0] third);
    of_slope = which == 0 ? first : which == 1 ? second : third;
endfunction
wire signed [SLOPE_BITS:0] d_a = of_slope(axis, dx, dy, dz), d_p = of_slope(p, dx, dy, dz);
wire signed [SLOPE_BITS:0] d_q = of_slope(q, dx, dy, dz);
wire signed [SLOPE_BITS:0] d_mirror = of_slope(mirror_axis, dx, dy, dz);

// The camera and the mirrored eye; T is the difference.
wire signed [WIDE-1:0] camera_x = {1'b0, x}, camera_y = {1'b0, y}, camera_z = {1'b0, z};
wire signed [WIDE-1:0] eye_x = FOLDED ? mirrored_x : camera_x, eye_y = FOLDED ? mirrored_y : camera_y;
wire signed [WIDE-1:0] eye_z = FOLDED ? mirrored_z : camera_z;
wire signed [WIDE-1:0] t_x = eye_x - camera_x, t_y = eye_y - camera_y, t_z = eye_z - camera_z;
function in_reach(input signed [WIDE-1:0] moved, input signed [WIDE-1:0] place);
    in_reach = moved >= -(1 << SHIFT_BITS - 1) && moved < 1 << SHIFT_BITS - 1 && place >= -LAST * MIRRORS
        && place <= LAST * (MIRRORS + 1);
endfunction
always @* begin
    assume (in_reach(t_x, eye_x) && in_reach(t_y, eye_y) && in_reach(t_z, eye_z));
    if (MIRRORS == 1) begin
        assume (back == 1 << mirror_axis);
        assume ((back[0] || t_x == 0) && (back[1] || t_y == 0) && (back[2] || t_z == 0));
    end
end
wire signed [WIDE-1:0] camera_a = of_three(axis, camera_x, camera_y, camera_z);
wire signed [WIDE-1:0] eye_a = of_three(axis, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] camera_p = of_three(p, camera_x, camera_y, camera_z), eye_p = of_three(p, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] camera_q = of_three(q, camera_x, camera_y, camera_z), eye_q = of_three(q, eye_x, eye_y, eye_z);
wire signed [WIDE-1:0] k = {1'b0, position}, m = {1'b0, mirror};
wire signed [WIDE-1:0] low_0 = {1'b0, u_low}, high_0 = {1'b0, u_high}, low_1 = {1'b0, v_low}, high_1 = {1'b0, v_high};
wire signed [WIDE-1:0] low_p = on_z ? low_1 : low_0, high_p = on_z ? high_1 : high_0;
wire signed [WIDE-1:0] low_q = on_z ? low_0 : low_1, high_q = on_z ? high_0 : high_1;

// Distances from the camera and their products with D, in the design's widths.
wire signed [WIDE-1:0] wide_distance = k - camera_a;
wire signed [DISTANCE_BITS-1:0] distance = wide_distance;
wire signed [SHIFT_BITS-1:0] t_a = eye_a - camera_a;
wire signed [WIDE-1:0] wide_mirror = m - of_three(mirror_axis, camera_x, camera_y, camera_z);
wire signed [DISTANCE_BITS-1:0] mirror_distance = wide_mirror;
wire signed [WALK_BITS-1:0] border = mirror_distance * d_a;
wire signed [2*WALK_BITS-1:0] ways, lows, highs;
wire [2*FOLD_BITS-1:0] offsets;

// The definition: n, and on each of the other two axes whether the hit is within the bounds and beyond the mirror.
wire signed [WIDE-1:0] n = k - eye_a;
wire signed [FOLD_BITS-1:0] narrow_n = n;
wire falls = d_a < 0, runs_back = falls != back_a, ahead = d_a != 0 && n != 0 && (n < 0) == runs_back;
wire [1:0] within, ahead_of_mirror, in_mirror;
localparam signed [63:0] FARTHEST = STEEP * LAST, FARTHEST_SHIFT = STEEP << SHIFT_BITS - 1;
generate
    genvar i;
    for (i = 0; i < 2; i = i + 1) begin: sides
        wire signed [WIDE-1:0] camera = i ? camera_q : camera_p, eye = i ? eye_q : eye_p;
        wire signed [WIDE-1:0] low = i ? low_q : low_p, high = i ? high_q : high_p;
        wire signed [SLOPE_BITS:0] d = i ? d_q : d_p;
        wire turned = i ? back_q : back_p, differ = back_a != turned, clips = i ? mirror_on_q : mirror_on_p;
        wire signed [WIDE-1:0] wide_low = low - camera, wide_high = high - camera, wide_t = eye - camera;
        wire signed [DISTANCE_BITS-1:0] to_low = wide_low, to_high = wide_high;
        wire signed [SHIFT_BITS-1:0] t = wide_t;
        wire signed [WALK_BITS-1:0] way = distance * d, low_way = to_low * d_a, high_way = to_high * d_a;
        wire signed [FOLD_BITS-1:0] moved = t * d_a, moved_way = t_a * d;
        wire signed [SUM-1:0] w_moved = moved, w_moved_way = moved_way, w_way = way, w_low = low_way, w_high = high_way;
        wire signed [SUM-1:0] offset = differ ? w_moved + w_moved_way + 1 : w_moved - w_moved_way, w_border = border;
        assign ways[i*WALK_BITS +: WALK_BITS] = way;
        assign lows[i*WALK_BITS +: WALK_BITS] = low_way;
        assign highs[i*WALK_BITS +: WALK_BITS] = high_way;
        assign offsets[i*FOLD_BITS +: FOLD_BITS] = offset;

        // D[a] (P - E) of the hit P and the camera E, which folded-bounds compares with the products of bounds and
        // mirror. The design computes it as the way, or its complement, plus the offset.
        wire signed [FOLD_BITS-1:0] from_eye = narrow_n * d, narrow_offset = offset;
        wire signed [FOLD_BITS-1:0] folded = (differ ? ~way : way) + narrow_offset;
        wire signed [SUM-1:0] w_from_eye = from_eye, point = differ ? w_moved - w_from_eye : w_moved + w_from_eye;
        wire signed [FOLD_BITS-1:0] narrow_point = differ ? moved - from_eye : moved + from_eye;
        always @* begin
            // product-in-range
            assume (w_way >= -FARTHEST && w_way <= FARTHEST && w_low >= -FARTHEST && w_low <= FARTHEST);
            assume (w_high >= -FARTHEST && w_high <= FARTHEST && w_border >= -FARTHEST && w_border <= FARTHEST);
            assume (moved >= -FARTHEST_SHIFT && moved <= FARTHEST_SHIFT);
            assume (moved_way >= -FARTHEST_SHIFT && moved_way <= FARTHEST_SHIFT);
            if (t == 0) assume (moved == 0);
            if (t_a == 0) assume (moved_way == 0);
            assume (w_way == w_from_eye + w_moved_way);  // next-column
            if (FOLDED) assert (folded == narrow_point && narrow_point == point);
        end
        assign within[i] = falls ? w_high <= point && point <= w_low : w_low <= point && point <= w_high;
        wire down = d < 0 != turned;
        assign in_mirror[i] = clips && point == w_border;
        assign ahead_of_mirror[i] = !clips || (falls != down ? point < w_border : point > w_border);
    end
endgenerate
wire beyond = &ahead_of_mirror && (!mirror_on_a || (runs_back ? k < m : k > m)), at_mirror = |in_mirror;
wire defined = usable && ahead && &within && (beyond || at_mirror && !met[axis]);

// The last mirror was ahead of the eye, and so of its image.
wire signed [WIDE-1:0] from_mirror = m - of_three(mirror_axis, eye_x, eye_y, eye_z);
wire mirror_down = d_mirror < 0 != back[mirror_axis];
always @* if (FOLDED) begin
    assume (d_mirror != 0 && from_mirror != 0 && (from_mirror < 0) == mirror_down);
    if (d_a != 0 && (mirror_on_p && ahead_of_mirror[0] || mirror_on_q && ahead_of_mirror[1] || at_mirror))
        assume (ahead);  // ahead-of-mirror
end

// Cycles in which inputs are read: the fold first, then the ways, the bounds and the slope's magnitudes.
localparam LEAD = FOLDED && STAGED ? 1 : 0, SIGNS_AT = LEAD, BOUNDS_AT = LEAD + 1, SLOPE_AT = LEAD + (STAGED ? 1 : 2);
localparam HIT_AT = LEAD + 3, WAY_AT = FOLDED ? LEAD : 1;
wire [SLOPE_BITS-1:0] size_x = dx < 0 ? -dx : dx, size_y = dy < 0 ? -dy : dy, size_z = dz < 0 ? -dz : dz;
wire [3*SLOPE_BITS-1:0] sizes = {size_z, size_y, size_x};
wire [HIT_AT:0] steps;
wire [3*(HIT_AT+1)-1:0] signs;
wire [2*WALK_BITS*(HIT_AT+1)-1:0] all_ways, all_lows, all_highs;
wire [3*SLOPE_BITS*(HIT_AT+1)-1:0] all_sizes;
wire [(WIDE+SLOPE_BITS+2)*(HIT_AT+1)-1:0] expected;
wire [WIDE-1:0] size_n = n < 0 ? -n : n;
wire [SLOPE_BITS-1:0] e = d_a < 0 ? -d_a : d_a;
delayed #(.BITS(1), .CYCLES(HIT_AT)) step_line (.clk(clk), .now(step), .all(steps));
delayed #(.BITS(3), .CYCLES(HIT_AT)) sign_line (.clk(clk), .now({dx < 0, dy < 0, dz < 0}), .all(signs));
delayed #(.BITS(2*WALK_BITS), .CYCLES(HIT_AT)) way_line (.clk(clk), .now(ways), .all(all_ways));
delayed #(.BITS(2*WALK_BITS), .CYCLES(HIT_AT)) low_line (.clk(clk), .now(lows), .all(all_lows));
delayed #(.BITS(2*WALK_BITS), .CYCLES(HIT_AT)) high_line (.clk(clk), .now(highs), .all(all_highs));
delayed #(.BITS(3*SLOPE_BITS), .CYCLES(HIT_AT)) size_line (.clk(clk), .now(sizes), .all(all_sizes));
delayed #(.BITS(WIDE+SLOPE_BITS+2), .CYCLES(HIT_AT)) hit_line (
    .clk(clk), .now({defined, at_mirror, size_n, e}), .all(expected)
);
reg [HIT_AT:0] age = 1;
always @(posedge clk) age <= {age, 1'b1};

wire signed [WALK_BITS-1:0] way_p = all_ways[2*WALK_BITS*WAY_AT +: WALK_BITS];
wire signed [WALK_BITS-1:0] way_q = TURN ? all_ways[2*WALK_BITS*WAY_AT + WALK_BITS +: WALK_BITS]
    : ways[WALK_BITS +: WALK_BITS];
wire [4*WALK_BITS-1:0] bounds = {
    all_lows[2*WALK_BITS*BOUNDS_AT +: WALK_BITS], all_highs[2*WALK_BITS*BOUNDS_AT +: WALK_BITS],
    all_lows[2*WALK_BITS*BOUNDS_AT + WALK_BITS +: WALK_BITS], all_highs[2*WALK_BITS*BOUNDS_AT + WALK_BITS +: WALK_BITS]
};
wire [3*SLOPE_BITS-1:0] sizes_read = all_sizes[3*SLOPE_BITS*SLOPE_AT +: 3*SLOPE_BITS];

// Words of records, the first field in the highest bits: see `raycaster.rtl.common.records`. Fields of the fold for
// other axes than that of the rectangle are arbitrary.
localparam HIT_BITS = 2 + NUMERATOR_BITS + SLOPE_BITS + (PATTERNS ? 5 : 0) + INDEX_BITS;
localparam WALK_WORD = (TURN ? 6 : 5) * WALK_BITS, FACET_WORD = 3 + DISTANCE_BITS + (TURN ? 0 : WALK_BITS) + LOOK_BITS;
wire [WALK_WORD-1:0] walk = TURN ? {way_p, way_q, bounds} : {way_p, bounds};
wire [FACET_WORD-1:0] facet = TURN ? {usable, axis, distance, look} : {usable, axis, distance, way_q, look};
wire [HIT_BITS-1:0] hit;
wire hit_valid, hit_at_mirror;
wire [NUMERATOR_BITS-1:0] numerator;
wire [SLOPE_BITS-1:0] denominator;
wire [HIT_BITS-3-NUMERATOR_BITS-SLOPE_BITS:0] rest;
assign {hit_valid, hit_at_mirror, numerator, denominator, rest} = hit;
generate
    if (FOLDED) begin: design
        localparam FIELDS = 6 * FOLD_BITS + 3 * WALK_BITS;
        wire [SHIFT_BITS-1:0] shift_x = t_x, shift_y = t_y, shift_z = t_z;
        wire [FIELDS-1:0] fields;
        for (i = 0; i < 9; i = i + 1) begin: parts
            localparam BITS = i < 6 ? FOLD_BITS : WALK_BITS;
            localparam END = FIELDS - (i < 6 ? i * FOLD_BITS : 6 * FOLD_BITS + (i - 6) * WALK_BITS);
            wire [BITS-1:0] value = i < 3 ? offsets[0 +: FOLD_BITS] : i < 6 ? offsets[FOLD_BITS +: FOLD_BITS] : border;
            assign fields[END-1 -: BITS] = axis == i % 3 ? value : any_fold[END-1 -: BITS];
        end
        fold_tester dut (
            .clk(clk), .step_way(steps[LEAD]), .step_bounds(steps[LEAD+1]), .step_slope(steps[LEAD+2]), .index(index),
            .facet_word(facet), .walk_word(walk), .signs_word(signs[3*SIGNS_AT +: 3]),
            .slope_dx(sizes_read[0 +: SLOPE_BITS]), .slope_dy(sizes_read[SLOPE_BITS +: SLOPE_BITS]),
            .slope_dz(sizes_read[2*SLOPE_BITS +: SLOPE_BITS]),
            .fold_word({met[0], met[1], met[2], back[0], back[1], back[2], shift_x, shift_y, shift_z, mirror_down, fields,
                mirror_axis, mirror_distance}),
            .hit_word(hit)
        );
    end
    else begin: design
        ray_tester dut (
            .clk(clk), .step_way(steps[LEAD]), .step_bounds(steps[LEAD+1]), .step_slope(steps[LEAD+2]), .index(index),
            .facet_word(facet), .walk_word(walk), .signs_word(signs[3*SIGNS_AT +: 3]),
            .slope_dx(sizes_read[0 +: SLOPE_BITS]), .slope_dy(sizes_read[SLOPE_BITS +: SLOPE_BITS]),
            .slope_dz(sizes_read[2*SLOPE_BITS +: SLOPE_BITS]), .hit_word(hit)
        );
    end
endgenerate

wire expected_hit, expected_at_mirror;
wire [WIDE-1:0] expected_n;
wire [SLOPE_BITS-1:0] expected_e;
assign {expected_hit, expected_at_mirror, expected_n, expected_e}
    = expected[(WIDE+SLOPE_BITS+2)*HIT_AT +: WIDE+SLOPE_BITS+2];
always @* if (age[HIT_AT] && steps[HIT_AT]) begin
    assert (hit_valid == expected_hit);
    if (hit_valid) assert (hit_at_mirror == expected_at_mirror && numerator == expected_n && denominator == expected_e);
    if (hit_valid) assert (rest == (PATTERNS ? {axis, look[26:24], index} : index));
end
localparam signed [63:0] HALF = 64'd1 << FOLD_BITS - 1;
always @* assert (FARTHEST < 64'sd1 << WALK_BITS - 1);
always @* assert (!FOLDED || FARTHEST + FARTHEST_SHIFT * (MIRRORS > 1 ? 2 : 1) < HALF);

always @* cover (age[HIT_AT] && steps[HIT_AT] && hit_valid && (!FOLDED || hit_at_mirror));
always @* cover (age[HIT_AT] && steps[HIT_AT] && hit_valid && !hit_at_mirror);
endmodule

// A value in this cycle, in the lowest bits, and in the previous cycles.
module delayed #(parameter BITS = 1, parameter CYCLES = 3) (
    input clk, input [BITS-1:0] now, output [BITS*(CYCLES+1)-1:0] all
);
reg [BITS*CYCLES-1:0] before;
assign all = {before, now};
always @(posedge clk) before <= all;
endmodule
