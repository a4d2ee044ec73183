// SPDX-License-Identifier: MIT
#include "game.h"

// The court, in units of the world. The view is along x. The court begins where the walls come into view, and its front
// is open, so surfaces that face the player mirror the background. A ray that meets an edge would leave the court there
// and show as a speck. So the distances of ceiling, floor and back from the eye are primes, which keeps the slopes of
// every pixel of 320x240 off the edges, wherever the eye is from side to side.
enum {
    FRONT = 80,
    BACK = 281,
    LEFT = 89,
    RIGHT = 423,
    CEILING = 264,
    MIDDLE = (LEFT + RIGHT) / 2,
    EYE_HEIGHT = 67,
    RACKET_X = 130,
    VEIL_X = 200,
    GONE_X = 50,
};

// Half sizes, from the centre to the edge
enum {
    BALL_SIZE = 13,
    BALL_EDGE = 8, // how far outside a racket or the tile the ball's centre may still hit it
    TARGET_SIZE = 26,
    RACKET_STEP = 5,
    LINE_SIZE = 2,
};

// If the camera turns, the player looks after the ball: one degree per frame, and no further than the court is wide.
enum {
    MOST_TURN = 3,
    UNITS_A_DEGREE = 40, // the ball's distance from the middle, per degree
};

enum {
    LIVES = 3,
    TILES_PER_LEVEL = 4,
    LAST_LEVEL = 9,
    LAST_ATTRACT_LEVEL = 4,
    SERVE_FRAMES = 45,
    OVER_FRAMES = 300,
    OVER_LEAST_FRAMES = 60, // before fire starts a new game, as the player may still be pressing it
    BAR_LOW = CEILING - 36,
    BAR_HIGH = CEILING - 22,
    BAR_START = FRONT + 8,
    BAR_LENGTH = 180,
};

enum { UNIT = 256 };

static const struct raycaster_colour WHITE = {255, 255, 255};
static const struct raycaster_colour BACKGROUND = {196, 160, 138};
static const struct raycaster_colour RACKET_COLOUR = {255, 36, 0};
static const struct raycaster_colour TARGET_COLOUR = {255, 204, 0};
static const struct raycaster_colour VEIL_COLOUR = {20, 6, 44};
static const struct raycaster_colour LINE_COLOUR = {96, 240, 255};
static const struct raycaster_colour LIVES_COLOUR = {255, 32, 80};
static const struct raycaster_colour SCORE_COLOUR = {255, 216, 64};

// Floor, ceiling, left, right and back wall: a court per level, repeating, and the last one for alarm.
enum { COURTS = 4, WALLS = 5 };
static const struct raycaster_colour COURT_COLOURS[COURTS + 1][WALLS] = {
    {{44, 88, 120}, {4, 8, 24}, {16, 72, 120}, {72, 24, 112}, {56, 88, 120}},
    {{40, 104, 84}, {2, 20, 20}, {8, 96, 88}, {24, 56, 120}, {48, 104, 92}},
    {{116, 72, 48}, {28, 8, 4}, {128, 56, 20}, {112, 20, 52}, {120, 76, 56}},
    {{88, 64, 116}, {16, 4, 28}, {108, 28, 112}, {36, 40, 128}, {92, 68, 120}},
    {{140, 24, 24}, {40, 0, 0}, {128, 8, 8}, {128, 8, 8}, {140, 28, 28}},
};

static uint32_t next_random(struct game *game) {
    // Marsaglia's xorshift; never 0.
    game->random ^= game->random << 13;
    game->random ^= game->random >> 17;
    game->random ^= game->random << 5;
    return game->random;
}

// Return at least `low` and less than `high`.
static int32_t random_between(struct game *game, int32_t low, int32_t high) {
    return low + (int32_t)(((next_random(game) & 0xffff) * (uint32_t)(high - low)) >> 16);
}

static int32_t clamp(int32_t value, int32_t low, int32_t high) {
    return value < low ? low : value > high ? high : value;
}

static int32_t magnitude(int32_t value) {
    return value < 0 ? -value : value;
}

