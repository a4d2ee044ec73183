// SPDX-License-Identifier: MIT
// A ray, a rectangle and the last mirror at the inputs of rect_tester, and the result three cycles later, for
// tester_exact and tester_products. They define `distance`, that of the mirror; `defined`, which is true if the
// rectangle is hit; and `in_mirror`, true in the mirror's plane. Numbers of WIDE bits are wide enough for any value.
//
// Assumed, as the engine guarantees: an axis of 0, 1 or 2, and an eye no further away than REFLECTIONS mirrors can move
// it. The ray, the rectangle and the mirror may change in every cycle.
rect_tester dut (.*);

(* anyseq *) reg mirrored;
(* anyseq *) reg [1:0] mirror_axis;
(* anyseq *) reg [2:0] met;  // x in the lowest bit
reg [EYE_BITS-2:0] distance_1;
always @(posedge clk) distance_1 <= distance;  // read one cycle after all other inputs
assign mirror_word = {mirrored, mirror_axis, distance_1, met[0], met[1], met[2]} >> (REFLECTIONS > 1 ? 0 : 3);

localparam LAST = (1 << COORDINATE_BITS) - 1;
function in_reach(input signed [WIDE-1:0] place);
    in_reach = place >= -LAST * REFLECTIONS && place <= LAST * (REFLECTIONS + 1);
endfunction
wire [1:0] axis = rect_axis;
always @* begin
    assume (axis < 3 && mirror_axis < 3);
    assume (in_reach(eye_x) && in_reach(eye_y) && in_reach(eye_z));
    if (mirrored && REFLECTIONS < 2) assume (met == 1 << mirror_axis);
end

// The axes from the rectangle's point of view, and the distance of its plane in the ray's direction.
wire signed [WIDE-1:0] eye_a = axis == 0 ? eye_x : axis == 1 ? eye_y : eye_z;
wire signed [WIDE-1:0] eye_u = axis == 0 ? eye_y : eye_x, eye_v = axis == 2 ? eye_y : eye_z;
wire [SLOPE_BITS-1:0] e = axis == 0 ? slope_dx : axis == 1 ? slope_dy : slope_dz;
wire [SLOPE_BITS-1:0] slope_u = axis == 0 ? slope_dy : slope_dx, slope_v = axis == 2 ? slope_dy : slope_dz;
wire back = axis == 0 ? signs_dx : axis == 1 ? signs_dy : signs_dz;
wire back_u = axis == 0 ? signs_dy : signs_dx, back_v = axis == 2 ? signs_dy : signs_dz;
wire on_a = mirrored && mirror_axis == axis;
wire on_u = mirrored && mirror_axis == (axis == 0 ? 1 : 0);
wire on_v = mirrored && mirror_axis == (axis == 2 ? 1 : 2);
wire signed [WIDE-1:0] plane = {1'b0, rect_position}, low_u = {1'b0, rect_u_low}, high_u = {1'b0, rect_u_high};
wire signed [WIDE-1:0] low_v = {1'b0, rect_v_low}, high_v = {1'b0, rect_v_high};
wire signed [WIDE-1:0] n = back ? eye_a - plane : plane - eye_a;
wire ahead = e != 0 && n > 0;

// The result.
reg [2:0] valid = 3'b000, hits, in_mirrors;
always @(posedge clk) begin
    valid <= {valid, steps_find_intersection};
    hits <= {hits, defined};
    in_mirrors <= {in_mirrors, in_mirror};
end
always @* if (valid[2]) begin
    assert (hit == hits[2]);
    if (hit) assert (numerator == $past(n, 3) && denominator == $past(e, 3) && at_mirror == in_mirrors[2]);
end

always @* cover (valid[2] && hit);
generate
    if (REFLECTIONS > 1) begin: corners
        always @* cover (valid[2] && hit && at_mirror);
    end
endgenerate
