// SPDX-License-Identifier: MIT
// The game on a PicoRV32: each frame it reads the buttons, takes a step and draws a picture. It reports over the UART.

#include <stddef.h>

#include "game/game.h"
#include "raycaster.h"
#include "system.h"

#define REGISTERS(base) ((volatile uint32_t *)(uintptr_t)(base))

// Longer than many frames
enum { POLLS_A_FRAME = 10000000 };

static void put_character(char character) {
    volatile uint32_t *const uart = REGISTERS(SYSTEM_UART_BASE);
    while ((*uart & SYSTEM_UART_BUSY) != 0) {
    }
    *uart = (uint8_t)character;
}

static void put_text(const char *text) {
    while (*text != '\0') {
        put_character(*text++);
    }
}

static void put_number(uint32_t number) {
    char digits[10];
    size_t count = 0;
    do {
        digits[count++] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    while (count != 0) {
        put_character(digits[--count]);
    }
}

static void put_item(const char *text, uint32_t number) {
    put_text(text);
    put_number(number);
}

static void put_line_end(void) {
    put_text("\r\n");
}

static void put_error(const char *where, enum raycaster_error error) {
    put_text(where);
    put_text(": ");
    put_text(raycaster_error_text(error));
    put_line_end();
}

static void put_device(const struct raycaster *device) {
    static const char *const ENGINES[] = {"seed", "exact", "unknown", "span"};
    put_item("RayCaster ", device->major);
    put_item(".", device->minor);
    put_text(", engine ");
    put_text(device->engine < sizeof ENGINES / sizeof ENGINES[0] ? ENGINES[device->engine] : "unknown");
    put_item(", units ", device->units);
    put_item(", rectangles ", device->rectangles);
    put_item(", rows ", device->rows);
    put_item(", reflections ", device->reflections);
    put_item(", scale ", device->scale);
    put_item(", fixed ", device->built_in);
    put_line_end();
}

static void put_events(const struct game *game, unsigned events) {
    if (events & GAME_STARTED) {
        put_text("start");
        put_line_end();
    }
    if (game->attract) {
        return;
    }
    if (events & GAME_LEVEL) {
        put_item("level ", game->level);
        put_line_end();
    }
    if (events & GAME_ENDED) {
        put_item("game over, score ", game->score);
        put_line_end();
    }
}

// Report an error once, however many frames it lasts.
static void put_new_error(enum raycaster_error *last, enum raycaster_error error) {
    if (error != *last && error != RAYCASTER_OK) {
        put_error("ray tracer", error);
    }
    *last = error;
}

static enum raycaster_error show(struct game *game, const struct raycaster *device) {
    enum raycaster_error error = game_draw(game, device);
    if (error == RAYCASTER_OK) {
        error = raycaster_commit(device);
    }
    if (error == RAYCASTER_OK) {
        error = raycaster_check(device);
        raycaster_clear_status(device);
    }
    return error;
}

static enum raycaster_error prepare(struct raycaster *device) {
    enum raycaster_error error = raycaster_probe(device, REGISTERS(SYSTEM_RAYCASTER_BASE));
    if (error != RAYCASTER_OK) {
        return error;
    }
    put_device(device);
    error = raycaster_set_reflections(device, GAME_REFLECTIONS);
    raycaster_set_run(device, true);
    raycaster_clear_status(device);
    return error;
}

int main(void) {
    static struct game game;
    static struct raycaster device;
    enum raycaster_error last = prepare(&device);
    if (last != RAYCASTER_OK) {
        put_error("no game", last);
        return 1;
    }
    game_init(&game, GAME_SEED);
    for (;;) {
        enum raycaster_error error = raycaster_wait_frame(&device, POLLS_A_FRAME);
        if (error == RAYCASTER_OK) {
            put_events(&game, game_step(&game, *REGISTERS(SYSTEM_BUTTONS_BASE)));
            // A late frame delays the last commit; this step is then shown with the next one.
            if (!raycaster_is_committing(&device)) {
                error = show(&game, &device);
            }
        }
        put_new_error(&last, error);
    }
}