// Swing between -reach and reach, one unit per frame.
static int32_t swing(uint32_t frames, int32_t reach) {
    const int32_t place = (int32_t)(frames % (uint32_t)(4 * reach));
    return place < 2 * reach ? place - reach : 3 * reach - place;
}

static int32_t speed(const struct game *game) {
    return 3 * UNIT + (game->level - 1) * (UNIT * 3 / 8);
}

static int32_t racket_width(const struct game *game) {
    return 34 - 2 * game->level;
}

static int32_t racket_height(const struct game *game) {
    return 26 - game->level;
}

static int32_t veil_size(const struct game *game) {
    return 24 + 4 * game->level;
}

static void turn_head(struct game *game) {
    const int32_t aside = game->ball.y / UNIT - MIDDLE;
    const int32_t wanted = clamp(aside / UNITS_A_DEGREE, -MOST_TURN, MOST_TURN);
    game->turn += (wanted > game->turn) - (wanted < game->turn);
}

static void enter(struct game *game, enum game_phase phase) {
    game->phase = phase;
    game->age = 0;
    if (phase == GAME_SERVE) {
        game->ball = (struct game_vector){(BACK - LINE_SIZE) * UNIT, MIDDLE * UNIT, CEILING / 2 * UNIT};
        game->velocity = (struct game_vector){0, 0, 0};
    }
}

static void move_target(struct game *game) {
    game->target.x = BACK;
    game->target.y = random_between(game, LEFT + 2 * TARGET_SIZE, RIGHT - 2 * TARGET_SIZE);
    game->target.z = random_between(game, TARGET_SIZE + 8, CEILING - 3 * TARGET_SIZE);
}

static void move_veil(struct game *game) {
    const int32_t size = veil_size(game);
    game->sway++;
    game->veil.x = VEIL_X;
    game->veil.y = MIDDLE + (game->level > 1 ? swing(game->sway, RIGHT - MIDDLE - size) : 0);
    game->veil.z = CEILING / 2 + (game->level > 2 ? swing(game->sway, CEILING / 2 - size) : 0);
}

static void start(struct game *game, bool attract) {
    game->attract = attract;
    game->lives = LIVES;
    game->level = 1;
    game->tiles = 0;
    game->score = 0;
    game->sway = 0;
    game->alarm = 0;
    game->turn = 0;
    game->racket = (struct game_vector){RACKET_X, MIDDLE, EYE_HEIGHT};
    move_target(game);
    move_veil(game);
    enter(game, GAME_SERVE);
}

void game_init(struct game *game, uint32_t seed) {
    *game = (struct game){.random = seed != 0 ? seed : 1};
    start(game, true);
}

static void serve(struct game *game) {
    const int32_t sideways = speed(game) / 4;
    game->velocity.x = -speed(game);
    game->velocity.y = random_between(game, -sideways, sideways + 1);
    game->velocity.z = random_between(game, -sideways, sideways + 1);
    enter(game, GAME_RALLY);
}

static void move_racket(struct game *game, unsigned buttons) {
    const int32_t width = racket_width(game);
    const int32_t height = racket_height(game);
    const int32_t right = ((buttons & GAME_RIGHT) != 0) - ((buttons & GAME_LEFT) != 0);
    const int32_t up = ((buttons & GAME_UP) != 0) - ((buttons & GAME_DOWN) != 0);
    game->racket.y = clamp(game->racket.y + right * RACKET_STEP, LEFT + width, RIGHT - width);
    game->racket.z = clamp(game->racket.z + up * RACKET_STEP, height, CEILING - height);
}

// Keep a place between two walls: beyond a wall, place and velocity are mirrored.
static void bounce(int32_t *place, int32_t *velocity, int32_t low, int32_t high) {
    if (*place < low) {
        *place = 2 * low - *place;
        *velocity = -*velocity;
    } else if (*place > high) {
        *place = 2 * high - *place;
        *velocity = -*velocity;
    }
}

static void fly(struct game *game) {
    game->ball.x += game->velocity.x;
    game->ball.y += game->velocity.y;
    game->ball.z += game->velocity.z;
    bounce(&game->ball.y, &game->velocity.y, (LEFT + BALL_SIZE) * UNIT, (RIGHT - BALL_SIZE) * UNIT);
    bounce(&game->ball.z, &game->velocity.z, BALL_SIZE * UNIT, (CEILING - BALL_SIZE) * UNIT);
}

