// SPDX-License-Identifier: MIT
// Register access of the driver: over the simulated bus.

#ifndef BUS_H
#define BUS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

uint32_t bus_read(uint32_t offset);
void bus_write(uint32_t offset, uint32_t word);

#ifdef __cplusplus
}
#endif

#define RAYCASTER_READ(base, offset) bus_read(offset)
#define RAYCASTER_WRITE(base, offset, word) bus_write(offset, word)

#endif
