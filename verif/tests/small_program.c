// SPDX-License-Identifier: MIT
// A small program for the processor. It sends `RAYC`, as read from the registers, and shows a scene; sends `M` and `E`,
// if its memory and arithmetic work, then `go` and a newline. Then, in each frame, it moves the camera along y by the
// held buttons, and sends these as a letter from `@` on. The serial port waits by itself.

#include <stddef.h>

#include "raycaster_regs.h"
#include "scene.h"
#include "system.h"

#define WORD(address) (*(volatile uint32_t *)(uintptr_t)(address))
#define REGISTER(name) WORD(SYSTEM_RAYCASTER_BASE + offsetof(ray_caster_t, name))

static volatile uint32_t numbers[] = {7, 13, 200, 9};

static void send(uint32_t letter) {
    WORD(SYSTEM_UART_BASE) = letter;
}

// Write a byte into the last word of the memory; an unmapped address ignores writes and reads 0.
static uint32_t letter_from_memory(void) {
    volatile uint32_t *const last = &WORD(SYSTEM_RAM_BYTES - 4), *const unmapped = &WORD(SYSTEM_BUTTONS_BASE + 8);
    const uint32_t saved = *last;
    *last = 0;
    ((volatile uint8_t *)last)[1] = 'M';
    *unmapped = 'X';
    const uint32_t letter = *last >> 8 | *unmapped;
    *last = saved;
    return letter;
}

int main(void) {
    const uint32_t name = REGISTER(id);
    for (int shift = 24; shift >= 0; shift -= 8) {
        send(name >> shift);
    }
    for (unsigned word = 0; word < sizeof SCENE / sizeof SCENE[0]; ++word) {
        WORD(SYSTEM_RAYCASTER_BASE + 4 * SCENE[word].address) = SCENE[word].word;
    }
    REGISTER(irq_enable) = 1;
    send(letter_from_memory());
    send(numbers[0] * numbers[1] - numbers[2] / numbers[3]);
    send('g');
    send('o');
    send('\n');
    for (uint32_t y = CAMERA_Y;;) {
        uint32_t buttons;
        do {
            buttons = WORD(SYSTEM_BUTTONS_BASE);
        } while ((buttons & INTERRUPT) == 0);
        REGISTER(irq_pending) = 1;
        buttons &= INTERRUPT - 1;
        y += STEP * ((buttons >> 1 & 1) - (buttons & 1));
        REGISTER(camera) = CAMERA_X_AND_Z | y << RAY_CASTER__CAMERA__Y_bp;
        REGISTER(control) = SCENE[sizeof SCENE / sizeof SCENE[0] - 1].word;
        send('@' + buttons);
    }
}
