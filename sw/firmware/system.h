// SPDX-License-Identifier: MIT
// The memory map of the system with a PicoRV32, for C, for the linker script and for the build: numbers only.

#ifndef SYSTEM_H
#define SYSTEM_H

#define SYSTEM_RAM_BASE 0x00000000 // the program starts here
#define SYSTEM_RAM_BYTES 0x8000

#define SYSTEM_RAYCASTER_BASE 0x80000000

#define SYSTEM_BUTTONS_BASE 0x90000000 // read: bits of enum game_button that are held

#define SYSTEM_UART_BASE 0x90000010 // write: a byte to send; read: SYSTEM_UART_BUSY
#define SYSTEM_UART_BUSY 0x1

#endif
