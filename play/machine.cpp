// SPDX-License-Identifier: MIT
// A design in a loop without a test bench: reads which buttons are held and what a driver would write, runs to the next
// vertical sync, and writes how many clocks that took, the pixels that were shown, what happened on the ray tracer's bus,
// and what the serial port said; over and over.
//
// In: 32 bits each of the buttons and how many writes there are; word address and word of each write, which are written
// as fast as they are taken. Out: 32 bits each of clocks, clocks in which a picture was computed, pixels, events and
// characters; red, green and blue of each pixel; the events; the characters. VS_ACTIVE: level of VS in its pulse;
// CLOCKS_PER_BIT: of the serial port, 0 where there is none.

#include <cstdint>
#include <cstdio>
#include <deque>
#include <string>
#include <vector>

#include "Vmachine.h"

static const int RESET_CLOCKS = 8;

// A StartScreen, a write, or both in a clock.
struct Event {
    uint32_t clock, start_screen, written, address, writedata, byteenable;
};

// What a driver writes.
struct Write {
    uint32_t address, word;
};

// The receiving half: samples a byte in the middle of its bits.
class SerialPort {
public:
    std::string text;

    void clock(bool line) {
        if (wait == 0) {
            if (line) return;
            wait = CLOCKS_PER_BIT + CLOCKS_PER_BIT / 2;
            bits = 0;
        }
        if (--wait != 0) return;
        if (bits == 8) {
            text.push_back(static_cast<char>(byte));
            return;
        }
        byte = static_cast<uint8_t>(byte >> 1 | line << 7);
        bits++;
        wait = CLOCKS_PER_BIT;
    }

private:
    int wait = 0;
    int bits = 0;
    uint8_t byte = 0;
};

int main(int argc, char **argv) {
    VerilatedContext context;
    context.commandArgs(argc, argv);
    Vmachine top{&context};
    std::vector<uint8_t> pixels;
    std::vector<Event> events;
    bool vga_clk = false, vs = true;
#if CLOCKS_PER_BIT
    SerialPort serial;
#endif
    std::deque<Write> writes;
    top.ready = 0;
    uint32_t heads[2];
    for (uint64_t clocks = 0; fread(heads, sizeof heads, 1, stdin) == 1;) {
        top.buttons = heads[0];
        for (uint32_t count = heads[1]; count > 0; count--) {
            Write write;
            if (fread(&write, sizeof write, 1, stdin) != 1) return 1;
            writes.push_back(write);
        }
        pixels.clear();
        events.clear();
        uint32_t taken = 0, busy = 0;
        for (bool sync = false; !sync; taken++, clocks++) {
            if (clocks == RESET_CLOCKS) top.ready = 1;
#if !CLOCKS_PER_BIT
            top.host_write = !writes.empty();
            if (!writes.empty()) {
                top.host_address = writes.front().address;
                top.host_writedata = writes.front().word;
            }
            top.eval();
            if (top.written) writes.pop_front();
#endif
            busy += top.busy;
            if (top.start_screen || top.written)
                events.push_back({static_cast<uint32_t>(clocks), top.start_screen, top.written, top.address,
                                  top.writedata, top.byteenable});
            for (int level = 1; level >= 0; level--) {
                top.clk = level;
                top.eval();
                if (top.vga_clk && !vga_clk) {
                    if (top.vga_blank_n) {
                        pixels.push_back(top.vga_r);
                        pixels.push_back(top.vga_g);
                        pixels.push_back(top.vga_b);
                    }
                    sync |= top.vga_vs == VS_ACTIVE && !vs;
                    vs = top.vga_vs == VS_ACTIVE;
                }
                vga_clk = top.vga_clk;
            }
#if CLOCKS_PER_BIT
            if (top.ready) serial.clock(top.uart_tx);
#endif
        }
#if CLOCKS_PER_BIT
        const std::string text = std::move(serial.text);
        serial.text.clear();
#else
        const std::string text;
#endif
        const uint32_t sizes[] = {taken, busy, static_cast<uint32_t>(pixels.size() / 3),
                                  static_cast<uint32_t>(events.size()), static_cast<uint32_t>(text.size())};
        fwrite(sizes, sizeof sizes, 1, stdout);
        fwrite(pixels.data(), 1, pixels.size(), stdout);
        fwrite(events.data(), sizeof(Event), events.size(), stdout);
        fwrite(text.data(), 1, text.size(), stdout);
        fflush(stdout);
    }
}
