// SPDX-License-Identifier: MIT
// The main program of Verilator's models, instead of cocotb's lib/verilator/verilator.cpp; it keeps the regions.
//
// cocotb's main program checks ten times per time slot whether a callback is due. As Python does not drive the clock,
// it only waits for a value to change in nearly all slots: here these take one evaluation and one check. The clock is
// also toggled here: in the bench it would be a coroutine, which makes the model evaluate once more at each edge.

#include <algorithm>
#include <memory>
#include <string>

#include "Vtop.h"
#include "verilated.h"
#include "verilated_vpi.h"

#if VM_TRACE_FST
#include "verilated_fst_c.h"
using Trace = VerilatedFstC;
#elif VM_TRACE
#include "verilated_vcd_c.h"
using Trace = VerilatedVcdC;
#else
struct Trace {};
#endif

static constexpr int HALF_PERIOD_NS = 10;  // the same as the benches' own clocks in other simulators

static QData now = 0;  // in units of the time precision

double sc_time_stamp() { return now; }

extern "C" void vlog_startup_routines_bootstrap(void);

// Runs the callbacks of changed values until nothing changes any more; returns true if any ran.
static bool call_value_callbacks() {
    bool called = false;
    while (VerilatedVpi::callValueCbs()) called = true;
    return called;
}

int main(int argc, char** argv) {
    Verilated::commandArgs(argc, argv);
    Verilated::fatalOnVpiError(false);  // cocotb asks for objects that may not exist
    const std::unique_ptr<Vtop> top{new Vtop{""}};

    const std::unique_ptr<Trace> trace{new Trace};
#if VM_TRACE
    Verilated::traceEverOn(true);
    for (int i = 1; i + 1 < argc; ++i) {
        if (std::string{argv[i]} == "--trace-file") {
            top->trace(trace.get(), 99);
            trace->open(argv[i + 1]);
        }
    }
#endif

    Verilated::addExitCb(
        [](void* trace) {
            VerilatedVpi::callCbs(cbEndOfSimulation);
#if VM_TRACE
            static_cast<Trace*>(trace)->close();
#endif
#if VM_COVERAGE
            VerilatedCov::write();
#endif
        },
        trace.get());
    vlog_startup_routines_bootstrap();
    VerilatedVpi::callCbs(cbStartOfSimulation);
    call_value_callbacks();

    QData half_period = HALF_PERIOD_NS;
    for (int digits = Verilated::threadContextp()->timeprecision(); digits < -9; ++digits) half_period *= 10;
    QData edge = half_period;

    // Only callbacks register callbacks. So while none runs, nothing waits except for values and deadlines.
    bool awake = true;
    while (!Verilated::gotFinish()) {
        do {
            do {
                top->eval_step();
                VerilatedVpi::clearEvalNeeded();
                if (awake) VerilatedVpi::doInertialPuts();
                if (call_value_callbacks()) awake = true;
            } while (VerilatedVpi::evalNeeded());
            if (awake) {
                VerilatedVpi::callCbs(cbReadWriteSynch);
                VerilatedVpi::doInertialPuts();
                call_value_callbacks();
            }
        } while (VerilatedVpi::evalNeeded());
        top->eval_end_step();
        if (awake) VerilatedVpi::callCbs(cbReadOnlySynch);
#if VM_TRACE
        if (trace->isOpen()) trace->dump(now);
#endif

        const QData deadline = VerilatedVpi::cbNextDeadline();
        now = std::min(deadline, edge);
        if (top->eventsPending()) now = std::min<QData>(now, top->nextTimeSlot());
        if (awake || deadline <= now) {
            awake = VerilatedVpi::callCbs(cbNextSimTime);
            awake |= call_value_callbacks();
            awake |= VerilatedVpi::callCbs(cbAfterDelay);
            awake |= call_value_callbacks();
            awake |= VerilatedVpi::hasCbs(cbReadWriteSynch) || VerilatedVpi::hasCbs(cbReadOnlySynch);
        }
        if (now == edge) {
            top->clk = !top->clk;
            edge += half_period;
        }
    }

    top->final();
    Verilated::runExitCallbacks();
    return Verilated::threadContextp()->errorCount() > 0;
}
