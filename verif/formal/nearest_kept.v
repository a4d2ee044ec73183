// SPDX-License-Identifier: MIT
// A register of the nearest hit, for nearest_depth and nearest_products: of all hits offered since the last reset, the
// nearest is kept with all its fields, or the first one of a tie. They define the hit at the inputs, `now`, and the one
// in the register, `kept`, both with HIT_BITS; and `nearer`, which is true if `now` is offered and replaces it.
//
// Assumed, as the control guarantees: nothing is offered in the cycle of a reset. All other inputs may change in every
// cycle.
wire reset = steps_reset_z_buf, offered = steps_write_z_buf && hit;
always @* assume (!(reset && steps_write_z_buf));

// The picked hit is an arbitrary one of these hits, so what is asserted for it holds for all. The kept hit came before
// it, came after it, or is the same.
(* anyseq *) reg pick;
reg ready = 1'b0, running = 1'b0, picked = 1'b0, before, same;
reg [HIT_BITS-1:0] picked_hit, kept_hit;
wire later = !before && !same;
always @(posedge clk) begin
    ready <= ready || reset;  // from the first reset on
    running <= ready;
    if (nearer) kept_hit <= now;
    if (reset) picked <= 1'b0;
    else if (offered && pick && !picked && ready) {picked, picked_hit, same, before} <= {1'b1, now, nearer, !nearer};
    else if (nearer) {same, before} <= 2'b00;
end
always @* begin
    if (running) assert (found == (!$past(reset) && ($past(found) || $past(offered))));
    if (ready && found) assert (kept == kept_hit);
    if (picked) assert (ready && found && !(same && before));
    if (picked && same) assert (kept == picked_hit);
end

always @* cover (picked && before);
always @* cover (picked && same);
always @* cover (picked && later);