static bool meets(const struct game *game, const struct game_vector *what, int32_t width, int32_t height) {
    return magnitude(game->ball.y - what->y * UNIT) <= (width + BALL_EDGE) * UNIT &&
           magnitude(game->ball.z - what->z * UNIT) <= (height + BALL_EDGE) * UNIT;
}

static unsigned hit_tile(struct game *game) {
    unsigned events = GAME_TILE;
    game->score += 10u * game->level;
    game->tile_flash = 8;
    game->tiles++;
    if (game->tiles == TILES_PER_LEVEL) {
        game->tiles = 0;
        game->level++;
        if (game->level > (game->attract ? LAST_ATTRACT_LEVEL : LAST_LEVEL)) {
            game->level = game->attract ? 1 : LAST_LEVEL;
        }
        events |= GAME_LEVEL;
    }
    move_target(game);
    return events;
}

static unsigned reach_back(struct game *game) {
    const unsigned events = meets(game, &game->target, TARGET_SIZE, TARGET_SIZE) ? hit_tile(game) : 0;
    game->ball.x = 2 * (BACK - LINE_SIZE) * UNIT - game->ball.x;
    game->velocity.x = -speed(game);
    return events;
}

static unsigned reach_racket(struct game *game) {
    if (!meets(game, &game->racket, racket_width(game), racket_height(game))) {
        if (!game->attract) {
            game->lives--;
        }
        game->alarm = 24;
        enter(game, GAME_PAST);
        return GAME_MISSED;
    }
    // The further from the racket's middle, the faster the ball goes sideways.
    game->ball.x = 2 * RACKET_X * UNIT - game->ball.x;
    game->velocity.x = speed(game);
    game->velocity.y = (game->ball.y - game->racket.y * UNIT) / 16 * speed(game) / (2 * UNIT);
    game->velocity.z = (game->ball.z - game->racket.z * UNIT) / 16 * speed(game) / (2 * UNIT);
    game->racket_flash = 5;
    game->score++;
    return GAME_RETURNED;
}

static unsigned rally(struct game *game) {
    fly(game);
    if (game->ball.x > (BACK - LINE_SIZE) * UNIT) {
        return reach_back(game);
    }
    return game->ball.x < RACKET_X * UNIT ? reach_racket(game) : 0;
}

static unsigned past(struct game *game) {
    fly(game);
    if (game->ball.x > GONE_X * UNIT) {
        return 0;
    }
    enter(game, game->lives != 0 ? GAME_SERVE : GAME_OVER);
    return game->phase == GAME_OVER ? GAME_ENDED : 0;
}

static void count_down(uint32_t *frames) {
    if (*frames != 0) {
        --*frames;
    }
}

unsigned game_step(struct game *game, unsigned buttons) {
    const bool fire = (buttons & ~game->held & GAME_FIRE) != 0;
    game->held = buttons;
    game->age++;
    count_down(&game->racket_flash);
    count_down(&game->tile_flash);
    count_down(&game->alarm);
    if (fire && (game->attract || (game->phase == GAME_OVER && game->age > OVER_LEAST_FRAMES))) {
        start(game, false);
        return GAME_STARTED;
    }
    if (game->phase == GAME_OVER) {
        if (game->age == OVER_FRAMES) {
            start(game, true);
        }
        return 0;
    }
    move_racket(game, game->attract ? game_autoplay(game) : buttons);
    move_veil(game);
    turn_head(game);
    switch (game->phase) {
    case GAME_SERVE:
        if (fire || game->age == SERVE_FRAMES) {
            serve(game);
        }
        return 0;
    case GAME_RALLY:
        return rally(game);
    default:
        return past(game);
    }
}

// Bounce a place that is beyond two walls back between them.
static int32_t fold(int32_t place, int32_t low, int32_t high) {
    while (place < low || place > high) {
        place = place < low ? 2 * low - place : 2 * high - place;
    }
    return place;
}

