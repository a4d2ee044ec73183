// SPDX-License-Identifier: MIT
// A design in a page: driver functions and frames, called from JavaScript.
//
// WHOLE_FRAMES: 1 if the monitor shows the last whole frame, which is older than the live scene. Colours are 0xRRGGBB.
// Functions that return int return an enum raycaster_error from the driver, 0 for success.

#include <cstdlib>
#include <cstring>
#include <type_traits>

#include "bus.h"
#ifdef DRAWING
#include "drawing.h"
#else
#include "machine.h"
#endif
#include "raycaster.h"
#include "raycaster_regs.h"

#define EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace {

// Clocks from the one that accepts a committing write to the first StartScreen that shows it.
constexpr uint32_t COMMIT_CLOCKS = 3;
constexpr uint32_t CONTROL = offsetof(ray_caster_t, control) / sizeof(uint32_t);
constexpr int MOST_WORDS = 1024;

// Derives the renderer's register words only from the writes that the ray tracer accepted.
class Follower {
public:
    uint32_t shown[MOST_WORDS] = {};

    void see(const Event &event) {
        // A whole frame is handed over at the StartScreen at which the next scene is taken.
        if (WHOLE_FRAMES && event.start_screen && !event.again) std::memcpy(shown, live, sizeof shown);
        if (event.takes_scene && waiting && commit_clock + COMMIT_CLOCKS <= event.clock) {
            std::memcpy(live, committed, sizeof live);
            waiting = false;
        }
        if (!WHOLE_FRAMES && event.start_screen) std::memcpy(shown, live, sizeof shown);
        // A write in the clock of StartScreen is too late for it.
        if (!event.written) return;
        uint32_t mask = 0;
        for (int lane = 0; lane < 4; lane++)
            if (event.byteenable >> lane & 1) mask |= 0xffu << 8 * lane;
        uint32_t &word = shadow[event.address];
        word = (word & ~mask) | (event.writedata & mask);
        if (event.address == CONTROL && event.writedata & mask & RAY_CASTER__CONTROL__COMMIT_bm) {
            std::memcpy(committed, shadow, sizeof committed);
            commit_clock = event.clock;
            waiting = true;
        }
    }

private:
    uint32_t shadow[MOST_WORDS] = {};
    uint32_t live[MOST_WORDS] = {};
    uint32_t committed[MOST_WORDS] = {};
    uint32_t commit_clock = 0;
    bool waiting = false;
};

#ifdef TAPS
// Records the tapped signals of a unit in every clock in which it computes a chosen pixel, and what a monitor receives.
class WatchedMachine : public Machine {
public:
    std::vector<uint32_t> samples;  // TAPS numbers per clock
    std::vector<uint32_t> received; // per clock of the monitor: red, green, blue and a byte with the bits of Received

    explicit WatchedMachine(VerilatedContext *context) : Machine{context} { top.tapped_unit = NONE; }

    // Run until the vertical sync begins, and receive from there on.
    void run_frame() {
        Machine::run_frame();
        received.erase(received.begin(), received.end() - 1);
        handed = 0;
        ended = true;
    }

    // Record the unit's next computation of its pixel in this row and group.
    void watch(uint32_t unit, uint32_t row, uint32_t group) {
        top.tapped_unit = unit;
        watched_row = row;
        watched_group = group;
        records = false;
        samples.clear();
    }

    // Run on until this many clocks of the monitor were received since the last call, or to the vertical sync; return
    // true if it has begun.
    bool scan(uint32_t count) {
        if (ended) pixels.clear();
        received.erase(received.begin(), received.begin() + handed);
        for (ended = false; !ended && received.size() < count;) ended = clock();
        handed = received.size();
        return ended;
    }

protected:
    void see() override {
        late |= top.late;
        if (top.tapped_unit == NONE) return;
        const uint32_t *taps = top.tapped.data();
        if (taps[SCREEN_TO_RAY]) records = taps[ROW] == watched_row && taps[GROUP] == watched_group;
        if (!records) return;
        samples.insert(samples.end(), taps, taps + TAPS);
        if (taps[DONE]) top.tapped_unit = NONE;
    }

    void sample() override {
        const uint32_t bits = VISIBLE * top.vga_blank_n | HS * top.vga_hs | VS * top.vga_vs | LATE * late;
        received.push_back(colour(0) | bits << 24);
        late = false;
    }

private:
    static constexpr uint8_t NONE = 0xff;
    enum { ROW, GROUP, SCREEN_TO_RAY, DONE };             // FIRST of taps.py
    enum Received { VISIBLE = 1, HS = 2, VS = 4, LATE = 8 }; // levels, and a row that was late since the clock before

    uint32_t watched_row, watched_group;
    size_t handed = 0; // clocks of `received` that the last scan returned
    bool records = false, ended = true, late = false;
};

WatchedMachine *machine;
#else
Machine *machine;
#endif
Follower follower;
struct raycaster device;

void follow() {
    for (const Event &event : machine->events) follower.see(event);
    machine->events.clear();
}

raycaster_colour colour(uint32_t rgb) {
    return {static_cast<uint8_t>(rgb >> 16), static_cast<uint8_t>(rgb >> 8), static_cast<uint8_t>(rgb)};
}

raycaster_vector vector(int x, int y, int z) {
    return {static_cast<int16_t>(x), static_cast<int16_t>(y), static_cast<int16_t>(z)};
}

