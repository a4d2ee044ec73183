// SPDX-License-Identifier: MIT
// A machine at the end of two pipes: reads which buttons are held and what a driver would write, runs to the next
// vertical sync, and writes what it did, over and over.
//
// In: 32 bits each of the buttons and how many writes there are; word address and word of each write, which are written
// as fast as they are taken. Out: 32 bits each of clocks, clocks in which a picture was computed, pixels, events and
// characters; the pixels, four bytes each; the events; the characters.

#include <cstdio>

#include "machine.h"

int main(int argc, char **argv) {
    VerilatedContext context;
    context.commandArgs(argc, argv);
    Machine machine{&context};
    uint32_t heads[2];
    while (fread(heads, sizeof heads, 1, stdin) == 1) {
        const uint64_t before = machine.clocks;
        machine.events.clear();
        machine.busy = 0;
        machine.hold(heads[0]);
        for (uint32_t count = heads[1]; count > 0; count--) {
            uint32_t write[2];
            if (fread(write, sizeof write, 1, stdin) != 1) return 1;
            machine.write(write[0], write[1]);
        }
        machine.run_frame();
        const uint32_t sizes[] = {static_cast<uint32_t>(machine.clocks - before), machine.busy,
                                  static_cast<uint32_t>(machine.pixels.size()),
                                  static_cast<uint32_t>(machine.events.size()),
                                  static_cast<uint32_t>(machine.text.size())};
        fwrite(sizes, sizeof sizes, 1, stdout);
        fwrite(machine.pixels.data(), sizeof(uint32_t), machine.pixels.size(), stdout);
        fwrite(machine.events.data(), sizeof(Event), machine.events.size(), stdout);
        fwrite(machine.text.data(), 1, machine.text.size(), stdout);
        fflush(stdout);
    }
}
