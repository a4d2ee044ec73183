// SPDX-License-Identifier: MIT
// The ray tracer's driver: C99, without a C library, static variables or floating point.
//
// A program probes once, describes a picture with the set functions, and commits it, which shows all of it at once: from
// the next frame on or, if frames are drawn into lists, once the frame is drawn. Nothing is clipped: an argument that
// does not fit is an error, and then nothing is written.

#ifndef RAYCASTER_H
#define RAYCASTER_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Register access by `base` and a byte offset. If your bus needs another one, define both macros before this file.
#ifndef RAYCASTER_READ
#ifdef __nios2__
// Plain loads would be answered by a Nios II's data cache.
#include <io.h>
#define RAYCASTER_READ(base, offset) IORD_32DIRECT(base, offset)
#define RAYCASTER_WRITE(base, offset, word) IOWR_32DIRECT(base, offset, word)
#else
#define RAYCASTER_READ(base, offset) ((base)[(offset) / 4])
#define RAYCASTER_WRITE(base, offset, word) ((base)[(offset) / 4] = (word))
#endif
#endif

enum raycaster_error {
    RAYCASTER_OK,
    RAYCASTER_NOT_FOUND,
    RAYCASTER_OTHER_VERSION,
    RAYCASTER_NO_SUCH_RECTANGLE,
    RAYCASTER_OUTSIDE_WORLD,
    RAYCASTER_NO_PLANE,
    RAYCASTER_TOO_MANY_REFLECTIONS,
    RAYCASTER_FIXED,
    RAYCASTER_STILL_COMMITTING,
    RAYCASTER_NO_FRAME,
    RAYCASTER_UNDERRUN,
    RAYCASTER_BAD_RECTANGLE,
    RAYCASTER_NOT_IN_HARDWARE,
    RAYCASTER_NO_SUCH_LOOK
};

enum raycaster_engine { RAYCASTER_SEED, RAYCASTER_EXACT, RAYCASTER_SPAN = 3 }; // 2 is reserved

// Parts that are built into the hardware and cannot be set.
enum raycaster_built_in { RAYCASTER_NOTHING_BUILT_IN, RAYCASTER_RECTANGLES_BUILT_IN, RAYCASTER_SCENE_BUILT_IN };

// A ray tracer, as raycaster_probe found it.
struct raycaster {
    volatile uint32_t *base;
    uint16_t major;
    uint16_t minor;
    uint16_t units;
    uint16_t rows;       // at scale 1
    uint8_t rectangles;  // entries of the table
    uint8_t reflections; // most that it can compute
    uint8_t engine;      // enum raycaster_engine
    uint8_t built_in;    // enum raycaster_built_in
    uint8_t scale;
    uint8_t fraction_bits;
    uint8_t divider_bits;
    uint8_t colour_bits;
    bool nearest;   // rounds its quotients to nearest
    bool turn;      // its camera turns
    bool materials; // its rectangles differ in how much they mirror
    bool patterns;  // its rectangles have patterns
    bool light;     // it has a light, which casts shadows
};

// A place in the world, each coordinate 0 to 511: x is depth, y is side to side, z is height.
struct raycaster_point {
    uint16_t x;
    uint16_t y;
    uint16_t z;
};

struct raycaster_colour {
    uint8_t red;
    uint8_t green;
    uint8_t blue;
};

// Orientation of a camera: vectors times 256, each component -512 to 511.
struct raycaster_vector {
    int16_t x;
    int16_t y;
    int16_t z;
};

struct raycaster_basis {
    struct raycaster_vector forward;
    struct raycaster_vector right;
    struct raycaster_vector up;
};

// The second colour is on every other cell, row of cells or column of cells.
enum raycaster_pattern { RAYCASTER_PLAIN, RAYCASTER_CHECKER, RAYCASTER_ROWS, RAYCASTER_COLUMNS };

struct raycaster_status {
    uint16_t frame; // frames since reset, modulo 65536
    bool busy;
    bool underrun;      // sticky
    bool bad_rectangle; // sticky
};

// Most clock cycles since raycaster_clear_cycles.
struct raycaster_cycles {
    uint16_t row;
    uint16_t group;
};

