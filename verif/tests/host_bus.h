// SPDX-License-Identifier: MIT
// Register access of the driver on the host, through two functions from the test. Include before raycaster.h, and
// compile with -fcommon, so that all sources share the variable.
#pragma once
#include <stdint.h>

struct {
    uint32_t (*read)(uint32_t offset);
    void (*write)(uint32_t offset, uint32_t word);
} host_bus;

#define RAYCASTER_READ(base, offset) ((void)(base), host_bus.read((uint32_t)(offset)))
#define RAYCASTER_WRITE(base, offset, word) ((void)(base), host_bus.write((uint32_t)(offset), (word)))
