// SPDX-License-Identifier: MIT
// The bus of a design in a loop without a test bench, driven by the loop.

#ifndef HOST_H
#define HOST_H

#include <cstdint>
#include <vector>

#include "Vmachine.h"

// A StartScreen, a write, or both in one clock.
struct Event {
    uint32_t clock, start_screen, takes_scene, again, written, address, writedata, byteenable;
};

// Loop: the class that derives from this; its clock() runs a clock.
template <class Loop> class Host {
public:
    std::vector<Event> events;

    // Writes over the ray tracer's bus, if there is no processor.
    void write(uint32_t address, uint32_t word) {
        top.host_write = 1;
        top.host_address = address;
        top.host_writedata = word;
        request();
        top.host_write = 0;
    }

    uint32_t read(uint32_t address) {
        top.host_read = 1;
        top.host_address = address;
        request();
        top.host_read = 0;
        while (!top.host_readdatavalid) loop().clock();
        return top.host_readdata;
    }

protected:
    static const int RESET_CLOCKS = 8;
    Vmachine top;

    explicit Host(VerilatedContext *context) : top{context} { top.host_read = top.host_write = 0; }

private:
    Loop &loop() { return *static_cast<Loop *>(this); }

    // Holds a request until it is accepted.
    void request() {
        for (bool waits = true; waits; loop().clock()) {
            top.eval();
            waits = top.host_waitrequest;
        }
    }
};

#endif
