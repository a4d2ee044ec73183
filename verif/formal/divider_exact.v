// SPDX-License-Identifier: MIT
// The divider: quotient * divisor + remainder = dividend with remainder < divisor, rounded as configured, or overflow.
//
// Assumed, as the control guarantees: store_quotient comes STEPS cycles after load_divider and at no other time, and
// the next load_divider no earlier. The operands are arbitrary, including those that overflow.
//
// A product of two variables is hard for a solver. So in the second part multiplication is any function with one known
// property: appending digits to a number shifts its product and adds that of the digits (`digits-appended`). As a
// division delivers its digits in this way, the proof by induction needs only additions.
//
// [proof]
// claim = "quotient * divisor + remainder = dividend, rounded as configured, or overflow"
// modules = ["divider", "divider_step"]
// any_product = "PART == 1"
// parameters = { WIDTH = "POSITION_BITS", BITS = "DIVIDER_BITS", STEPS = "DIVIDER_STEPS" }
// induction = 1
// label = "{DESIGN} {('digits', 'product', 'result')[PART]}"
// designs = [
//   "tiny two divider_bits=3,2,1 rounding=truncate,nearest PART=0,1,2",
//   "tiny two fraction_bits=1 divider_bits=3 rounding=nearest PART=0,1,2",
//   "tiny two fraction_bits=4 divider_bits=3 PART=0,1,2",
//   "tiny two fraction_bits=8 divider_bits=2,1 rounding=nearest PART=0,1,2",
// ]
// [faults]
// "tiny48-u2-r2-m1-f0t-d3-c8 digits" = ["divider_step.difference edge", "divider.too_large 0"]
// "tiny48-u2-r2-m1-f0t-d1-c8 product" = ["divider.load_divider 0", "divider_step.next_digits halved",
//   "divider_step.next_digits[1] 0"]

module divider_exact;
localparam DIGITS = BITS * STEPS, EXTRA = DIGITS - WIDTH, PRODUCT = DIGITS + 10;

divider dut (.*);

reg busy = 0, stored = 0;
reg [4:0] step;
reg [WIDTH+8:0] held_dividend, result_dividend;
reg [8:0] held_divisor, result_divisor;
always @(posedge clk) begin
    if (load_divider) begin
        {busy, step} <= {1'b1, 5'd0};
        {held_dividend, held_divisor} <= {dividend, divisor};
    end
    else begin
        if (store_quotient) busy <= 0;
        step <= step + 1;
    end
    if (store_quotient) {stored, result_dividend, result_divisor} <= {1'b1, held_dividend, held_divisor};
end
always @* begin
    assume (store_quotient == (busy && step == STEPS - 1));
    if (load_divider) assume (!busy || step == STEPS - 1);
end

// product times 2 ** BITS, plus BITS digits times the divisor.
function [PRODUCT-1:0] append(input [PRODUCT-1:0] product, input [BITS-1:0] digits, input [8:0] by);
    integer i;
    begin
        append = product;
        for (i = BITS - 1; i >= 0; i = i - 1) append = (append << 1) + (digits[i] ? by : 0);
    end
endfunction

function [PRODUCT-1:0] times(input [DIGITS-1:0] number, input [8:0] by);
    times = number * by;
endfunction

// The result is valid from the cycle after store_quotient. `down` is the quotient rounded down.
reg [WIDTH-1:0] down;
always @(posedge clk) if (store_quotient) down <= dut.last_pending;
reg [PRODUCT-1:0] result_product;  // before the last step
wire [PRODUCT-1:0] last_step = append(result_product, down[BITS-1:0], result_divisor);
wire [PRODUCT-1:0] multiple = times(down, result_divisor);
// The second part proves that these two are equal where the result counts; the third part uses the simpler one.
wire [PRODUCT-1:0] below = PART == 2 ? last_step : multiple;
wire [PRODUCT-1:0] left = result_dividend - below;
wire round_up = NEAREST && 2 * left >= result_divisor;
wire too_large = result_dividend >> WIDTH >= result_divisor;  // also for a divisor of 0
wire [WIDTH:0] rounded = down + round_up;
always @* if (stored && PART == 2) begin
    if (too_large) assert (overflow);
    else begin
        assert (below <= result_dividend && left < result_divisor);
        assert (quotient == rounded[WIDTH-1:0]);
        assert (overflow == rounded[WIDTH]);
    end
end

// Invariants for each step and for the result, in parts that are proved in order, each on the basis of the previous
// ones: product + remainder are the dividend's top digits; the product is the divisor times the quotient's digits so
// far. The third part is the claim.
reg [8:0] result_remainder;
wire [PRODUCT-1:0] product = step == 0 ? 0 : append($past(product), dut.pending[BITS-1:0], held_divisor);
wire fits = held_dividend >> WIDTH < held_divisor;
always @(posedge clk) if (store_quotient) {result_product, result_remainder} <= {product, dut.last_remainder};
always @* if (busy) begin
    assert (step < STEPS);
    assert (dut.divisor_held == held_divisor);
    assert (dut.too_large == !fits);
end

genvar k;
generate
    for (k = 0; k < STEPS; k = k + 1) begin: after
        wire [DIGITS-1:0] digits = dut.pending & ((1 << BITS * k) - 1);
        wire [DIGITS-1:0] rest = held_dividend << BITS * k;
        wire [WIDTH+8:0] top = held_dividend >> (DIGITS - BITS * k);
        wire short = !fits || k == 0 || digits >> (BITS * k - EXTRA) == 0;
        wire divided = dut.pending == (rest | digits) && (!fits || (
            product + dut.remainder == top && product <= top && dut.remainder < held_divisor));
        always @* if (busy && step == k) begin
            if (PART == 0) assert (divided && short);
            if (PART == 1) assume (short);
        end
    end
endgenerate

// The quotient's digits so far.
wire [DIGITS-1:0] so_far = dut.pending & ((1 << BITS * step) - 1);
wire [PRODUCT-1:0] so_far_multiple = times(so_far, held_divisor);
always @* if (PART == 1) begin
    assume (so_far_multiple == append(times(so_far >> BITS, held_divisor), so_far[BITS-1:0], held_divisor));
    assume (multiple == append(times(down >> BITS, result_divisor), down[BITS-1:0], result_divisor));
    if (so_far == 0) assume (so_far_multiple == 0);
    if (busy) assert (product == so_far_multiple);
end

wire result_divided = last_step + result_remainder == result_dividend && last_step <= result_dividend
    && result_remainder < result_divisor;
wire result_multiplied = last_step == multiple;
wire result_round_up = NEAREST && 2 * result_remainder >= result_divisor;
wire [WIDTH:0] result_rounded = down + result_round_up;
wire result_stored = too_large ? overflow : {overflow, quotient} == result_rounded;
always @* if (stored) begin
    if (PART == 0) assert (result_stored && (too_large || result_divided));
    if (PART == 1) assert (too_large || result_multiplied);
    if (PART == 2) assume (result_stored && (too_large || result_divided));
end
endmodule
