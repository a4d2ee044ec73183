// SPDX-License-Identifier: MIT
// A machine whose loop reads runs; see drawing.v.
//
// COLOUR_BITS: bits per channel of a run's colour.

#ifndef DRAWING_H
#define DRAWING_H

#include <cstdint>
#include <vector>

#include "Vmachine.h"

#define CLOCKS_PER_BIT 0 // of a serial port: none

// A StartScreen or a write.
struct Event {
    uint32_t clock, start_screen, takes_scene, again, written, address, writedata, byteenable;
};

class Machine {
public:
    std::vector<Event> events;
    std::vector<uint32_t> runs; // of the last frame; for each its row in the upper half above its end, and its colour
    uint32_t working = 0;       // clocks in which the last frame's rows were drawn

    explicit Machine(VerilatedContext *context) : top{context} {
        top.host_read = top.host_write = top.begins = 0;
        top.skipped = 0;
        top.stride = 1;
        top.reset = 1;
        top.clk = 0;
        for (int count = 0; count < RESET_CLOCKS; count++) clock();
        top.reset = 0;
    }

    // Draw each stride-th row, and begin below the skipped ones.
    void share(uint32_t skipped, uint32_t stride) {
        top.skipped = skipped;
        top.stride = stride;
    }

    void write(uint32_t address, uint32_t word) {
        top.host_write = 1;
        top.host_address = address;
        top.host_writedata = word;
        request();
        top.host_write = 0;
        events.push_back({clocks, 0, 0, 0, 1, address, word, 0xf});
    }

    uint32_t read(uint32_t address) {
        top.host_read = 1;
        top.host_address = address;
        request();
        top.host_read = 0;
        while (!top.host_readdatavalid) clock();
        return top.host_readdata;
    }

    // Draws the rows of the committed scene.
    void run_frame() {
        runs.clear();
        working = 0;
        for (int count = 0; count < COMMIT_CLOCKS; count++) clock();
        events.push_back({clocks, 1, 1, 0, 0, 0, 0, 0});
        top.begins = 1;
        clock();
        top.begins = 0;
        while (top.busy) {
            working += top.working;
            if (top.run_valid) keep(top.run);
            clock();
        }
    }

private:
    static const int RESET_CLOCKS = 8, COMMIT_CLOCKS = 4;
    static const uint32_t CHANNEL = (1u << COLOUR_BITS) - 1;
    Vmachine top;
    uint32_t clocks = 0;

    void keep(uint64_t run) {
        const uint32_t blue = run & CHANNEL, green = run >> COLOUR_BITS & CHANNEL, red = run >> 2 * COLOUR_BITS & CHANNEL;
        runs.push_back(static_cast<uint32_t>(top.row) << 16 | static_cast<uint32_t>(run >> 3 * COLOUR_BITS));
        runs.push_back(0xff000000u | blue << 16 | green << 8 | red);
    }

    // Holds a request until it is accepted.
    void request() {
        for (bool waits = true; waits; clock()) {
            top.eval();
            waits = top.host_waitrequest;
        }
    }

    void clock() {
        top.clk = 1;
        top.eval();
        top.clk = 0;
        top.eval();
        clocks++;
    }
};

#endif
