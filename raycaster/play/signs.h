// SPDX-License-Identifier: MIT
// Replaces Verilator's sign extension and signed comparison of words narrower than 32 bits with fewer instructions.

#ifndef SIGNS_H
#define SIGNS_H

#include "verilated.h"

// Shifts a value to the top of a word, which then has the value's sign and order.
inline int32_t to_top(int bits, IData value) { return static_cast<int32_t>(value << (32 - bits)); }

#define VL_EXTENDS_II(wide, bits, value) (static_cast<IData>(to_top(bits, value) >> (32 - (bits))))
#define VL_LTS_III(bits, left, right) (static_cast<IData>(to_top(bits, left) < to_top(bits, right)))
#define VL_GTS_III(bits, left, right) (static_cast<IData>(to_top(bits, left) > to_top(bits, right)))

#endif
