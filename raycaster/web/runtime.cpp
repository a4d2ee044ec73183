// SPDX-License-Identifier: MIT
// Verilator's library, for a system without threads.

#include <verilated.cpp>
#include <verilated_threads.h>

VlThreadPool::VlThreadPool(VerilatedContext *, unsigned) {}
VlThreadPool::~VlThreadPool() {}

extern "C" int __cxa_atexit(void (*)(void *), void *, void *);
extern "C" int __cxa_thread_atexit(void (*function)(void *), void *object, void *handle) {
    return __cxa_atexit(function, object, handle);
}
