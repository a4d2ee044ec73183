// SPDX-License-Identifier: MIT
// The ray tracer's driver. Offsets and fields come from raycaster_regs.h, which is generated from the register map.

#include "raycaster.h"

#include <stddef.h>

#include "raycaster_regs.h"

typedef ray_caster__rectangle_t entry_t;

#define READ(device, name) RAYCASTER_READ((device)->base, offsetof(ray_caster_t, name))
#define WRITE(device, name, word) RAYCASTER_WRITE((device)->base, offsetof(ray_caster_t, name), word)

// Computed, as the hardware may have more entries than the header.
#define ENTRY(index, name) (offsetof(ray_caster_t, rectangle) + (index) * sizeof(entry_t) + offsetof(entry_t, name))

// Get a field's value from a word, put a value into a field, and a field's greatest value.
#define GET(word, field) (((word) & RAY_CASTER__##field##_bm) >> RAY_CASTER__##field##_bp)
#define PUT(value, field) ((uint32_t)(value) << RAY_CASTER__##field##_bp)
#define MOST(field) (RAY_CASTER__##field##_bm >> RAY_CASTER__##field##_bp)

#define PUT_POINT(point, place) (PUT((point).x, place##__X) | PUT((point).y, place##__Y) | PUT((point).z, place##__Z))
#define PUT_COLOUR(colour, place) \
    (PUT((colour).red, place##__RED) | PUT((colour).green, place##__GREEN) | PUT((colour).blue, place##__BLUE))

#define HALF_MIRROR 2
#define MOST_MIRROR 4
#define LEAST_CELL_LOG 3

// Sines of whole degrees, 0 to 90, times 2^30: exact enough to round products of three to the nearest 256th.
#define SINE_BITS 30
static const int32_t sines[91] = {
    0, 18739379, 37473049, 56195305, 74900443, 93582766, 112236583, 130856211,
    149435979, 167970228, 186453311, 204879599, 223243478, 241539355, 259761657, 277904834,
    295963357, 313931728, 331804471, 349576144, 367241333, 384794656, 402230767, 419544355,
    436730145, 453782903, 470697435, 487468587, 504091252, 520560366, 536870912, 553017922,
    568996477, 584801711, 600428808, 615873009, 631129609, 646193961, 661061475, 675727625,
    690187940, 704438018, 718473518, 732290163, 745883746, 759250125, 772385229, 785285058,
    797945680, 810363241, 822533958, 834454122, 846120104, 857528349, 868675383, 879557810,
    890172315, 900515665, 910584710, 920376381, 929887697, 939115760, 948057759, 956710970,
    965072759, 973140576, 980911966, 988384560, 995556083, 1002424350, 1008987269, 1015242840,
    1021189159, 1026824413, 1032146887, 1037154959, 1041847103, 1046221891, 1050277989, 1054014162,
    1057429273, 1060522280, 1063292242, 1065738315, 1067859754, 1069655912, 1071126243, 1072270298,
    1073087729, 1073578288, 1073741824,
};

static int32_t sine(int degrees) {
    degrees %= 360;
    degrees = degrees < 0 ? degrees + 360 : degrees;
    if (degrees > 180) {
        return -sine(degrees - 180);
    }
    return sines[degrees > 90 ? 180 - degrees : degrees];
}

// Round a sum of products of two sines to `bits` fraction bits: to the nearest, halves up.
static int32_t rounded(int64_t products, int bits) {
    const int lost = 2 * SINE_BITS - bits;
    // The offset makes the shifted value positive: C leaves shifts of negative values to the compiler.
    const uint64_t offset = (uint64_t)1 << 62;
    return (int32_t)((int64_t)((offset + (uint64_t)products + ((uint64_t)1 << (lost - 1))) >> lost) -
                     (int64_t)(offset >> lost));
}

static int32_t product(int32_t a, int32_t b) {
    return rounded((int64_t)a * b, SINE_BITS);
}

static int16_t part(int64_t products) {
    return (int16_t)rounded(products, 8);
}

static bool is_basis_vector(struct raycaster_vector vector) {
    const int most = MOST(FORWARD__X) / 2;
    return vector.x >= -most - 1 && vector.x <= most && vector.y >= -most - 1 && vector.y <= most &&
           vector.z >= -most - 1 && vector.z <= most;
}

static uint32_t vector_word(struct raycaster_vector vector) {
    return PUT((uint32_t)vector.x & MOST(FORWARD__X), FORWARD__X) |
           PUT((uint32_t)vector.y & MOST(FORWARD__Y), FORWARD__Y) |
           PUT((uint32_t)vector.z & MOST(FORWARD__Z), FORWARD__Z);
}

static bool is_in_world(struct raycaster_point point) {
    return point.x <= MOST(CAMERA__X) && point.y <= MOST(CAMERA__Y) && point.z <= MOST(CAMERA__Z);
}

static enum raycaster_error write_light(const struct raycaster *device, uint32_t word) {
    if (device->built_in == RAYCASTER_SCENE_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    if (!device->light) {
        return RAYCASTER_NOT_IN_HARDWARE;
    }
    WRITE(device, light, word);
    return RAYCASTER_OK;
}

static enum raycaster_error check_index(const struct raycaster *device, unsigned index) {
    if (device->built_in != RAYCASTER_NOTHING_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    return index < device->rectangles ? RAYCASTER_OK : RAYCASTER_NO_SUCH_RECTANGLE;
}

// Change some bits of the register. Commit reads 1 for a while, and must not be written back.
static void change_control(const struct raycaster *device, uint32_t mask, uint32_t bits) {
    const uint32_t word = READ(device, control) & ~(mask | RAY_CASTER__CONTROL__COMMIT_bm);
    WRITE(device, control, word | bits);
}

static void change_surface(const struct raycaster *device, unsigned index, uint32_t mask, uint32_t bits) {
    const uint32_t surface = RAYCASTER_READ(device->base, ENTRY(index, surface));
    RAYCASTER_WRITE(device->base, ENTRY(index, surface), (surface & ~mask) | bits);
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
    case RAYCASTER_NOT_IN_HARDWARE:
        return "the hardware was generated without it";
    case RAYCASTER_NO_SUCH_LOOK:
        return "no such mirror, pattern, size of cells or shade";
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
    const uint32_t entries = GET(READ(device, table), TABLE__RECTANGLES);
    device->rectangles = entries ? entries : GET(size, SIZE__RECTANGLES);
    const uint32_t engine = READ(device, engine);
    device->reflections = GET(engine, ENGINE__REFLECTIONS);
    device->engine = GET(engine, ENGINE__ENGINE);
    device->built_in = GET(engine, ENGINE__FIXED);
    device->scale = GET(engine, ENGINE__SCALE);
    device->fraction_bits = GET(engine, ENGINE__FRACTION_BITS);
    device->divider_bits = GET(engine, ENGINE__DIVIDER_BITS);
    device->colour_bits = GET(engine, ENGINE__COLOUR_BITS);
    device->nearest = GET(engine, ENGINE__NEAREST) != 0;
    device->turn = GET(engine, ENGINE__TURN) != 0;
    device->materials = GET(engine, ENGINE__MATERIALS) != 0;
    device->patterns = GET(engine, ENGINE__PATTERNS) != 0;
    device->light = GET(engine, ENGINE__LIGHT) != 0;
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
    if (device->patterns) {
        RAYCASTER_WRITE(device->base, ENTRY(index, pattern), PUT(RAYCASTER_PLAIN, RECTANGLE__PATTERN__KIND));
    }
    RAYCASTER_WRITE(
        device->base, ENTRY(index, surface),
        PUT_COLOUR(colour, RECTANGLE__SURFACE) | PUT(HALF_MIRROR, RECTANGLE__SURFACE__MIRROR) |
            RAY_CASTER__RECTANGLE__SURFACE__ENABLE_bm);
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_mirror(const struct raycaster *device, unsigned index, unsigned quarters) {
    const enum raycaster_error error = check_index(device, index);
    if (error != RAYCASTER_OK) {
        return error;
    }
    if (quarters > MOST_MIRROR) {
        return RAYCASTER_NO_SUCH_LOOK;
    }
    if (!device->materials) {
        return RAYCASTER_NOT_IN_HARDWARE;
    }
    change_surface(
        device, index, RAY_CASTER__RECTANGLE__SURFACE__MIRROR_bm, PUT(quarters, RECTANGLE__SURFACE__MIRROR));
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_pattern(
    const struct raycaster *device, unsigned index, enum raycaster_pattern pattern, unsigned cell,
    struct raycaster_colour colour) {
    const enum raycaster_error error = check_index(device, index);
    if (error != RAYCASTER_OK) {
        return error;
    }
    unsigned code = 0;
    while (cell > 1u << (LEAST_CELL_LOG + code) && code < 5) {
        code++;
    }
    if (cell != 1u << (LEAST_CELL_LOG + code) || (unsigned)pattern > RAYCASTER_COLUMNS) {
        return RAYCASTER_NO_SUCH_LOOK;
    }
    if (!device->patterns) {
        return RAYCASTER_NOT_IN_HARDWARE;
    }
    RAYCASTER_WRITE(
        device->base, ENTRY(index, pattern),
        PUT_COLOUR(colour, RECTANGLE__PATTERN) | PUT(pattern, RECTANGLE__PATTERN__KIND) |
            PUT(code, RECTANGLE__PATTERN__CELL));
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_enable_rectangle(const struct raycaster *device, unsigned index, bool enable) {
    const enum raycaster_error error = check_index(device, index);
    if (error != RAYCASTER_OK) {
        return error;
    }
    change_surface(device, index, RAY_CASTER__RECTANGLE__SURFACE__ENABLE_bm, PUT(enable, RECTANGLE__SURFACE__ENABLE));
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

struct raycaster_basis raycaster_turned(int yaw, int pitch, int roll) {
    // Reduced before 90 is added, which could overflow.
    yaw %= 360;
    pitch %= 360;
    roll %= 360;
    const int32_t sy = sine(yaw), cy = sine(yaw + 90);
    const int32_t sp = sine(pitch), cp = sine(pitch + 90);
    const int32_t sr = sine(roll), cr = sine(roll + 90);
    const int64_t one = (int64_t)1 << SINE_BITS;
    return (struct raycaster_basis){
        .forward = {part((int64_t)cy * cp), part((int64_t)sy * cp), part(sp * one)},
        .right =
            {part(-(int64_t)sy * cr - (int64_t)product(cy, sp) * sr),
             part((int64_t)cy * cr - (int64_t)product(sy, sp) * sr), part((int64_t)cp * sr)},
        .up =
            {part((int64_t)sy * sr - (int64_t)product(cy, sp) * cr),
             part(-(int64_t)cy * sr - (int64_t)product(sy, sp) * cr), part((int64_t)cp * cr)},
    };
}

enum raycaster_error raycaster_set_basis(const struct raycaster *device, const struct raycaster_basis *basis) {
    if (device->built_in == RAYCASTER_SCENE_BUILT_IN) {
        return RAYCASTER_FIXED;
    }
    if (!is_basis_vector(basis->forward) || !is_basis_vector(basis->right) || !is_basis_vector(basis->up)) {
        return RAYCASTER_OUTSIDE_WORLD;
    }
    if (!device->turn) {
        return RAYCASTER_NOT_IN_HARDWARE;
    }
    WRITE(device, forward, vector_word(basis->forward));
    WRITE(device, right, vector_word(basis->right));
    WRITE(device, up, vector_word(basis->up));
    return RAYCASTER_OK;
}

enum raycaster_error raycaster_set_light(
    const struct raycaster *device, struct raycaster_point position, unsigned quarters) {
    if (!is_in_world(position)) {
        return RAYCASTER_OUTSIDE_WORLD;
    }
    if (quarters > MOST(LIGHT__SHADE)) {
        return RAYCASTER_NO_SUCH_LOOK;
    }
    return write_light(device, PUT_POINT(position, LIGHT) | PUT(quarters, LIGHT__SHADE) | RAY_CASTER__LIGHT__ON_bm);
}

enum raycaster_error raycaster_clear_light(const struct raycaster *device) {
    return write_light(device, 0);
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
