// SPDX-License-Identifier: MIT
// Golden model in C++: draws the scene in the registers from the image contract, with integers only, and shares
// nothing with the hardware or its Verilog. The page runs it alongside the design and compares the pictures.
//
// MOST_RECTANGLES: entries of the largest rectangle table.
//
// The caller writes the live words to golden_words(), each at its register's word address, and calls golden_draw;
// golden_picture() then holds red, green and blue of each pixel. golden_ray explains one pixel of the last drawing in
// golden_bounces(): a struct Bounce, nine 64-bit numbers, for the camera's ray and for each reflection.

#include <stddef.h>
#include <stdint.h>

#include "raycaster.h"
#include "raycaster_regs.h"

#ifdef __wasm__
#define EXPORT(name) extern "C" __attribute__((export_name(#name)))
#else
#define EXPORT(name) extern "C" __attribute__((visibility("default")))
#endif

#define WORD(name) words[offsetof(ray_caster_t, name) / sizeof(uint32_t)]
#define FIELD(word, field) ((int)(((word) & RAY_CASTER__##field##_bm) >> RAY_CASTER__##field##_bp))
#define VECTOR(word, name) {FIELD(word, name##__X), FIELD(word, name##__Y), FIELD(word, name##__Z)}
#define COLOUR(word, name) \
    (FIELD(word, name##__RED) << 16 | FIELD(word, name##__GREEN) << 8 | FIELD(word, name##__BLUE))

namespace {

constexpr int MOST_PIXELS = 1280 * 960;
constexpr int MOST_BOUNCES = 1 << RAY_CASTER__CONTROL__REFLECTIONS_bw;
constexpr int LIT = -1, DARK_SIDE = -2; // values of Bounce::shadow
constexpr int VIEW_DISTANCE = 100; // slope along x of a primary ray at scale 1
constexpr int OTHER_AXES[3][2] = {{1, 2}, {0, 2}, {0, 1}}; // u and v of a rectangle, by the axis of its plane

typedef int64_t Vector[3];

// Lengths are in units of 2^-F; F is 0 except for the seed engine. Bounds are inclusive.
struct Rectangle {
    Vector low, high;
    int index, axis;
    int colour, colour_2; // red above green above blue
    int quarters;         // share that reflects, in quarters, 0 to 4
    int kind, cell_bits;  // enum raycaster_pattern; log2 of the cell width
};

// Nearest hit of a ray. The point, in world units, and the distance are fractions with the same denominator. For the
// exact engines the distance is the ray's parameter t from the camera on, for the seed engine the length along x since
// the last mirror.
struct Bounce {
    int64_t winner; // index of the rectangle hit; -1 for none, then only the colour (background) is valid
    int64_t numerator, denominator;
    Vector point;
    int64_t colour; // as seen, in the light or in the dark; red above green above blue
    int64_t quarters;
    int64_t shadow; // LIT, DARK_SIDE, or the first rectangle between the point and the light
};

// Starts at the camera, mirrored in all mirrors so far (exact), or at the hit point on the last mirror (seed).
struct Ray {
    Vector start, slope;
    int64_t mirror_n, mirror_e; // exact: t of the last mirror
    int met;                    // exact: bit per axis, 1 if a plane through the last hit point cannot be hit
};

struct Scene {
    bool run, seed, nearest;
    int fraction_bits, reflections, background;
    Vector camera;
    Vector corner, right, up; // slope in row 0 and column 0, its step per column, and its step per row
    bool light_on;
    Vector light;
    int shade; // share of a colour that is left in the dark, in quarters, 0 to 3
    int visible;
    Rectangle rectangles[MOST_RECTANGLES];
};

uint32_t words[1024];
uint8_t picture[3 * MOST_PIXELS];
Scene scene;
Bounce path[MOST_BOUNCES];

int64_t magnitude(int64_t value) { return value < 0 ? -value : value; }

// Compute t = n / e at which a ray crosses a rectangle's plane; e is 0 for a parallel ray.
void cross(const Rectangle &r, const Vector &start, const Vector &slope, int64_t &n, int64_t &e) {
    const int64_t along = slope[r.axis], way = r.low[r.axis] - start[r.axis];
    e = magnitude(along), n = along < 0 ? -way : way;
}

// Return whether the point of the ray at t = n / e is within the rectangle's bounds.
bool is_within(const Rectangle &r, const Vector &start, const Vector &slope, int64_t n, int64_t e) {
    for (int u : OTHER_AXES[r.axis]) {
        const int64_t way = slope[u] * n;
        if (way < (r.low[u] - start[u]) * e || way > (r.high[u] - start[u]) * e) return false;
    }
    return true;
}

// No division and no rounding: bounds and parameters t = n / e are compared by cross-multiplication. A reflected ray is
// the straight ray from the mirrored eye, and t continues along it.
const Rectangle *meet_exactly(const Ray &ray, Bounce &bounce) {
    const Rectangle *winner = nullptr;
    int64_t best_n = 1, best_e = 0; // 1 / 0 is beyond every t
    for (const Rectangle *r = scene.rectangles; r != scene.rectangles + scene.visible; r++) {
        int64_t n, e;
        cross(*r, ray.start, ray.slope, n, e);
        // On a tie the lower index wins.
        if (e == 0 || n * best_e >= best_n * e) continue;
        const int64_t beyond = n * ray.mirror_e - ray.mirror_n * e;
        // A ray that hits two planes in one point reflects off both; otherwise closed rooms would have holes.
        if (beyond < 0 || (beyond == 0 && ray.met >> r->axis & 1)) continue;
        if (is_within(*r, ray.start, ray.slope, n, e)) winner = r, best_n = n, best_e = e;
    }
    bounce.numerator = best_n, bounce.denominator = best_e;
    for (int axis = 0; axis < 3; axis++) bounce.point[axis] = ray.start[axis] * best_e + ray.slope[axis] * best_n;
    return winner;
}

// Distances to the point are rounded quotients of magnitudes. One too large for the divider leads out of the world.
const Rectangle *meet_rounded(const Ray &ray, Bounce &bounce) {
    const Rectangle *winner = nullptr;
    bounce.denominator = 1 << scene.fraction_bits;
    for (const Rectangle *r = scene.rectangles; r != scene.rectangles + scene.visible; r++) {
        const int axis = r->axis;
        const int64_t slope = ray.slope[axis], way = r->low[axis] - ray.start[axis];
        if (slope == 0 || way == 0 || (slope < 0) != (way < 0)) continue;
        Vector point;
        point[axis] = r->low[axis];
        bool hit = true;
        for (int u : OTHER_AXES[axis]) {
            const uint32_t dividend = magnitude(ray.slope[u] * way), divisor = magnitude(slope);
            const uint32_t quotient = scene.nearest ? (2 * dividend + divisor) / (2 * divisor) : dividend / divisor;
            point[u] = ray.slope[u] < 0 ? ray.start[u] - quotient : ray.start[u] + quotient;
            hit = hit && r->low[u] <= point[u] && point[u] <= r->high[u];
        }
        const int64_t depth = magnitude(point[0] - ray.start[0]);
        // On a tie the lower index wins.
        if (!hit || (winner && depth >= bounce.numerator)) continue;
        winner = r, bounce.numerator = depth;
        for (int a = 0; a < 3; a++) bounce.point[a] = point[a];
    }
    return winner;
}

int colour_at(const Rectangle &hit, const Bounce &bounce) {
    if (hit.kind == RAYCASTER_PLAIN) return hit.colour;
    const int64_t cell = bounce.denominator << hit.cell_bits;
    const bool odd_u = bounce.point[OTHER_AXES[hit.axis][0]] / cell & 1;
    const bool odd_v = bounce.point[OTHER_AXES[hit.axis][1]] / cell & 1;
    const bool other =
        hit.kind == RAYCASTER_CHECKER ? odd_u != odd_v : hit.kind == RAYCASTER_ROWS ? odd_v : odd_u;
    return other ? hit.colour_2 : hit.colour;
}

// Return the shadow of the point that a ray hit, as in Bounce::shadow. With the point N / e and the light L, the ray
// from the light of slope N - e L meets the point at t = 1 / e. A rectangle at 0 < t < 1 / e is strictly between them.
int shadow_at(const Ray &ray, const Rectangle &hit, const Bounce &bounce) {
    const int64_t side = scene.light[hit.axis] - hit.low[hit.axis], point_e = bounce.denominator;
    if (side == 0 || (side < 0) == (ray.slope[hit.axis] < 0)) return DARK_SIDE;
    // The point is in the world, so each component is at most 511 e, below 2^29.
    Vector slope;
    for (int axis = 0; axis < 3; axis++) slope[axis] = bounce.point[axis] - point_e * scene.light[axis];
    for (const Rectangle *r = scene.rectangles; r != scene.rectangles + scene.visible; r++) {
        int64_t n, e;
        cross(*r, scene.light, slope, n, e);
        if (n > 0 && n * point_e < e && is_within(*r, scene.light, slope, n, e)) return r->index;
    }
    return LIT;
}

int dimmed(int colour) {
    int dark = 0;
    for (int shift = 0; shift <= 16; shift += 8) dark |= (scene.shade * (colour >> shift & 0xff) >> 2) << shift;
    return dark;
}

void reflect(Ray &ray, const Rectangle &hit, const Bounce &bounce) {
    const int axis = hit.axis;
    ray.slope[axis] = -ray.slope[axis];
    if (scene.seed) {
        for (int a = 0; a < 3; a++) ray.start[a] = bounce.point[a];
        return;
    }
    ray.start[axis] = 2 * hit.low[axis] - ray.start[axis];
    const bool same_point = bounce.numerator * ray.mirror_e == ray.mirror_n * bounce.denominator;
    ray.met = (same_point ? ray.met : 0) | 1 << axis;
    ray.mirror_n = bounce.numerator, ray.mirror_e = bounce.denominator;
}

// Fill the path of a pixel's ray, and return its number of bounces: 0 while the design does not run.
int follow(int column, int row) {
    if (!scene.run) return 0;
    Ray ray;
    for (int axis = 0; axis < 3; axis++) {
        ray.start[axis] = scene.camera[axis];
        ray.slope[axis] = scene.corner[axis] + column * scene.right[axis] - row * scene.up[axis];
    }
    // A ray from the camera never hits a plane that it starts on.
    ray.mirror_n = 0, ray.mirror_e = 1, ray.met = 0b111;
    for (int count = 1;; count++) {
        Bounce &bounce = path[count - 1];
        const Rectangle *hit = scene.seed ? meet_rounded(ray, bounce) : meet_exactly(ray, bounce);
        bounce.winner = hit ? hit->index : -1;
        bounce.colour = hit ? colour_at(*hit, bounce) : scene.background;
        bounce.quarters = hit ? hit->quarters : 0;
        bounce.shadow = hit && scene.light_on ? shadow_at(ray, *hit, bounce) : LIT;
        if (bounce.shadow != LIT) bounce.colour = dimmed(bounce.colour);
        if (bounce.quarters == 0 || count > scene.reflections) return count;
        reflect(ray, *hit, bounce);
    }
}

// Return one channel of the path's pixel. A mirror's reflection counts as many quarters as the mirror reflects, and its
// own colour the remaining ones; the last hit shows only its own colour. The sum is rounded only at the end.
int blended(int count, int shift) {
    if (count == 0) return 0;
    int total = path[count - 1].colour >> shift & 0xff;
    for (int after = 0; after < count - 1; after++) {
        const Bounce &mirror = path[count - 2 - after];
        const int own = mirror.colour >> shift & 0xff;
        total = (int)(4 - mirror.quarters) * (own << 2 * after) + (int)mirror.quarters * total;
    }
    return total >> 2 * (count - 1);
}

// Keep the table entries that are enabled and have a plane, on the first axis on which both corners agree.
void read_rectangles(int count, bool materials, bool patterns) {
    scene.visible = 0;
    for (int index = 0; index < count; index++) {
        ray_caster__rectangle_t entry;
        __builtin_memcpy(&entry, &WORD(rectangle) + index * sizeof entry / sizeof(uint32_t), sizeof entry);
        const int first[] = VECTOR(entry.corner_0, RECTANGLE__CORNER);
        const int second[] = VECTOR(entry.corner_1, RECTANGLE__CORNER);
        Rectangle &r = scene.rectangles[scene.visible];
        r.index = index, r.axis = -1;
        for (int axis = 2; axis >= 0; axis--) {
            const bool ordered = first[axis] < second[axis];
            r.low[axis] = (ordered ? first : second)[axis] << scene.fraction_bits;
            r.high[axis] = (ordered ? second : first)[axis] << scene.fraction_bits;
            if (first[axis] == second[axis]) r.axis = axis;
        }
        r.colour = COLOUR(entry.surface, RECTANGLE__SURFACE);
        r.colour_2 = COLOUR(entry.pattern, RECTANGLE__PATTERN);
        const int mirror = FIELD(entry.surface, RECTANGLE__SURFACE__MIRROR);
        r.quarters = !materials ? 2 : mirror > 4 ? 4 : mirror;
        r.kind = patterns ? FIELD(entry.pattern, RECTANGLE__PATTERN__KIND) : RAYCASTER_PLAIN;
        r.cell_bits = FIELD(entry.pattern, RECTANGLE__PATTERN__CELL) + 3;
        if (FIELD(entry.surface, RECTANGLE__SURFACE__ENABLE) && r.axis >= 0) scene.visible++;
    }
}

void read_camera(bool turn, int columns, int horizon_row, int scale) {
    const int camera[] = VECTOR(WORD(camera), CAMERA);
    const int vectors[3][3] = {VECTOR(WORD(forward), FORWARD), VECTOR(WORD(right), RIGHT), VECTOR(WORD(up), UP)};
    const int sign = 1 << (RAY_CASTER__FORWARD__X_bw - 1);
    for (int axis = 0; axis < 3; axis++) {
        int basis[3];
        // Only ratios of a slope's components matter, so the basis of a camera that does not turn needs no scale.
        for (int i = 0; i < 3; i++) basis[i] = turn ? (vectors[i][axis] ^ sign) - sign : i == axis;
        scene.camera[axis] = camera[axis] << scene.fraction_bits;
        scene.right[axis] = basis[1];
        scene.up[axis] = basis[2];
        scene.corner[axis] = VIEW_DISTANCE * scale * basis[0] - columns / 2 * basis[1] + horizon_row * basis[2];
    }
}

void read_light(bool has_light) {
    const int position[] = VECTOR(WORD(light), LIGHT);
    for (int axis = 0; axis < 3; axis++) scene.light[axis] = position[axis];
    scene.light_on = has_light && FIELD(WORD(light), LIGHT__ON);
    scene.shade = FIELD(WORD(light), LIGHT__SHADE);
}

} // namespace

EXPORT(golden_words) uint32_t *golden_words() { return words; }
EXPORT(golden_picture) uint8_t *golden_picture() { return picture; }
EXPORT(golden_bounces) int64_t *golden_bounces() { return &path[0].winner; }

// Draw the picture that a design must show.
//
// engine: enum raycaster_engine. rectangles: number of table entries. materials, patterns, turn, light: 1 if the design
// has the feature; registers of other features are ignored. columns, rows, horizon_row: size of the picture in rays,
// and the horizon's row. scale: scale of the picture. fraction_bits, nearest: arithmetic of the seed engine.
// colour_bits: bits per channel at the pins; the lower bits are 0. The number of reflections comes from the control
// register, and must not exceed the number that the design computes.
EXPORT(golden_draw)
void golden_draw(
    int engine, int rectangles, int materials, int patterns, int turn, int light, int columns, int rows,
    int horizon_row, int scale, int fraction_bits, int nearest, int colour_bits) {
    if (columns * rows > MOST_PIXELS || rectangles > MOST_RECTANGLES) __builtin_trap();
    scene.run = FIELD(WORD(control), CONTROL__RUN);
    scene.reflections = FIELD(WORD(control), CONTROL__REFLECTIONS);
    scene.background = COLOUR(WORD(background), BACKGROUND);
    scene.seed = engine == RAYCASTER_SEED;
    scene.fraction_bits = scene.seed ? fraction_bits : 0;
    scene.nearest = nearest;
    read_rectangles(rectangles, materials, patterns);
    read_camera(turn, columns, horizon_row, scale);
    read_light(light);
    const int kept = 0xff00 >> colour_bits & 0xff;
    uint8_t *channel = picture;
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++) {
            const int count = follow(column, row);
            for (int shift = 16; shift >= 0; shift -= 8) *channel++ = blended(count, shift) & kept;
        }
}

// Fill golden_bounces() for a pixel of the last drawing, and return their number: 0 while the design does not run.
EXPORT(golden_ray) int golden_ray(int column, int row) { return follow(column, row); }