// Return the racket's middle on one axis that sends the ball, coming in at `place`, to `target`.
static int32_t aim(int32_t place, int32_t target, int32_t size) {
    // The ball moves sideways by offset * speed / 32 per frame, for (BACK - RACKET_X) / speed frames; speed cancels.
    const int32_t offset = (target - place) * 32 / (BACK - RACKET_X);
    return place - clamp(offset, 4 - size, size - 4);
}

static unsigned steer(int32_t from, int32_t to, unsigned less, unsigned more) {
    if (magnitude(to - from) < RACKET_STEP) {
        return 0;
    }
    return to < from ? less : more;
}

unsigned game_autoplay(const struct game *game) {
    int32_t y = MIDDLE;
    int32_t z = EYE_HEIGHT;
    if (game->phase == GAME_RALLY) {
        const int32_t way = game->velocity.x < 0
                                ? game->ball.x - RACKET_X * UNIT
                                : (2 * (BACK - LINE_SIZE) - RACKET_X) * UNIT - game->ball.x;
        const int32_t frames = way / speed(game);
        y = fold(
                game->ball.y + game->velocity.y * frames, (LEFT + BALL_SIZE) * UNIT, (RIGHT - BALL_SIZE) * UNIT) /
            UNIT;
        z = fold(game->ball.z + game->velocity.z * frames, BALL_SIZE * UNIT, (CEILING - BALL_SIZE) * UNIT) / UNIT;
        y = aim(y, game->target.y, racket_width(game));
        z = aim(z, game->target.z, racket_height(game));
    }
    return steer(game->racket.y, y, GAME_LEFT, GAME_RIGHT) | steer(game->racket.z, z, GAME_DOWN, GAME_UP);
}

static struct game_rectangle rectangle(
    int32_t low_x, int32_t low_y, int32_t low_z, int32_t high_x, int32_t high_y, int32_t high_z,
    struct raycaster_colour colour) {
    return (struct game_rectangle){
        .low = {(uint16_t)low_x, (uint16_t)low_y, (uint16_t)low_z},
        .high = {(uint16_t)high_x, (uint16_t)high_y, (uint16_t)high_z},
        .colour = colour,
        .enabled = true,
    };
}

// A rectangle that faces the player.
static struct game_rectangle facing(
    const struct game_vector *centre, int32_t width, int32_t height, struct raycaster_colour colour) {
    return rectangle(
        centre->x, centre->y - width, centre->z - height, centre->x, centre->y + width, centre->z + height, colour);
}

// A strip of light along a side wall.
static struct game_rectangle bar(int32_t wall, int32_t start_x, int32_t length, struct raycaster_colour colour) {
    struct game_rectangle strip = rectangle(start_x, wall, BAR_LOW, start_x + length, wall, BAR_HIGH, colour);
    strip.enabled = length > 0;
    return strip;
}

static void compose_bars(const struct game *game, struct game_rectangle *scene) {
    if (game->attract) {
        // Running lights show that nobody plays.
        const int32_t place = (int32_t)(game->sway % (BAR_LENGTH / 2)) * 3 / 2;
        scene[GAME_LIVES_BAR] = bar(LEFT, BAR_START + place, BAR_LENGTH / 4, SCORE_COLOUR);
        scene[GAME_SCORE_BAR] = bar(RIGHT, BAR_START + place, BAR_LENGTH / 4, SCORE_COLOUR);
    } else {
        scene[GAME_LIVES_BAR] = bar(LEFT, BAR_START, game->lives * (BAR_LENGTH / LIVES), LIVES_COLOUR);
        scene[GAME_SCORE_BAR] = bar(RIGHT, BAR_START, game->tiles * (BAR_LENGTH / TILES_PER_LEVEL), SCORE_COLOUR);
    }
}

