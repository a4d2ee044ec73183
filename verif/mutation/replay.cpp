// SPDX-License-Identifier: MIT
// Replays a leaf test's vectors on every mutant of a netlist, and reports which mutants the vectors detect.
// Arguments: the file of vectors, the first cycle whose outputs count, the number of mutants.
// Selector 0 is the netlist without a fault.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "Vreplay.h"
#include "verilated.h"

namespace {

struct Cycle {
    uint32_t in[IN_WORDS], out[OUT_WORDS];
};

std::vector<Cycle> read(const char* path) {
    std::vector<Cycle> cycles;
    FILE* file = std::fopen(path, "r");
    if (!file) {
        std::perror(path);
        std::exit(2);
    }
    Cycle cycle;
    for (;;) {
        int found = 0;
        for (auto& word : cycle.in) found += std::fscanf(file, "%x", &word) == 1;
        for (auto& word : cycle.out) found += std::fscanf(file, "%x", &word) == 1;
        if (found != IN_WORDS + OUT_WORDS) break;
        cycles.push_back(cycle);
    }
    std::fclose(file);
    return cycles;
}

// Verilator's initial registers and undefined values: all zeros, all ones, or random with the seed. A result that
// depends on an unknown value differs in one of these.
struct Start {
    int reset, seed;
};
const Start starts[] = {{0, 1}, {1, 2}, {2, 3}, {2, 4}};

// Returns the first cycle with unexpected outputs, or -1.
long first_difference(const std::vector<Cycle>& cycles, size_t settled, unsigned selector, Start start) {
    VerilatedContext context;
    context.randReset(start.reset);
    context.randSeed(start.seed);
    const auto dut = std::make_unique<Vreplay>(&context);
    dut->clk = 0;
    dut->selector = selector;
    for (size_t number = 0; number < cycles.size(); number++) {
        for (int word = 0; word < IN_WORDS; word++) dut->in[word] = cycles[number].in[word];
        dut->eval();
        if (number >= settled)
            for (int word = 0; word < OUT_WORDS; word++)
                if (dut->out[word] != cycles[number].out[word]) return static_cast<long>(number);
        dut->clk = 1;
        dut->eval();
        dut->clk = 0;
        dut->eval();
    }
    return -1;
}

}  // namespace

int main(int, char** argv) {
    const std::vector<Cycle> cycles = read(argv[1]);
    const size_t settled = std::strtoul(argv[2], nullptr, 10);
    const unsigned mutants = std::strtoul(argv[3], nullptr, 10);
    std::printf("cycles %zu\n", cycles.size());
    for (unsigned selector = 0; selector <= mutants; selector++) {
        long cycle = -1;
        for (const Start start : starts)
            if (cycle < 0) cycle = first_difference(cycles, settled, selector, start);
        std::printf("%u %ld\n", selector, cycle);
        std::fflush(stdout);
    }
}
