// SPDX-License-Identifier: MIT
// Streams operands through an a + b * (c - d) / e unit, one vector every STEPS cycles, and checks every result.
// Arguments: the number of vectors (0 for every combination of operands), and the seed.
#include "common.h"

namespace {

struct Vector {
    uint32_t a, b, c, d, e;
    bool b_negative, e_negative;
};

uint64_t state;

// splitmix64
uint64_t random_bits() {
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

uint64_t below(uint64_t limit) { return random_bits() % limit; }

uint32_t position() {
    static const uint32_t corners[] = {0, 1, 2, 255, 256, 510, 511};
    const uint32_t fraction = (1u << FRACTION_BITS) - 1;
    if (below(8) >= 3) return below(POSITION_LIMIT);
    return (corners[below(7)] << FRACTION_BITS | (below(2) ? fraction : 0)) & (POSITION_LIMIT - 1);
}

uint32_t slope() {
    static const uint32_t corners[] = {0, 1, 2, 99, 100, 160, 190, 255, 256, 510, 511};
    return (below(8) < 3 ? corners[below(11)] : below(SLOPE_LIMIT)) & (SLOPE_LIMIT - 1);
}

Vector random_vector() {
    Vector v{position(), slope(), position(), position(), slope(), below(2) != 0, below(2) != 0};
    if (below(4) == 0 && v.b != 0) {
        // A distance that puts the quotient next to 0, 1 or the first value that overflows.
        const uint64_t targets[] = {0, 1, POSITION_LIMIT - 1, POSITION_LIMIT};
        const uint64_t distance = (targets[below(4)] * v.e + below(2) * (v.e / 2)) / v.b + below(3);
        if (distance > 0 && distance <= POSITION_LIMIT) {
            const uint64_t near = distance - 1;
            v.d = below(POSITION_LIMIT - near);
            v.c = v.d + near;
            if (v.e_negative) {
                const uint32_t swapped = v.c;
                v.c = v.d;
                v.d = swapped;
            }
        }
    }
    return v;
}

// The operands are the digits of the vector's number.
Vector numbered_vector(uint64_t number) {
    Vector v;
    auto take = [&number](uint64_t limit) {
        const uint64_t digit = number % limit;
        number /= limit;
        return static_cast<uint32_t>(digit);
    };
    v.a = take(POSITION_LIMIT);
    v.c = take(POSITION_LIMIT);
    v.d = take(POSITION_LIMIT);
    v.b = take(SLOPE_LIMIT);
    v.e = take(SLOPE_LIMIT);
    v.b_negative = take(2);
    v.e_negative = take(2);
    return v;
}

struct Expected {
    bool valid;
    uint32_t distance;
    uint64_t quotient;
    int64_t value;
};

Expected expect(const Vector& v) {
    const int64_t n = int64_t{v.c} - int64_t{v.d};
    const uint64_t distance = n < 0 ? -n : n;
    const Quotient quotient = divide(v.b * distance, v.e);
    const bool ahead = v.e != 0 && n != 0 && (n < 0) == v.e_negative;
    const int64_t offset = v.b_negative ? -int64_t(quotient.value) : int64_t(quotient.value);
    return {ahead && !quotient.overflow, uint32_t(distance), quotient.value, v.a + offset};
}

uint64_t wrong = 0;

// Counts wrong results, and reports the first.
void mismatch(const char* what, const Vector& v, const Expected& expected, int64_t hardware) {
    if (wrong++ > 0) return;
    std::printf("mismatch in %s: a %u, b %s%u, c %u, d %u, e %s%u: hardware %lld, expected valid %d, distance %u, "
                "quotient %llu, value %lld\n",
                what, v.a, v.b_negative ? "-" : "", v.b, v.c, v.d, v.e_negative ? "-" : "", v.e,
                static_cast<long long>(hardware), expected.valid, expected.distance,
                static_cast<unsigned long long>(expected.quotient), static_cast<long long>(expected.value));
}

}  // namespace

int main(int, char** argv) {
    const uint64_t given = argument(argv[1]);
    const uint64_t every = POSITION_LIMIT * POSITION_LIMIT * POSITION_LIMIT * SLOPE_LIMIT * SLOPE_LIMIT * 4;
    const uint64_t count = given ? given : every;
    state = argument(argv[2]);

    Vdut dut;
    dut.clk = 0;
    uint64_t valid = 0;
    // A vector's value is valid within the next two vectors, or the next three if a division takes two cycles.
    Vector ring[8];
    Expected wanted[8];
    const uint32_t position_mask = POSITION_LIMIT - 1, slope_mask = SLOPE_LIMIT - 1;
    for (uint64_t number = 0; number < count + 4; number++) {
        Vector v = given ? random_vector() : numbered_vector(number % every);
        ring[number % 8] = v;
        wanted[number % 8] = expect(v);
        for (int phase = 0; phase < STEPS; phase++) {
            const uint64_t cycle = number * STEPS + phase;
            dut.steps_find_intersection = phase == 0;
            // Load 2 cycles after the start, store STEPS later, stored results and `a` 1 later, value 1 later.
            dut.steps_load_divider = dut.steps_store_quotient = phase == 2 % STEPS;
            const uint64_t stored = (cycle - STEPS - 3) / STEPS % 8, added = (cycle - STEPS - 4) / STEPS % 8;
            const bool check_stored = phase == 3 % STEPS && cycle >= STEPS + 3;
            const bool check_added = phase == 4 % STEPS && cycle >= STEPS + 4;
            // Operands are wrong outside their cycle, so that reading them too early or too late is noticed.
            const uint32_t flip = phase == 0 ? 0 : ~0u;
            dut.b = (v.b ^ flip) & slope_mask;
            dut.c = (v.c ^ flip) & position_mask;
            dut.d = (v.d ^ flip) & position_mask;
            dut.e = (v.e ^ flip) & slope_mask;
            dut.b_negative = v.b_negative ^ (phase != 0);
            dut.e_negative = v.e_negative ^ (phase != 0);
            dut.a = check_stored ? ring[stored].a : ~dut.a & position_mask;
            dut.eval();
            if (check_stored) {
                const Expected& expected = wanted[stored];
                if (dut.valid != expected.valid) mismatch("valid", ring[stored], expected, dut.valid);
                if (expected.valid && dut.quotient != expected.quotient)
                    mismatch("quotient", ring[stored], expected, dut.quotient);
                if (expected.valid && dut.distance != expected.distance)
                    mismatch("distance", ring[stored], expected, dut.distance);
            }
            if (check_added && wanted[added].valid) {
                const uint32_t sign = 1u << (POSITION_BITS + 1);
                const int64_t value = int64_t(dut.value ^ sign) - sign;
                if (value != wanted[added].value) mismatch("value", ring[added], wanted[added], value);
            }
            if (check_added && (cycle - STEPS - 4) / STEPS < count) {
                valid += wanted[added].valid;
            }
            clock(dut);
        }
    }
    finish(count, valid, wrong);
}
