// SPDX-License-Identifier: MIT
// Clocks a design for some frames and prints how long one took, in seconds, and how often what it shows changed in the last.

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "Vdut.h"
#include "verilated.h"

// What starts it after reset, and what ends that: of a design that waits for a write.
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
    // A bus may make the write wait, and more of the same do no harm.
    BEGIN;
    clocks(32, &changes);
    BEGUN;
    // What is loaded or filled at the start is not a frame's.
    clocks(2 * frame, &changes);
    const auto start = std::chrono::steady_clock::now();
    for (long i = 0; i < frames; i++) {
        changes = 0;
        clocks(frame, &changes);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::printf("%.6f %ld\n", took.count() / frames, changes);
}
