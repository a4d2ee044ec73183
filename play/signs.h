// SPDX-License-Identifier: MIT
// Verilator's sign extension and signed comparison of words narrower than 32 bits, in fewer instructions than its own.

#ifndef SIGNS_H
#define SIGNS_H

#include "verilated.h"

// The value's sign is the word's, and so is its order.
inline int32_t to_top(int bits, IData value) { return static_cast<int32_t>(value << (32 - bits)); }

#define VL_EXTENDS_II(wide, bits, value) (static_cast<IData>(to_top(bits, value) >> (32 - (bits))))
#define VL_LTS_III(bits, left, right) (static_cast<IData>(to_top(bits, left) < to_top(bits, right)))
#define VL_GTS_III(bits, left, right) (static_cast<IData>(to_top(bits, left) > to_top(bits, right)))

#endif
