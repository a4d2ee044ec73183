# SPDX-License-Identifier: MIT
"""Programs of every kind that the converter accepts do the same in MyHDL, Icarus and Verilator; Yosys reads them."""

import pytest
from hdl_blocks import random_inputs
from myhdl import Signal, always, always_comb, block, enum, instances, intbv

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.sim.simulator import find_tool
from raycaster.tools import run_yosys

PROGRAMS = []
"""Blocks with the makers of their arguments."""


def program(**makers):
    """Return a decorator that makes a block a program; a number is the width of a port, below 0 if it is signed."""

    def add(decorated):
        PROGRAMS.append(pytest.param(block(decorated), makers, id=decorated.__name__))
        return decorated

    return add


def argument(maker):
    """Return a new argument of a program."""
    if not isinstance(maker, int):
        return maker()
    return bit() if maker == 1 else unsigned(maker) if maker > 0 else signed(-maker)


STATES = enum("IDLE", "BUSY", "DONE")


@program(clk=1, step=1, half=lambda: Signal(bool(1)), count=lambda: Signal(intbv(5)[3:]), far=-41, busy=1)
def registers_at_power_up(clk, step, half, count, far, busy):
    state = Signal(STATES.BUSY)
    low = Signal(intbv(-3, min=-8, max=8))
    wide = Signal(intbv(-(1 << 38) - 1, min=-(1 << 39), max=1 << 39))

    @always(clk.posedge)
    def go():
        half.next = not half
        if half and step:
            count.next = (count + 3) % 8
            low.next = -low
            wide.next = -wide
            far.next = wide + low
        if count == 7:
            state.next = STATES.DONE

    @always_comb
    def look():
        busy.next = state == STATES.BUSY

    return instances()


@program(clk=1, index=2, write=1, d=4, alike=4, apart=4, fixed=4)
def memories_at_power_up(clk, index, write, d, alike, apart, fixed):
    sevens = [Signal(intbv(7)[4:]) for _ in range(4)]
    others = [Signal(intbv(3 * n)[4:]) for n in range(4)]
    numbers = [Signal(intbv(15 - n)[4:]) for n in range(4)]

    @always(clk.posedge)
    def fill():
        if write:
            sevens[index].next = d
            others[index].next = d

    @always(clk.posedge)
    def fetch():
        alike.next = sevens[index]

    @always_comb
    def look():
        apart.next = others[index]
        fixed.next = numbers[index]

    return instances()


@pytest.mark.parametrize(("function", "makers"), PROGRAMS)
def test_programs_do_what_myhdl_computes(function, makers, tmp_path, random, monkeypatch):
    leaf = Leaf(function, lambda: {name: argument(maker) for name, maker in makers.items()}, tmp_path)
    stimulus = random_inputs(leaf, random, 300)
    leaf.run_both(stimulus)
    for name, value in find_tool("verilator").environment.items():
        monkeypatch.setenv(name, value)
    leaf._call("verilator", "--lint-only", "-Wno-fatal", *(str(path) for path in leaf.verilog))
    sources = " ".join(path.name for path in leaf.verilog)
    run_yosys(tmp_path, "read", [f"read_verilog {sources}", f"hierarchy -check -top {leaf.modules[-1].name}",
                                 "proc", "check -assert"])  # fmt: skip
