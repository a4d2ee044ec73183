# SPDX-License-Identifier: MIT
"""Blocks whose arguments differ are modules that differ; equal ones share a module."""

import pickle
from functools import partial
from itertools import combinations_with_replacement

import numpy as np
import pytest
from hdl_blocks import Mirrored, Pair, another_inverted, chosen_part, inverted, step
from myhdl import ResetSignal, Signal, always, always_seq, block, intbv

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, bit, signed, unconnected, unsigned


class Mode:
    """Parameter whose representation hides its value."""

    def __init__(self, number: int):
        self.number = number

    def __repr__(self):
        return "a mode"


class Alike(Mode):
    """Parameter that says that it equals each other one."""

    __hash__ = None

    def __eq__(self, other: object):
        return True


class Late(Interface):
    """A signal and a constant to add to it."""

    def __init__(self, value, amount):
        self.value, self.amount = value, amount


@block
def offset(clk, reset, late, moved):
    """moved = value + a number that depends on the value's range and on the amount, modulo 256."""
    value = late.value
    step_by = sum(pickle.dumps((value.max, late.amount)))

    @always_seq(clk.posedge, reset=reset)
    def work():
        moved.next = (value + step_by) % 256

    return (work,)


@block
def begun(clk, value, moved, kind):
    """moved = a register, a word and a number, of which one depends on the value's initial value."""
    start, other = int(value.val), 9
    register = Signal(intbv(start if kind == "register" else other)[8:])
    words = [Signal(intbv(start if kind == "words" else other + n)[8:]) for n in range(2)]
    number = start if kind == "number" else other

    @always(clk.posedge)
    def work():
        if register[0]:
            register.next = value
        moved.next = register ^ number ^ words[value[0]]

    return (work,)


class Ports(Interface):
    """Arguments, of which only those that are used become ports."""

    def __init__(self):
        self.clk, self.flag, self.nibble, self.other = bit(), bit(), unsigned(4), unsigned(4)
        self.narrow, self.digit, self.signed = unsigned(1), Signal(intbv(0, min=0, max=10)), signed(4)
        self.high, self.low = (ResetSignal(0, active=level, isasync=False) for level in (1, 0))
        self.pair, self.mirrored = Pair(), Mirrored()
        self.halves, self.same, self.thin = (Record({"high": high, "low": 8 - high}) for high in (4, 4, 2))
        self.first, self.second, self.third = (Signal(intbv(initial)[8:]) for initial in (3, 3, 5))
        self.one, self.two = unsigned(4), unsigned(4)
        self.wide_one, self.wide_two = unsigned(8), unsigned(8)


def offsets(x, amounts=(1, 1), values=("nibble",) * 2, resets=("high",) * 2, outputs=("first", "second")):
    """Return two instances to make of `offset`, with the names of their signals in the ports."""
    parts = [[getattr(x, name) for name in names] for names in (resets, values, outputs)]
    return [
        (offset, x.clk, reset, Late(value, amount), moved)
        for amount, reset, value, moved in zip(amounts, *parts, strict=True)
    ]


PEAK = np.eye(1, 3000, 1500)[0]
ONE = Mode(1)
ALIKE = [
    *(partial(offsets, amounts=amounts) for amounts in ((1, 1), (ONE, ONE), ((0, 0), (0, 0)))),
    partial(offsets, resets=("low", "low")),
    lambda x: ((chosen_part, x.halves, x.one), (chosen_part, x.same, x.two)),
    lambda x: ((inverted, x.halves.high, x.one), (inverted, x.halves.low, x.two)),
    lambda x: ((begun, x.clk, x.first, x.wide_one, "register"), (begun, x.clk, x.second, x.wide_two, "register")),
]
APART = [
    *(
        partial(offsets, amounts=amounts)
        for amounts in [(1, 2), (1, True), (0, False), (ONE, Mode(2)), (Alike(1), Alike(2)), (PEAK, 2 * PEAK),
                        ((0, 0), (0, 0, 0)), ((1, 0), (True, 0)), (1, Signed(1)), (0.0, -0.0)]
    ),
    partial(offsets, resets=("low", "high")),
    partial(offsets, outputs=("first", "third")),
    # One signal at two ports.
    lambda x: (
        (step, x.clk, x.nibble, x.nibble, x.one, unconnected(1)),
        (step, x.clk, x.nibble, x.other, x.two, unconnected(1)),
    ),
    lambda x: ((chosen_part, x.pair, x.one), (chosen_part, x.mirrored, x.two)),
    lambda x: ((chosen_part, x.halves, x.one), (chosen_part, x.thin, x.two)),
    lambda x: ((inverted, x.nibble, x.one), (another_inverted, x.nibble, x.two)),
]  # fmt: skip
for kind in ("register", "words", "number"):
    APART.append(
        lambda x, kind=kind: ((begun, x.clk, x.first, x.wide_one, kind), (begun, x.clk, x.third, x.wide_two, kind))
    )
for values in combinations_with_replacement(("nibble", "digit", "flag", "narrow", "signed"), 2):
    (ALIKE if values[0] == values[1] else APART).append(partial(offsets, values=values))


@block
def in_pairs(x, instances):
    """Instantiate a block twice, or two blocks, with arguments that differ in one thing."""
    (one, *ones), (two, *twos) = instances(x)
    some, others = one(*ones), two(*twos)

    return some, others


@pytest.mark.parametrize(
    ("instances", "apart"), [(instances, kind is APART) for kind in (ALIKE, APART) for instances in kind]
)
def test_arguments_that_differ_make_modules_that_differ(instances, apart, tmp_path, random):
    leaf = Leaf(in_pairs, lambda: {"x": Ports(), "instances": instances}, tmp_path)
    name, *more = [module.name for module in leaf.modules]
    assert more == [*[f"{name}_1"] * apart, "in_pairs"]
    assert [*leaf.modules[-1].instances.values()] == [name, f"{name}_1" if apart else name]
    stimulus = []
    for _ in range(20):
        # No input leaves its range.
        inputs = {port: int(random.integers(1 << shape.width)) % 10 for port, shape in leaf.given.items()}
        stimulus += [inputs | dict.fromkeys({"x_clk"} & {*inputs}, phase) for phase in (0, 1)]
    leaf.run_both(stimulus, settled=0 if name == "begun" else 4)
