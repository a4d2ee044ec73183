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
// parameters = { BASIS_BITS = "CAMERA_BITS - 3 * COORDINATE_BITS" }
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

module eye_exact #(
    parameter COORDINATE_BITS = 9, parameter LOOK_BITS = 24, parameter BASIS_BITS = 0, parameter EYE_BITS = 11,
    parameter REFLECTIONS = 1
) (
    input clk, input load, input store, input [COORDINATE_BITS-1:0] camera_x, input [COORDINATE_BITS-1:0] camera_y,
    input [COORDINATE_BITS-1:0] camera_z, input [BASIS_BITS:0] basis, input [2:0] negative, input [1:0] axis,
    input [COORDINATE_BITS-1:0] position, input [LOOK_BITS-1:0] look, input [EYE_BITS-2:0] distance, input corner
);
localparam LAST = (1 << COORDINATE_BITS) - 1, WIDE = EYE_BITS + 3;

wire signed [EYE_BITS-1:0] x, y, z;
wire [2:0] signs, met;
wire active;
wire [1:0] mirror_axis;
wire [EYE_BITS-2:0] mirror;
wire [3 * COORDINATE_BITS + BASIS_BITS:0] camera = {camera_x, camera_y, camera_z, basis};
generate
    if (REFLECTIONS > 1) begin: design
        eye_register dut (
            .clk(clk), .found_distance(distance), .found_at_mirror(corner), .steps_screen_to_ray(load),
            .steps_store_ray(store), .camera_word(camera[3 * COORDINATE_BITS + BASIS_BITS:1]),
            .initial_signs_word(negative), .found_surface_word({axis, position, look}), .eye_x(x), .eye_y(y), .eye_z(z),
            .signs_word(signs), .mirror_word({active, mirror_axis, mirror, met})
        );
    end
    else begin: design
        eye_register dut (
            .clk(clk), .found_distance(distance), .steps_screen_to_ray(load), .steps_store_ray(store),
            .camera_word(camera[3 * COORDINATE_BITS + BASIS_BITS:1]), .initial_signs_word(negative),
            .found_surface_word({axis, position, look}), .eye_x(x), .eye_y(y), .eye_z(z), .signs_word(signs),
            .mirror_word({active, mirror_axis, mirror})
        );
        assign met = 1 << (2 - mirror_axis);
    end
endgenerate
always @* assume (axis < 3);

// The definition. As in the design, x is the highest bit of three.
reg loaded = 1'b0;
reg [2:0] mirrors;
reg signed [WIDE-1:0] eye_x, eye_y, eye_z;
reg [2:0] turned, met_there;
reg [1:0] last_axis;
reg [EYE_BITS-2:0] last_distance;
wire [2:0] bit_of_axis = axis == 0 ? 3'b100 : axis == 1 ? 3'b010 : 3'b001;
wire signed [WIDE-1:0] plane = {1'b0, position};
always @(posedge clk) begin
    if (load) begin
        loaded <= 1'b1;
        mirrors <= 0;
        eye_x <= {1'b0, camera_x};
        eye_y <= {1'b0, camera_y};
        eye_z <= {1'b0, camera_z};
        turned <= 0;
        met_there <= 0;
    end
    else if (store) begin
        if (mirrors <= REFLECTIONS) mirrors <= mirrors + 1;
        if (axis == 0) eye_x <= 2 * plane - eye_x;
        if (axis == 1) eye_y <= 2 * plane - eye_y;
        if (axis == 2) eye_z <= 2 * plane - eye_z;
        turned <= turned ^ bit_of_axis;
        met_there <= REFLECTIONS > 1 && corner ? met_there | bit_of_axis : bit_of_axis;
        last_axis <= axis;
        last_distance <= distance;
    end
end

function in_reach(input signed [WIDE-1:0] place, input [2:0] count);
    in_reach = place >= -$signed({1'b0, LAST * count}) && place <= $signed({1'b0, LAST * (count + 1)});
endfunction
always @* if (loaded && mirrors <= REFLECTIONS) begin
    assert (in_reach(eye_x, mirrors) && in_reach(eye_y, mirrors) && in_reach(eye_z, mirrors));
    assert (x == eye_x && y == eye_y && z == eye_z);
    assert (signs == (negative ^ turned));
    assert (active == (mirrors != 0));
    if (REFLECTIONS > 1 || mirrors != 0) assert (met == met_there);
    if (mirrors != 0) assert (mirror_axis == last_axis && mirror == last_distance && met_there[2 - last_axis]);
    if (mirrors != 0) assert (last_axis < 3);
end

always @* cover (loaded && mirrors == REFLECTIONS && (REFLECTIONS == 0 || x > LAST));
generate
    if (REFLECTIONS > 1) begin: corners
        always @* cover (loaded && mirrors == REFLECTIONS && (met & (met - 1)));
    end
endgenerate
endmodule
