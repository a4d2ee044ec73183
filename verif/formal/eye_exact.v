// SPDX-License-Identifier: MIT
// The mirrored eye at the engine's own widths: it is at the camera, and after each mirror at 2 k - E on the mirror's
// axis, computed without overflow. Also which components of the slope have turned around, and the mirror left last.
//
// Assumed, as the control guarantees: a ray is loaded before it is reflected; an axis is 0, 1 or 2. Mirrors beyond the
// last reflection are don't care. All other inputs may change in every cycle.
//
// [proof]
// claim = "the eye is the camera mirrored in each plane, in range, with the right signs and corner, at full width"
// modules = ["eye_register"]
// induction = 1
// reach = 6
// quick = ["exact one-unit turn materials patterns reflections=4"]
// designs = [
//   "exact one-unit turn=0,1 reflections=0,1,2,3,4", "exact one-unit turn materials patterns reflections=0,1,2,3,4",
// ]
// [faults]
// "exact-vga240-u1-r12-m4-c8-turn-materials-patterns" = ["eye_register.twice halved",
//   "eye_register.image signed-short", "eye_register.difference negated", "eye_register.found_at_mirror 0",
//   "eye_register.flipped_y 1"]

module eye_exact;
localparam LAST = (1 << COORDINATE_BITS) - 1, WIDE = EYE_BITS + 3;

eye_register dut (.*);
wire [1:0] axis = found_surface_axis;
wire [2:0] met, bit_of_last = 3'b100 >> mirror_axis;
wire corner;
always @* assume (axis < 3);

// The definition. As in the design, x is the highest bit of three.
reg loaded = 1'b0;
reg [2:0] mirrors;
reg signed [WIDE-1:0] x, y, z;
reg [2:0] turned, met_there;
reg [1:0] last_axis;
reg [EYE_BITS-2:0] last_distance;
wire [2:0] bit_of_axis = 3'b100 >> axis;
wire signed [WIDE-1:0] plane = {1'b0, found_surface_position};
always @(posedge clk) begin
    if (steps_screen_to_ray) begin
        loaded <= 1'b1;
        {mirrors, turned, met_there} <= 0;
        x <= {1'b0, camera_x};
        y <= {1'b0, camera_y};
        z <= {1'b0, camera_z};
    end
    else if (steps_store_ray) begin
        if (mirrors <= REFLECTIONS) mirrors <= mirrors + 1;
        if (axis == 0) x <= 2 * plane - x;
        if (axis == 1) y <= 2 * plane - y;
        if (axis == 2) z <= 2 * plane - z;
        turned <= turned ^ bit_of_axis;
        met_there <= corner ? met_there | bit_of_axis : bit_of_axis;
        {last_axis, last_distance} <= {axis, found_distance};
    end
end

function in_reach(input signed [WIDE-1:0] place, input [2:0] count);
    in_reach = place >= -$signed({1'b0, LAST * count}) && place <= $signed({1'b0, LAST * (count + 1)});
endfunction
always @* if (loaded && mirrors <= REFLECTIONS) begin
    assert (in_reach(x, mirrors) && in_reach(y, mirrors) && in_reach(z, mirrors));
    assert (eye_x == x && eye_y == y && eye_z == z);
    assert (signs_word == (initial_signs_word ^ turned));
    assert (mirror_active == (mirrors != 0));
    if (REFLECTIONS > 1 || mirrors != 0) assert (met == met_there);
    if (mirrors != 0) begin
        assert (mirror_axis == last_axis && mirror_distance == last_distance && met_there[2 - last_axis]);
        assert (last_axis < 3);
    end
end

always @* cover (loaded && mirrors == REFLECTIONS && (REFLECTIONS == 0 || eye_x > LAST));
generate
    if (REFLECTIONS > 1) begin: corners
        assign {met, corner} = {mirror_met_x, mirror_met_y, mirror_met_z, found_at_mirror};
        always @* cover (loaded && mirrors == REFLECTIONS && (met & (met - 1)));
    end
    else begin: corners
        assign {met, corner} = {bit_of_last, 1'b0};
    end
endgenerate
endmodule
