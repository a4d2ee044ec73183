// SPDX-License-Identifier: MIT
// Shared by the exhaustive benches: the reference division, the clock, and the output for run.py, which
// compiles them with POSITION_BITS, SLOPE_BITS, FRACTION_BITS, STEPS (cycles of a division) and NEAREST (rounding).
#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "Vdut.h"

constexpr uint64_t POSITION_LIMIT = uint64_t{1} << POSITION_BITS;
constexpr uint64_t SLOPE_LIMIT = uint64_t{1} << SLOPE_BITS;

struct Quotient {
    uint64_t value;
    bool overflow;
};

// The definition, in 64 bits, without overflow or iteration.
inline Quotient divide(uint64_t dividend, uint64_t divisor) {
    if (divisor == 0) return {0, true};
    const uint64_t value = NEAREST ? (2 * dividend + divisor) / (2 * divisor) : dividend / divisor;
    return {value, value >= POSITION_LIMIT};
}

inline void clock(Vdut& dut) {
    dut.clk = 1;
    dut.eval();
    dut.clk = 0;
}

[[noreturn]] inline void finish(uint64_t vectors, uint64_t valid, uint64_t wrong) {
    std::printf("done %llu %llu %llu\n", static_cast<unsigned long long>(vectors),
                static_cast<unsigned long long>(valid), static_cast<unsigned long long>(wrong));
    std::exit(wrong > 0);
}

inline uint64_t argument(char* text) { return std::strtoull(text, nullptr, 10); }
