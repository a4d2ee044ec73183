// SPDX-License-Identifier: MIT
// Divides each product of a slope and a distance by each divisor, back to back, and checks every quotient.
// Arguments: the number of divisions (0 for all), and the seed that chooses them if they are not all.
#include <algorithm>
#include <vector>

#include "common.h"

int main(int, char** argv) {
    std::vector<uint32_t> dividends;
    for (uint32_t slope = 0; slope < SLOPE_LIMIT; slope++)
        for (uint32_t distance = 0; distance < POSITION_LIMIT; distance++) dividends.push_back(slope * distance);
    std::sort(dividends.begin(), dividends.end());
    dividends.erase(std::unique(dividends.begin(), dividends.end()), dividends.end());

    const uint64_t pairs = dividends.size() * SLOPE_LIMIT;
    uint64_t count = argument(argv[1]);
    // A large prime that does not divide the number of pairs: a subset is spread over all of them, without repetition.
    uint64_t stride = 2147483647, start = argument(argv[2]) * 0x9e3779b97f4a7c15u % pairs;
    if (count == 0 || count >= pairs) {
        count = pairs;
        stride = 1;
        start = 0;
    }

    Vdut dut;
    dut.clk = 0;
    uint64_t valid = 0, wrong = 0, index = start;
    uint32_t dividend = 0, divisor = 0;
    for (uint64_t number = 0; number <= count; number++) {
        const uint32_t dividend_before = dividend, divisor_before = divisor;
        dividend = dividends[index / SLOPE_LIMIT];
        divisor = index % SLOPE_LIMIT;
        index = (index + stride) % pairs;
        // A division is loaded while the previous one is stored, whose quotient is valid from the next cycle.
        for (int step = 0; step < STEPS; step++) {
            dut.load_divider = step == 0;
            dut.store_quotient = step == 0;
            // The operands are valid in the cycle of the load only.
            dut.dividend = step == 0 ? dividend : ~dividend & ((1u << (POSITION_BITS + SLOPE_BITS)) - 1);
            dut.divisor = step == 0 ? divisor : ~divisor & (SLOPE_LIMIT - 1);
            dut.eval();
            if (step == 1 && number > 0) {
                const Quotient expected = divide(dividend_before, divisor_before);
                if (dut.overflow != expected.overflow || (!expected.overflow && dut.quotient != expected.value)) {
                    if (wrong++ == 0)
                        std::printf("mismatch %u / %u: hardware %u overflow %u, expected %llu overflow %u\n",
                                    dividend_before, divisor_before, unsigned(dut.quotient), unsigned(dut.overflow),
                                    static_cast<unsigned long long>(expected.value), unsigned(expected.overflow));
                }
                valid += !expected.overflow;
            }
            clock(dut);
        }
    }
    finish(count, valid, wrong);
}
