// SPDX-License-Identifier: MIT
// Stand-ins for system features that Verilator's library needs and WebAssembly lacks. Threads: there is only one, so
// locks do nothing. Files: there is only one, the processor's program, and any name opens it.

#ifndef SHIM_H
#define SHIM_H

#include <chrono>
#include <cstdio>
#include <cstring>
#include <istream>

inline char *program_text = nullptr;

#define VL_IGNORE_UNKNOWN_ARCH
#ifndef CLOCK_PROCESS_CPUTIME_ID
#define CLOCK_PROCESS_CPUTIME_ID CLOCK_MONOTONIC
#endif

namespace std {

inline FILE *open_program(const char *, const char *mode) {
    return program_text ? fmemopen(program_text, strlen(program_text), mode) : nullptr;
}

class mutex {
public:
    void lock() {}
    bool try_lock() { return true; }
    void unlock() {}
};

class recursive_mutex : public mutex {};

class condition_variable {
public:
    void notify_one() {}
    void notify_all() {}
    template <class Lock> void wait(Lock &) {}
    template <class Lock, class Predicate> void wait(Lock &, Predicate) {}
};

class condition_variable_any : public condition_variable {};

class thread {
public:
    class id {
    public:
        bool operator==(const id &) const { return true; }
        bool operator!=(const id &) const { return false; }
        bool operator<(const id &) const { return false; }
    };
    thread() = default;
    template <class... Arguments> explicit thread(Arguments &&...) {}
    bool joinable() const { return false; }
    void join() {}
    static unsigned hardware_concurrency() { return 1; }
};

namespace this_thread {
inline thread::id get_id() { return {}; }
inline void yield() {}
} // namespace this_thread

// A stream that opens no file.
template <> class basic_ifstream<char> : public istream {
public:
    template <class Name> explicit basic_ifstream(Name &&) : istream(nullptr) {}
};

} // namespace std

#define fopen open_program

#endif