raycaster_point point(int x, int y, int z) {
    return {static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<uint16_t>(z)};
}

} // namespace

uint32_t bus_read(uint32_t offset) { return machine->read(offset / sizeof(uint32_t)); }
void bus_write(uint32_t offset, uint32_t word) { machine->write(offset / sizeof(uint32_t), word); }

// Allocate the buffer to which the page writes the processor's program before it starts the machine.
EXPORT(program) char *program(uint32_t size) { return program_text = static_cast<char *>(std::calloc(size + 1, 1)); }

// Start the machine and identify the ray tracer on its bus.
EXPORT(start) int start() {
    static VerilatedContext context;
    machine = new std::remove_pointer_t<decltype(machine)>{&context};
    machine->run_frame();
    return CLOCKS_PER_BIT ? RAYCASTER_OK : raycaster_probe(&device, nullptr);
}

EXPORT(error_text) const char *error_text(int error) { return raycaster_error_text((enum raycaster_error)error); }

EXPORT(set_rectangle)
int set_rectangle(int index, int x0, int y0, int z0, int x1, int y1, int z1, uint32_t rgb) {
    return raycaster_set_rectangle(&device, index, point(x0, y0, z0), point(x1, y1, z1), colour(rgb));
}

EXPORT(set_mirror) int set_mirror(int index, int quarters) { return raycaster_set_mirror(&device, index, quarters); }

EXPORT(set_pattern) int set_pattern(int index, int kind, int cell, uint32_t rgb) {
    return raycaster_set_pattern(&device, index, (enum raycaster_pattern)kind, cell, colour(rgb));
}

EXPORT(disable_rectangle) int disable_rectangle(int index) { return raycaster_enable_rectangle(&device, index, false); }

EXPORT(set_camera) int set_camera(int x, int y, int z) { return raycaster_set_camera(&device, point(x, y, z)); }

EXPORT(set_basis) int set_basis(int fx, int fy, int fz, int rx, int ry, int rz, int ux, int uy, int uz) {
    const struct raycaster_basis basis = {vector(fx, fy, fz), vector(rx, ry, rz), vector(ux, uy, uz)};
    return raycaster_set_basis(&device, &basis);
}

EXPORT(set_light) int set_light(int x, int y, int z, int quarters) {
    return raycaster_set_light(&device, point(x, y, z), quarters);
}

EXPORT(clear_light) int clear_light() { return raycaster_clear_light(&device); }

EXPORT(set_background) int set_background(uint32_t rgb) { return raycaster_set_background(&device, colour(rgb)); }

EXPORT(set_reflections) int set_reflections(int count) { return raycaster_set_reflections(&device, count); }

EXPORT(set_run) void set_run(int run) { raycaster_set_run(&device, run); }

EXPORT(commit) int commit() { return raycaster_commit(&device); }

#ifdef DRAWING
// Draw the machine's rows of the committed scene: each stride-th row, below the skipped ones. Return the number of
// clocks in which its unit drew them.
EXPORT(draw) uint32_t draw(uint32_t skipped, uint32_t stride) {
    machine->share(skipped, stride);
    machine->run_frame();
    follow();
    return machine->working;
}

// Runs of these rows: for each its row in the upper half of a number and its end in the lower one, and then its colour,
// as red, green, blue and 255.
EXPORT(runs) const uint32_t *runs() { return machine->runs.data(); }
EXPORT(run_count) uint32_t run_count() { return machine->runs.size() / 2; }
#else
// Run to the next vertical sync with these buttons held; return the number of clocks.
EXPORT(frame) uint32_t frame(uint32_t buttons) {
    static uint64_t before;
    machine->busy = 0;
    machine->hold(buttons);
    machine->run_frame();
    follow();
    const uint32_t taken = machine->clocks - before;
    before = machine->clocks;
    return taken;
}

// Number of clocks in which the last frame was being computed.
EXPORT(busy) uint32_t busy() { return machine->busy; }

// Picture of the last frame: red, green, blue and 255 of each pixel.
EXPORT(pixels) const uint32_t *pixels() { return machine->pixels.data(); }
EXPORT(pixel_count) uint32_t pixel_count() { return machine->pixels.size(); }

// Output of the serial port during the last frame.
EXPORT(text) const char *text() { return machine->text.data(); }
EXPORT(text_size) uint32_t text_size() { return machine->text.size(); }
#endif

// Register words that the last picture shows.
EXPORT(live_words) const uint32_t *live_words() { return follower.shown; }

#ifdef TAPS
// Record a ray unit's next computation of its pixel in a row and group.
EXPORT(watch) void watch(uint32_t unit, uint32_t row, uint32_t group) { machine->watch(unit, row, group); }

// Recorded taps: TAPS numbers per clock.
EXPORT(samples) const uint32_t *samples() { return machine->samples.data(); }
EXPORT(sample_count) uint32_t sample_count() { return machine->samples.size(); }

// Run on for some clocks of the monitor, or to the vertical sync; return 1 if it has begun.
EXPORT(scan) uint32_t scan(uint32_t count) {
    const bool ended = machine->scan(count);
    follow();
    return ended;
}

// What the monitor received in these clocks: red, green, blue and the bits of Received.
EXPORT(received) const uint32_t *received() { return machine->received.data(); }
EXPORT(received_count) uint32_t received_count() { return machine->received.size(); }
#endif
