// SPDX-License-Identifier: MIT
// The ray tracer's driver. Every offset and field is that of raycaster_regs.h, which is made of the register map.

#include "raycaster.h"

#include <stddef.h>

#include "raycaster_regs.h"

typedef ray_caster__rectangle__stride10_t entry_t;

#define READ(device, name) RAYCASTER_READ((device)->base, offsetof(ray_caster_t, name))
#define WRITE(device, name, word) RAYCASTER_WRITE((device)->base, offsetof(ray_caster_t, name), word)

// By index, as the hardware may have more entries than the header.
#define ENTRY(index, name) (offsetof(ray_caster_t, rectangle) + (index) * sizeof(entry_t) + offsetof(entry_t, name))

// A field's value in a word, a word with a field's value, and the greatest value.
#define GET(word, field) (((word) & RAY_CASTER__##field##_bm) >> RAY_CASTER__##field##_bp)
#define PUT(value, field) ((uint32_t)(value) << RAY_CASTER__##field##_bp)
#define MOST(field) (RAY_CASTER__##field##_bm >> RAY_CASTER__##field##_bp)

#define PUT_POINT(point, place) (PUT((point).x, place##__X) | PUT((point).y, place##__Y) | PUT((point).z, place##__Z))
#define PUT_COLOUR(colour, place) \
    (PUT((colour).red, place##__RED) | PUT((colour).green, place##__GREEN) | PUT((colour).blue, place##__BLUE))

static bool is_in_world(struct raycaster_point point) {
    return point.x <= MOST(CAMERA__X) && point.y <= MOST(CAMERA__Y) && point.z <= MOST(CAMERA__Z);
}

static enum raycaster_error check_index(const struct raycaster *device, unsigned index) {
    if (device->built_in != RAYCASTER_NOTHING_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    return index < device->rectangles ? RAYCASTER_OK : RAYCASTER_NO_SUCH_RECTANGLE;
}

// The register with some bits changed. Commit reads 1 for a while, and must not be written back.
static void change_control(const struct raycaster *device, uint32_t mask, uint32_t bits) {
    const uint32_t word = READ(device, control) & ~(mask | RAY_CASTER__CONTROL__COMMIT_bm);
    WRITE(device, control, word | bits);
}

const char *raycaster_error_text(enum raycaster_error error) {
    switch (error) {
    case RAYCASTER_OK:
        return "no error";
    case RAYCASTER_NOT_FOUND:
        return "no ray tracer at this address";
    case RAYCASTER_OTHER_VERSION:
        return "the registers are of another major version than this driver";
    case RAYCASTER_NO_SUCH_RECTANGLE:
        return "the rectangle's index is beyond the table";
    case RAYCASTER_OUTSIDE_WORLD:
        return "a coordinate is above 511";
    case RAYCASTER_NO_PLANE:
        return "the rectangle's corners share no coordinate";
    case RAYCASTER_TOO_MANY_REFLECTIONS:
        return "more reflections than the hardware can compute";
    case RAYCASTER_FIXED:
        return "built into the hardware";
    case RAYCASTER_STILL_COMMITTING:
        return "what was committed before is not live yet";
    case RAYCASTER_NO_FRAME:
        return "no frame started in time";
    case RAYCASTER_UNDERRUN:
        return "a row was not complete in time";
    case RAYCASTER_BAD_RECTANGLE:
        return "an enabled rectangle without a plane was committed";
    }
    return "unknown error";
}

enum raycaster_error raycaster_probe(struct raycaster *device, volatile uint32_t *base) {
    device->base = base;
    if (READ(device, id) != RAY_CASTER__ID__MAGIC_reset) {
        return RAYCASTER_NOT_FOUND;
    }
    const uint32_t version = READ(device, version);
    device->major = GET(version, VERSION__MAJOR);
    device->minor = GET(version, VERSION__MINOR);
    if (device->major != RAY_CASTER__VERSION__MAJOR_reset) {
        return RAYCASTER_OTHER_VERSION;
    }
    const uint32_t size = READ(device, size);
    device->units = GET(size, SIZE__UNITS);
    device->rows = GET(size, SIZE__ROWS);
    device->rectangles = GET(size, SIZE__RECTANGLES);
    const uint32_t engine = READ(device, engine);
    device->reflections = GET(engine, ENGINE__REFLECTIONS);
    device->engine = GET(engine, ENGINE__ENGINE);
    device->built_in = GET(engine, ENGINE__FIXED);
    device->scale = GET(engine, ENGINE__SCALE);
    device->fraction_bits = GET(engine, ENGINE__FRACTION_BITS);
    device->divider_bits = GET(engine, ENGINE__DIVIDER_BITS);
    device->colour_bits = GET(engine, ENGINE__COLOUR_BITS);
    device->nearest = GET(engine, ENGINE__NEAREST) != 0;
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_rectangle(
    const struct raycaster *device, unsigned index, struct raycaster_point corner_0, struct raycaster_point corner_1,
    struct raycaster_colour colour) {
    const enum raycaster_error error = check_index(device, index);
    if (error != RAYCASTER_OK) {
        return error;
    }
    if (!is_in_world(corner_0) || !is_in_world(corner_1)) {
        return RAYCASTER_OUTSIDE_WORLD;
    }
    if (corner_0.x != corner_1.x && corner_0.y != corner_1.y && corner_0.z != corner_1.z) {
        return RAYCASTER_NO_PLANE;
    }
    RAYCASTER_WRITE(device->base, ENTRY(index, corner_0), PUT_POINT(corner_0, RECTANGLE__CORNER));
    RAYCASTER_WRITE(device->base, ENTRY(index, corner_1), PUT_POINT(corner_1, RECTANGLE__CORNER));
    RAYCASTER_WRITE(
        device->base, ENTRY(index, surface),
        PUT_COLOUR(colour, RECTANGLE__SURFACE) | RAY_CASTER__RECTANGLE__SURFACE__ENABLE_bm);
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_enable_rectangle(const struct raycaster *device, unsigned index, bool enable) {
    const enum raycaster_error error = check_index(device, index);
    if (error != RAYCASTER_OK) {
        return error;
    }
    const uint32_t surface = RAYCASTER_READ(device->base, ENTRY(index, surface));
    RAYCASTER_WRITE(
        device->base, ENTRY(index, surface),
        (surface & ~RAY_CASTER__RECTANGLE__SURFACE__ENABLE_bm) | PUT(enable, RECTANGLE__SURFACE__ENABLE));
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_camera(const struct raycaster *device, struct raycaster_point position) {
    if (device->built_in == RAYCASTER_SCENE_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    if (!is_in_world(position)) {
        return RAYCASTER_OUTSIDE_WORLD;
    }
    WRITE(device, camera, PUT_POINT(position, CAMERA));
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_background(const struct raycaster *device, struct raycaster_colour colour) {
    if (device->built_in == RAYCASTER_SCENE_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    WRITE(device, background, PUT_COLOUR(colour, BACKGROUND));
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_reflections(const struct raycaster *device, unsigned reflections) {
    if (device->built_in == RAYCASTER_SCENE_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    if (reflections > device->reflections) {
        return RAYCASTER_TOO_MANY_REFLECTIONS;
    }
    change_control(device, RAY_CASTER__CONTROL__REFLECTIONS_bm, PUT(reflections, CONTROL__REFLECTIONS));
    return RAYCASTER_OK;
}

void raycaster_set_run(const struct raycaster *device, bool run) {
    change_control(device, RAY_CASTER__CONTROL__RUN_bm, PUT(run, CONTROL__RUN));
}

enum raycaster_error raycaster_commit(const struct raycaster *device) {
    const uint32_t control = READ(device, control);
    if (GET(control, CONTROL__COMMIT)) {
        return RAYCASTER_STILL_COMMITTING;
    }
    WRITE(device, control, control | RAY_CASTER__CONTROL__COMMIT_bm);
    return RAYCASTER_OK;
}

bool raycaster_is_committing(const struct raycaster *device) {
    return GET(READ(device, control), CONTROL__COMMIT) != 0;
}

enum raycaster_error raycaster_wait_frame(const struct raycaster *device, uint32_t polls) {
    for (; polls != 0; polls--) {
        if (raycaster_acknowledge(device)) {
            return RAYCASTER_OK;
        }
    }
    return RAYCASTER_NO_FRAME;
}

void raycaster_enable_interrupt(const struct raycaster *device, bool enable) {
    WRITE(device, irq_enable, PUT(enable, IRQ_ENABLE__START_SCREEN));
}

bool raycaster_acknowledge(const struct raycaster *device) {
    if (!GET(READ(device, irq_pending), IRQ_PENDING__START_SCREEN)) {
        return false;
    }
    WRITE(device, irq_pending, RAY_CASTER__IRQ_PENDING__START_SCREEN_bm);
    return true;
}

uint16_t raycaster_frame(const struct raycaster *device) {
    return GET(READ(device, status), STATUS__FRAME);
}

struct raycaster_status raycaster_get_status(const struct raycaster *device) {
    const uint32_t word = READ(device, status);
    return (struct raycaster_status){
        .frame = GET(word, STATUS__FRAME),
        .busy = GET(word, STATUS__BUSY) != 0,
        .underrun = GET(word, STATUS__UNDERRUN) != 0,
        .bad_rectangle = GET(word, STATUS__BAD_RECTANGLE) != 0,
    };
}

enum raycaster_error raycaster_check(const struct raycaster *device) {
    const struct raycaster_status status = raycaster_get_status(device);
    if (status.underrun) {
        return RAYCASTER_UNDERRUN;
    }
    return status.bad_rectangle ? RAYCASTER_BAD_RECTANGLE : RAYCASTER_OK;
}

void raycaster_clear_status(const struct raycaster *device) {
    WRITE(device, status, RAY_CASTER__STATUS__UNDERRUN_bm | RAY_CASTER__STATUS__BAD_RECTANGLE_bm);
}

struct raycaster_cycles raycaster_get_cycles(const struct raycaster *device) {
    const uint32_t word = READ(device, cycles);
    return (struct raycaster_cycles){.row = GET(word, CYCLES__ROW), .group = GET(word, CYCLES__GROUP)};
}

void raycaster_clear_cycles(const struct raycaster *device) {
    WRITE(device, cycles, 0);
}
