// SPDX-License-Identifier: MIT
// The program of litex_soc.py's processor: it draws three rectangles, and counts the ray tracer's interrupts, one per
// frame, on the LEDs.

#include <stddef.h>

#include "csr.h"
#include "mem.h"
#include "raycaster.h"
#include "raycaster_regs.h"
#include "soc.h"

// Does not compile if LiteX's constants differ from the driver's header.
#define SAME(name, register, constant) typedef char name[offsetof(ray_caster_t, register) == (constant) ? 1 : -1]
SAME(control_is_there, control, RAY_CASTER_CONTROL_OFFSET);
SAME(table_is_there, rectangle, RAY_CASTER_RECTANGLE_0_CORNER_0_OFFSET);

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))
#define FAILED 0x80u

// VexRiscv's own registers: the interrupt mask, and the pending interrupts.
static void look_at_interrupts(uint32_t mask) {
    __asm__ volatile(".option arch, +zicsr\n csrw 0xbc0, %0" : : "r"(mask));
}

static uint32_t interrupts(void) {
    uint32_t pending;
    __asm__ volatile(".option arch, +zicsr\n csrr %0, 0xfc0" : "=r"(pending));
    return pending;
}

static enum raycaster_error draw(struct raycaster *device) {
    static const struct {
        struct raycaster_point low, high;
        struct raycaster_colour colour;
    } RECTANGLES[] = {
        {{300, 60, 0}, {300, 400, 180}, {0x50, 0xa0, 0xff}},
        {{130, 270, 20}, {200, 270, 140}, {0xff, 0x40, 0x20}},
        {{0, 100, 20}, {511, 420, 20}, {0xc8, 0xc8, 0xb4}},
    };
    enum raycaster_error error = raycaster_probe(device, &REGISTER(RAY_CASTER_BASE));
    for (unsigned index = 0; error == RAYCASTER_OK && index < sizeof RECTANGLES / sizeof RECTANGLES[0]; index++) {
        error = raycaster_set_rectangle(
            device, index, RECTANGLES[index].low, RECTANGLES[index].high, RECTANGLES[index].colour);
    }
    if (error == RAYCASTER_OK) {
        error = raycaster_set_camera(device, (struct raycaster_point){20, 250, 40});
    }
    if (error == RAYCASTER_OK) {
        error = raycaster_set_reflections(device, 1);
    }
    if (error == RAYCASTER_OK) {
        raycaster_set_run(device, true);
        error = raycaster_commit(device);
    }
    return error;
}

int main(void) {
    static struct raycaster device;
    const enum raycaster_error error = draw(&device);
    if (error != RAYCASTER_OK) {
        REGISTER(CSR_LEDS_OUT_ADDR) = FAILED | error;
        return 1;
    }
    look_at_interrupts(1u << RAY_CASTER_INTERRUPT);
    REGISTER(CSR_RAY_CASTER_EV_ENABLE_ADDR) = 1;
    raycaster_enable_interrupt(&device, true);
    for (uint32_t frames = 0;;) {
        if (interrupts() != 0 && raycaster_acknowledge(&device)) {
            REGISTER(CSR_LEDS_OUT_ADDR) = ++frames & (FAILED - 1);
        }
    }
}
