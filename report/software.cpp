// SPDX-License-Identifier: MIT
// Draw a picture in software, with the arithmetic of golden/exact.py. Read the scene as numbers from stdin, write the
// pixels to stdout, and the seconds per frame to stderr.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

typedef int64_t number;

struct Rectangle {
    number axis, low[3], high[3], colour[3], colour_2[3], kind, cell, mirror;
};

static const int OTHERS[3][2] = {{1, 2}, {0, 2}, {0, 1}};

static number in() {
    long long value;
    if (std::scanf("%lld", &value) != 1) std::abort();
    return value;
}

static number floored(number a, number b) { return a / b - (a % b < 0); }

// Colour of the hit rectangle's pattern at a point whose coordinates are multiplied by e > 0.
static const number* seen_of(const Rectangle& hit, const number* point, number e) {
    if (!hit.kind) return hit.colour;
    const int* others = OTHERS[hit.axis];
    const bool u = floored(point[others[0]], e * hit.cell) & 1, v = floored(point[others[1]], e * hit.cell) & 1;
    return (hit.kind == 1 ? u != v : hit.kind == 2 ? v : u) ? hit.colour_2 : hit.colour;
}

int main() {
    const number columns = in(), rows = in(), view = in(), centre = in(), horizon = in(), reflections = in(), frames = in();
    number camera[3], background[3];
    for (number& one : camera) one = in();
    for (number& one : background) one = in();
    std::vector<Rectangle> rectangles(in());
    for (Rectangle& one : rectangles) {
        one.axis = in();
        for (number* field : {one.low, one.high, one.colour, one.colour_2})
            for (int i = 0; i < 3; i++) field[i] = in();
        one.kind = in();
        one.cell = in();
        one.mirror = in();
    }
    std::vector<unsigned char> picture(3 * columns * rows);
    const auto start = std::chrono::steady_clock::now();
    for (number frame = 0; frame < frames; frame++)
        for (number row = 0; row < rows; row++)
            for (number column = 0; column < columns; column++) {
                number eye[3] = {camera[0], camera[1], camera[2]}, slope[3] = {view, column - centre, horizon - row};
                number mirror_n = 0, mirror_e = 1, weight[8];
                const number* seen[8];
                bool met[3] = {true, true, true};
                number depth = 0;
                for (;; depth++) {
                    const Rectangle* winner = nullptr;
                    number best_n = 1, best_e = 0;
                    for (const Rectangle& one : rectangles) {
                        const number a = one.axis, e = std::llabs(slope[a]);
                        const number n = (one.low[a] - eye[a]) * (slope[a] < 0 ? -1 : slope[a] > 0);
                        const number along = n * mirror_e, along_mirror = mirror_n * e;
                        bool hit = e > 0 && (along > along_mirror || (along == along_mirror && !met[a]));
                        for (int u : OTHERS[a]) {
                            const number way = slope[u] * n;
                            hit = hit && (one.low[u] - eye[u]) * e <= way && way <= (one.high[u] - eye[u]) * e;
                        }
                        if (hit && n * best_e < best_n * e) {
                            winner = &one;
                            best_n = n;
                            best_e = e;
                        }
                    }
                    weight[depth] = winner ? winner->mirror : 0;
                    number point[3];
                    for (int i = 0; i < 3; i++) point[i] = eye[i] * best_e + slope[i] * best_n;
                    seen[depth] = winner ? seen_of(*winner, point, best_e) : background;
                    if (depth == reflections || !weight[depth]) break;
                    for (bool& one : met) one = one && best_n * mirror_e == mirror_n * best_e;
                    const number a = winner->axis;
                    eye[a] = 2 * winner->low[a] - eye[a];
                    slope[a] = -slope[a];
                    met[a] = true;
                    mirror_n = best_n;
                    mirror_e = best_e;
                }
                for (int channel = 0; channel < 3; channel++) {
                    number total = seen[depth][channel], scale = 1;
                    for (number i = depth; i-- > 0; scale *= 4)
                        total = (4 - weight[i]) * seen[i][channel] * scale + weight[i] * total;
                    picture[3 * (row * columns + column) + channel] = total / scale;
                }
            }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::fprintf(stderr, "%.6f\n", took.count() / frames);
    std::fwrite(picture.data(), 1, picture.size(), stdout);
}