// Describe an error in English, without a full stop.
const char *raycaster_error_text(enum raycaster_error error);

// Fill in `device` from the registers at `base`. RAYCASTER_NOT_FOUND, RAYCASTER_OTHER_VERSION: do not use it.
enum raycaster_error raycaster_probe(struct raycaster *device, volatile uint32_t *base);

// Set an entry of the table to a rectangle with two opposite corners that share a coordinate, plain and half a mirror,
// and enable it.
enum raycaster_error raycaster_set_rectangle(
    const struct raycaster *device, unsigned index, struct raycaster_point corner_0, struct raycaster_point corner_1,
    struct raycaster_colour colour);

// Set how much of an entry, already set, is a mirror, in quarters: 0 (matte) to 4. RAYCASTER_NOT_IN_HARDWARE: always 2.
enum raycaster_error raycaster_set_mirror(const struct raycaster *device, unsigned index, unsigned quarters);

// Set the pattern of an entry, already set; its cells are 8, 16, .. or 256 wide. RAYCASTER_NOT_IN_HARDWARE: all are
// plain.
enum raycaster_error raycaster_set_pattern(
    const struct raycaster *device, unsigned index, enum raycaster_pattern pattern, unsigned cell,
    struct raycaster_colour colour);

// Show or hide an entry of the table; its contents stay.
enum raycaster_error raycaster_enable_rectangle(const struct raycaster *device, unsigned index, bool enable);

enum raycaster_error raycaster_set_camera(const struct raycaster *device, struct raycaster_point position);

// Compute the basis of a camera turned by any whole degrees: yaw > 0 turns from x towards y, pitch > 0 upwards, and
// roll > 0 lifts the right side; roll comes first, yaw last. With all angles 0 it looks along x, upright.
struct raycaster_basis raycaster_turned(int yaw, int pitch, int roll);

// Turn the camera. RAYCASTER_NOT_IN_HARDWARE: it looks along x. RAYCASTER_OUTSIDE_WORLD: a component is too large.
enum raycaster_error raycaster_set_basis(const struct raycaster *device, const struct raycaster_basis *basis);

// Set the light's position, and how many quarters of each colour are left in the dark: 0 (black) to 3.
// RAYCASTER_NOT_IN_HARDWARE: everything is lit.
enum raycaster_error raycaster_set_light(
    const struct raycaster *device, struct raycaster_point position, unsigned quarters);

// Remove the light: everything is lit.
enum raycaster_error raycaster_clear_light(const struct raycaster *device);

enum raycaster_error raycaster_set_background(const struct raycaster *device, struct raycaster_colour colour);

enum raycaster_error raycaster_set_reflections(const struct raycaster *device, unsigned reflections);

// Show the scene, or black.
void raycaster_set_run(const struct raycaster *device, bool run);

// Make all that was set go live at the next frame or, if frames are drawn into lists, at the next one at which no frame
// is being drawn. RAYCASTER_STILL_COMMITTING: the last commit is not live yet; nothing was done.
enum raycaster_error raycaster_commit(const struct raycaster *device);

// True if the last commit is not live yet.
bool raycaster_is_committing(const struct raycaster *device);

// Wait for the start of a frame that was not yet waited for or acknowledged. RAYCASTER_NO_FRAME: none came while the
// registers were read `polls` times.
enum raycaster_error raycaster_wait_frame(const struct raycaster *device, uint32_t polls);

void raycaster_enable_interrupt(const struct raycaster *device, bool enable);

// Clear the interrupt, as its handler must. False: it came from another device.
bool raycaster_acknowledge(const struct raycaster *device);

// Frames since reset, modulo 65536.
uint16_t raycaster_frame(const struct raycaster *device);

struct raycaster_status raycaster_get_status(const struct raycaster *device);

// Return RAYCASTER_UNDERRUN or RAYCASTER_BAD_RECTANGLE if that has happened since raycaster_clear_status.
enum raycaster_error raycaster_check(const struct raycaster *device);

// Clear both sticky errors.
void raycaster_clear_status(const struct raycaster *device);

struct raycaster_cycles raycaster_get_cycles(const struct raycaster *device);

void raycaster_clear_cycles(const struct raycaster *device);

#ifdef __cplusplus
}
#endif

#endif
