// SPDX-License-Identifier: MIT
// A machine whose loop reads runs; see drawing.v.
//
// COLOUR_BITS: bits per channel of a run's colour. DIRECT: 1 if nothing but the rising edges of the clocks triggers the
// model, which then does without the rest of Verilator's evaluation while a frame is drawn.

#ifndef DRAWING_H
#define DRAWING_H

#include <cstdlib>

#include "Vmachine___024root.h"
#include "host.h"

#define CLOCKS_PER_BIT 0 // of a serial port: none

class Machine : public Host<Machine> {
    friend Host;

public:
    std::vector<uint32_t> runs; // of the last frame; for each its row in the upper half above its end, and its colour
    uint32_t working = 0;       // clocks in which the last frame's rows were drawn

    explicit Machine(VerilatedContext *context) : Host{context} {
        top.begins = 0;
        top.skipped = 0;
        top.stride = 1;
        top.reset = 1;
        top.clk = top.bus_clk = top.fetch_clk = 0;
        for (int count = 0; count < RESET_CLOCKS; count++) clock();
        top.reset = 0;
    }

    // Draw each stride-th row, and begin below the skipped ones.
    void share(uint32_t skipped, uint32_t stride) {
        top.skipped = skipped;
        top.stride = stride;
    }

    void write(uint32_t address, uint32_t word) {
        Host::write(address, word);
        events.push_back({clocks, 0, 0, 0, 1, address, word, 0xf});
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
            draw_clock(top.fetches);
        }
#if DIRECT
        top.rootp->__VnbaTriggered[0] = 0;
#endif
    }

private:
    static const int COMMIT_CLOCKS = 4;
    static const uint32_t CHANNEL = (1u << COLOUR_BITS) - 1;
    uint32_t clocks = 0;

    void keep(uint64_t run) {
        const uint32_t blue = run & CHANNEL, green = run >> COLOUR_BITS & CHANNEL, red = run >> 2 * COLOUR_BITS & CHANNEL;
        runs.push_back(static_cast<uint32_t>(top.row) << 16 | static_cast<uint32_t>(run >> 3 * COLOUR_BITS));
        runs.push_back(0xff000000u | blue << 16 | green << 8 | red);
    }

    void clock() {
        rise(1, 1, 1);
        clocks++;
    }

    // Runs a clock in which the bus is idle.
    void draw_clock(bool fetches) {
#if DIRECT
        top.rootp->__VnbaTriggered[0] = fetches ? fetching : drawing;
        Vmachine___024root___eval_nba(top.rootp);
#else
        rise(1, 0, fetches);
#endif
        clocks++;
    }

    void rise(int clk, int bus_clk, int fetch_clk) {
        top.clk = clk;
        top.bus_clk = bus_clk;
        top.fetch_clk = fetch_clk;
        top.eval();
        top.clk = top.bus_clk = top.fetch_clk = 0;
        top.eval();
    }

#if DIRECT
    // What rising edges trigger, of the clock alone and with that of the memory of the rectangles.
    const uint64_t drawing = triggered(0), fetching = triggered(1);

    uint64_t triggered(int fetch_clk) {
        top.clk = 1;
        top.fetch_clk = fetch_clk;
        Vmachine___024root___eval_triggers_vec__act(top.rootp);
        const uint64_t bits = top.rootp->__VactTriggered[0];
        top.clk = top.fetch_clk = 0;
        Vmachine___024root___eval_triggers_vec__act(top.rootp);
        if (top.rootp->__VactTriggered[0]) std::abort(); // a falling edge does something, too
        return bits;
    }
#endif
};

#endif
