// SPDX-License-Identifier: MIT
// The place of a point that a quotient defines, for tester_exact and fold_exact: P is base + more, or base - more,
// with 0 <= more < 1.
function within(input signed [WIDE-1:0] base, input more, input negative, input signed [WIDE-1:0] low,
                input signed [WIDE-1:0] high);
    if (negative) within = (more ? base > low : base >= low) && base <= high;
    else within = base >= low && (more ? base < high : base <= high);
endfunction
function beyond(input signed [WIDE-1:0] base, input more, input negative, input signed [WIDE-1:0] place);
    beyond = negative ? base < place || base == place && more : base > place || base == place && more;
endfunction
