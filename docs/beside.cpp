// SPDX-License-Identifier: MIT
// Clock a design for some frames. Print the mean seconds per frame, and how often the output changed in the last frame.

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "Vdut.h"
#include "verilated.h"

// A design that waits for a write to start has statements that begin and end this write after reset.
#ifndef BEGIN
#define BEGIN (void)0
#define BEGUN (void)0
#endif

static Vdut dut;

static void clocks(long count, long* changes) {
    auto before = dut.SHOWN;
    for (long i = 0; i < count; i++) {
        dut.CLOCK = 0;
        dut.eval();
        dut.CLOCK = 1;
        dut.eval();
        *changes += dut.SHOWN != before;
        before = dut.SHOWN;
    }
}

int main(int, char** arguments) {
    const long frame = std::atol(arguments[1]), frames = std::atol(arguments[2]);
    long changes = 0;
    dut.RESET = IN_RESET;
    clocks(32, &changes);
    dut.RESET = !IN_RESET;
    // The bus may stall the write, so it lasts some cycles; repeated writes do no harm.
    BEGIN;
    clocks(32, &changes);
    BEGUN;
    // Leave loading and filling at the start out of the measured time.
    clocks(2 * frame, &changes);
    const auto start = std::chrono::steady_clock::now();
    for (long i = 0; i < frames; i++) {
        changes = 0;
        clocks(frame, &changes);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::printf("%.6f %ld\n", took.count() / frames, changes);
}