static void compose(const struct game *game, struct game_rectangle *scene) {
    const struct game_vector ball = {game->ball.x / UNIT, game->ball.y / UNIT, game->ball.z / UNIT};
    const bool alarmed = game->alarm != 0 || game->phase == GAME_OVER;
    const struct raycaster_colour *court = COURT_COLOURS[alarmed ? COURTS : (game->level - 1) % COURTS];
    // A waiting ball pulses.
    const int32_t size = game->phase == GAME_SERVE && (game->age & 8) != 0 ? BALL_SIZE - 4 : BALL_SIZE;
    scene[GAME_BALL] = facing(&ball, size, size, WHITE);
    scene[GAME_BALL].enabled = game->phase != GAME_OVER;
    scene[GAME_RACKET] =
        facing(&game->racket, racket_width(game), racket_height(game), game->racket_flash ? WHITE : RACKET_COLOUR);
    // A line on the ceiling, straight above the ball, shows its depth.
    scene[GAME_LINE] =
        rectangle(ball.x - LINE_SIZE, LEFT, CEILING, ball.x + LINE_SIZE, RIGHT, CEILING, LINE_COLOUR);
    scene[GAME_LINE].enabled = scene[GAME_BALL].enabled && ball.x >= FRONT;
    scene[GAME_VEIL] = facing(&game->veil, veil_size(game), veil_size(game), VEIL_COLOUR);
    scene[GAME_TARGET] = facing(&game->target, TARGET_SIZE, TARGET_SIZE, game->tile_flash ? WHITE : TARGET_COLOUR);
    compose_bars(game, scene);
    scene[GAME_FLOOR] = rectangle(FRONT, LEFT, 0, BACK, RIGHT, 0, court[0]);
    scene[GAME_CEILING] = rectangle(FRONT, LEFT, CEILING, BACK, RIGHT, CEILING, court[1]);
    scene[GAME_LEFT_WALL] = rectangle(FRONT, LEFT, 0, BACK, LEFT, CEILING, court[2]);
    scene[GAME_RIGHT_WALL] = rectangle(FRONT, RIGHT, 0, BACK, RIGHT, CEILING, court[3]);
    scene[GAME_BACK_WALL] = rectangle(BACK, LEFT, 0, BACK, RIGHT, CEILING, court[4]);
}

static bool same_point(const struct raycaster_point *a, const struct raycaster_point *b) {
    return a->x == b->x && a->y == b->y && a->z == b->z;
}

static bool same_colour(const struct raycaster_colour *a, const struct raycaster_colour *b) {
    return a->red == b->red && a->green == b->green && a->blue == b->blue;
}

static bool same_rectangle(const struct game_rectangle *a, const struct game_rectangle *b) {
    return a->enabled == b->enabled && same_point(&a->low, &b->low) && same_point(&a->high, &b->high) &&
           same_colour(&a->colour, &b->colour);
}

enum raycaster_error game_draw(struct game *game, const struct raycaster *device) {
    struct game_rectangle scene[GAME_RECTANGLES];
    const bool all = !game->drawn;
    enum raycaster_error error = RAYCASTER_OK;
    compose(game, scene);
    // The player's head follows the racket a little to the sides, and everything shifts with it.
    const struct raycaster_point camera = {0, (uint16_t)(MIDDLE + (game->racket.y - MIDDLE) / 8), EYE_HEIGHT};
    if (all) {
        error = raycaster_set_background(device, BACKGROUND);
    }
    if (error == RAYCASTER_OK && (all || !same_point(&camera, &game->camera))) {
        error = raycaster_set_camera(device, camera);
    }
    game->camera = camera;
    if (error == RAYCASTER_OK && device->turn && (all || game->turn != game->shown_turn)) {
        const struct raycaster_basis basis = raycaster_turned(game->turn, 0, 0);
        error = raycaster_set_basis(device, &basis);
    }
    game->shown_turn = game->turn;
    for (unsigned index = 0; index < GAME_RECTANGLES && error == RAYCASTER_OK; index++) {
        const struct game_rectangle *wanted = &scene[index];
        if (all || !same_rectangle(wanted, &game->shown[index])) {
            error = wanted->enabled
                        ? raycaster_set_rectangle(device, index, wanted->low, wanted->high, wanted->colour)
                        : raycaster_enable_rectangle(device, index, false);
        }
        game->shown[index] = *wanted;
    }
    game->drawn = error == RAYCASTER_OK;
    return error;
}
