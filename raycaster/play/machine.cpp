// SPDX-License-Identifier: MIT
// A machine between two pipes. In a loop it reads the held buttons and a driver's writes, runs to the next vertical
// sync, and writes what happened.
//
// Input, in words of 32 bits: the buttons and the number of writes; the word address and the word of each write. Writes
// are sent as fast as they are accepted. Output, in words of 32 bits: the clocks, the clocks in which a picture was
// computed, and the numbers of pixels, events and characters; then the pixels, four bytes each; the events; the
// characters.

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
