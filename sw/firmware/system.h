// SPDX-License-Identifier: MIT
// Written by `make registers` from raycaster/memory_map.py, which explains it.

#ifndef SYSTEM_H
#define SYSTEM_H

#define SYSTEM_RAM_BASE 0x0
#define SYSTEM_RAM_BYTES 0x8000
#define SYSTEM_RAYCASTER_BASE 0x80000000
#define SYSTEM_BUTTONS_BASE 0x90000000
#define SYSTEM_UART_BASE 0x90000010
#define SYSTEM_UART_BUSY 0x1

#endif
