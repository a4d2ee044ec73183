// SPDX-License-Identifier: MIT
// Squash in a court of mirrors. The ball must hit the golden tile on the back wall. It passes through a dark veil in
// front of the wall, behind which only the mirrors show where ball and tile are.
//
// The same seed and the same buttons give the same frames. The game reaches the hardware only through the driver.

#ifndef GAME_H
#define GAME_H

#include <stdbool.h>
#include <stdint.h>

#include "raycaster.h"

enum game_button { GAME_LEFT = 1, GAME_RIGHT = 2, GAME_UP = 4, GAME_DOWN = 8, GAME_FIRE = 16 };

// What happened in a frame.
enum game_event {
    GAME_STARTED = 1,
    GAME_RETURNED = 2, // the racket hit the ball
    GAME_TILE = 4,     // the ball hit the tile
    GAME_LEVEL = 8,    // the level rose
    GAME_MISSED = 16,
    GAME_ENDED = 32
};

enum game_phase { GAME_SERVE, GAME_RALLY, GAME_PAST, GAME_OVER };

enum game_entry {
    GAME_BALL,
    GAME_RACKET,
    GAME_LINE,
    GAME_VEIL,
    GAME_TARGET,
    GAME_LIVES_BAR,
    GAME_SCORE_BAR,
    GAME_FLOOR,
    GAME_CEILING,
    GAME_LEFT_WALL,
    GAME_RIGHT_WALL,
    GAME_BACK_WALL,
    GAME_RECTANGLES
};

enum {
    GAME_REFLECTIONS = 1,
    GAME_SEED = 2013, // of the firmware and of demo.txt
};

// A position or a velocity; for the ball in 256ths of a unit.
struct game_vector {
    int32_t x;
    int32_t y;
    int32_t z;
};

// An entry of the rectangle table.
struct game_rectangle {
    struct raycaster_point low;
    struct raycaster_point high;
    struct raycaster_colour colour;
    bool enabled;
};

struct game {
    enum game_phase phase;
    bool attract; // plays by itself
    uint8_t lives;
    uint8_t level; // from 1 on
    uint8_t tiles; // hit in this level
    uint32_t score;
    uint32_t random;
    uint32_t age; // frames in this phase
    uint32_t held; // buttons of the previous frame
    uint32_t sway; // frames that the veil has moved
    uint32_t racket_flash; // frames left of each effect
    uint32_t tile_flash;
    uint32_t alarm;
    struct game_vector ball;
    struct game_vector velocity;
    struct game_vector racket; // its centre in whole units, as for target and veil
    struct game_vector target;
    struct game_vector veil;
    int32_t turn; // degrees that the player looks to the right
    bool drawn; // the registers hold the fields below
    int32_t shown_turn;
    struct raycaster_point camera;
    struct game_rectangle shown[GAME_RECTANGLES];
};

void game_init(struct game *game, uint32_t seed);

// One frame, with the buttons that are held: bits of enum game_button. Returns bits of enum game_event.
unsigned game_step(struct game *game, unsigned buttons);

// Return the buttons that a good player would hold now.
unsigned game_autoplay(const struct game *game);

// Write what has changed; the caller commits. After an error the next call writes everything again.
enum raycaster_error game_draw(struct game *game, const struct raycaster *device);

#endif
