// SPDX-License-Identifier: MIT
// A design in a loop without a test bench: its clock, the pixels that a monitor would sample, the events on the ray
// tracer's bus, and the text from the serial port.
//
// VS_ACTIVE: level of VS during its pulse; PIXELS: pixels per clock, the left one in the low half of each colour;
// COLOUR_BITS: bits per channel of a pixel; CLOCKS_PER_BIT: of the serial port, 0 without one.

#ifndef MACHINE_H
#define MACHINE_H

#include <string>

#include "host.h"

// Receiver: samples each bit in its middle.
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

class Machine : public Host<Machine> {
    friend Host;

public:
    std::vector<uint32_t> pixels; // since the last vertical sync; bytes red, green, blue, 255
    std::string text;
    uint64_t clocks = 0;
    uint32_t busy = 0; // clocks in which a picture was computed

    virtual ~Machine() = default;
    explicit Machine(VerilatedContext *context) : Host{context} {
        top.ready = 0;
        top.buttons = 0;
        top.clk = 0;
        for (int count = 0; count < RESET_CLOCKS; count++) clock();
        top.ready = 1;
    }

    void hold(uint32_t buttons) { top.buttons = buttons; }

    // Runs until the vertical sync begins.
    void run_frame() {
        pixels.clear();
        while (!clock()) {
        }
#if CLOCKS_PER_BIT
        text = std::move(serial.text);
        serial.text.clear();
#endif
    }

protected:
    // Called before each rising edge of the clock, and at each rising edge of the monitor's clock; to be overridden to
    // observe more.
    virtual void see() {}
    virtual void sample() {}

    // Extracts the red, green and blue of a pixel, each with its lowest bit at `low`.
    uint32_t colour(int low) const {
        const auto channel = [low](uint32_t of) { return of >> low & ((1u << COLOUR_BITS) - 1); };
        return channel(top.vga_r) | channel(top.vga_g) << 8 | channel(top.vga_b) << 16;
    }

    // Runs a clock; returns true if the vertical sync begins.
    bool clock() {
        bool sync = false;
        busy += top.busy;
        see();
        if (top.start_screen || top.written)
            events.push_back({static_cast<uint32_t>(clocks), top.start_screen, top.takes_scene, top.again, top.written,
                              top.address, top.writedata, top.byteenable});
        for (int level = 1; level >= 0; level--) {
            top.clk = level;
            top.eval();
            if (top.vga_clk && !vga_clk) {
                if (top.vga_blank_n)
                    for (int low = 0; low < PIXELS * COLOUR_BITS; low += COLOUR_BITS)
                        pixels.push_back(colour(low) | 0xff000000u);
                sample();
                sync = top.vga_vs == VS_ACTIVE && !vs;
                vs = top.vga_vs == VS_ACTIVE;
            }
            vga_clk = top.vga_clk;
        }
#if CLOCKS_PER_BIT
        if (top.ready) serial.clock(top.uart_tx);
#endif
        clocks++;
        return sync;
    }

private:
    bool vga_clk = false, vs = true;
#if CLOCKS_PER_BIT
    SerialPort serial;
#endif
};

#endif
