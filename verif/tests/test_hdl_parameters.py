# SPDX-License-Identifier: MIT
"""Blocks whose arguments differ are modules that differ; equal ones share a module."""

from itertools import combinations_with_replacement

import numpy as np
import pytest
from hdl_blocks import Pair, another_inverted, inverted
from myhdl import ResetSignal, Signal, always_comb, always_seq, block, intbv

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned


class Mode:
    """Parameter whose representation hides its value."""

    def __init__(self, number: int):
        self.number = number

    def __repr__(self):
        return "a mode"


class Late(Interface):
    """A signal and a constant to add to it."""

    def __init__(self, value, amount):
        self.value, self.amount = value, amount


def number_of(value, amount) -> int:
    """Return a number that depends on everything that may distinguish two arguments."""
    if isinstance(amount, Mode):
        return amount.number
    if isinstance(amount, np.ndarray):
        return int(amount[len(amount) // 2])
    return (value.max or 0) + (len(amount) if isinstance(amount, tuple) else 2 * amount + isinstance(amount, bool))


@block
def offset(clk, reset, late, moved):
    """moved = value + a number from the arguments, modulo 256."""
    step_by, value = number_of(late.value, late.amount), late.value

    @always_seq(clk.posedge, reset=reset)
    def work():
        moved.next = (value + step_by) % 256

    return (work,)


@block
def offsets(clk, reset, other_reset, late, later, first, second):
    """Apply two offsets."""
    one = offset(clk, reset, late, first)
    two = offset(clk, other_reset, later, second)

    return one, two


ONE = Mode(1)
PEAK = np.eye(1, 3000, 1500)[0]
AMOUNTS = [(1, 1), (1, 2), (1, True), (0, False), (ONE, ONE), (ONE, Mode(2)), (PEAK, 2 * PEAK), ((0, 0), (0, 0)),
           ((0, 0), (0, 0, 0)), ((1, 0), (True, 0)), (1, Signed(1))]  # fmt: skip
RANGES = [lambda: unsigned(4), lambda: Signal(intbv(0, min=0, max=10)), bit, lambda: unsigned(1), lambda: signed(4)]
PLAIN = {"amounts": (1, 1), "ranges": RANGES[:1] * 2, "initial": (0, 0), "active": (1, 1)}


@pytest.mark.parametrize(
    ("differing", "values", "apart"),
    [("amounts", amounts, number not in (0, 4, 7)) for number, amounts in enumerate(AMOUNTS)]
    + [("ranges", pair, pair[0] is not pair[1]) for pair in combinations_with_replacement(RANGES, 2)]
    + [("initial", (3, 3), False), ("initial", (3, 5), True), ("active", (0, 0), False), ("active", (1, 0), True)],
)
def test_arguments_that_differ_make_modules_that_differ(differing, values, apart, tmp_path):
    amounts, ranges, initial, active = (PLAIN | {differing: values}).values()

    def arguments() -> dict:
        resets = (ResetSignal(0, active=level, isasync=False) for level in active)
        lates = (Late(make(), amount) for make, amount in zip(ranges, amounts, strict=True))
        moved = (Signal(intbv(value)[8:]) for value in initial)
        names = ("clk", "reset", "other_reset", "late", "later", "first", "second")
        return dict(zip(names, (bit(), *resets, *lates, *moved), strict=True))

    leaf = Leaf(offsets, arguments, tmp_path)
    assert leaf.modules[-1].instances == {"offset_0": "offset", "offset_1": "offset_1" if apart else "offset"}
    assert [module.name for module in leaf.modules] == ["offset", *["offset_1"] * apart, "offsets"]
    stimulus = [
        {"reset": active[0] ^ off, "other_reset": active[1] ^ off, "late_value": 1, "later_value": 1}
        for off in (0, 1, 1)
    ]
    outputs = leaf.run_both(stimulus, settled=1)
    assert tuple(outputs[1].values()) == initial
    expected = (1 + number_of(make(), amount) for make, amount in zip(ranges, amounts, strict=True))
    assert tuple(outputs[2].values()) == tuple(expected)


class Mirrored(Pair):
    """Pair that a block can recognise by its class."""


class Halves(Record):
    """A byte in two parts of variable width."""

    def __init__(self, high: int):
        super().__init__({"high": high, "low": 8 - high})


@block
def mix(left, right, mixed):
    """Mix two ports that the conversion might confuse."""

    @always_comb
    def work():
        mixed.next = left ^ right

    return (work,)


@block
def chosen_part(group, part):
    """Select the low half of a `Mirrored`, and the high half of anything else."""
    chosen = group.low if isinstance(group, Mirrored) else group.high

    @always_comb
    def choose():
        part.next = chosen

    return (choose,)


class Inputs(Interface):
    """Arguments, of which only those that are used become ports."""

    def __init__(self):
        self.value, self.other, self.pair, self.mirrored = unsigned(4), unsigned(4), Pair(), Mirrored()
        self.halves, self.same, self.thin = Halves(4), Halves(4), Halves(2)


KINDS = {
    "one signal at two ports": lambda x: ((mix, x.value, x.value), (mix, x.value, x.other)),
    "classes": lambda x: ((chosen_part, x.pair), (chosen_part, x.mirrored)),
    "layouts": lambda x: ((chosen_part, x.halves), (chosen_part, x.thin)),
    "equal layouts": lambda x: ((chosen_part, x.halves), (chosen_part, x.same)),
    "fields": lambda x: ((inverted, x.halves.high), (inverted, x.halves.low)),
    "blocks of one name": lambda x: ((inverted, x.value), (another_inverted, x.value)),
}


@block
def in_pairs(inputs, first, second, kind):
    """Instantiate a block twice, or two blocks, with arguments that differ in one thing."""
    (one, *ones), (two, *twos) = KINDS[kind](inputs)
    some, others = one(*ones, first), two(*twos, second)

    return some, others


@pytest.mark.parametrize(
    ("kind", "modules", "inputs", "outputs"),
    [
        ("one signal at two ports", ["mix", "mix_1"], {"value": 9, "other": 5}, [0, 12]),
        ("classes", ["chosen_part", "chosen_part_1"], {"pair_high": 3, "mirrored_low": 12}, [3, 12]),
        ("layouts", ["chosen_part", "chosen_part_1"], {"halves_high": 6, "thin_high": 2}, [6, 2]),
        ("equal layouts", ["chosen_part"], {"halves_high": 6, "same_high": 9}, [6, 9]),
        ("fields", ["inverted"], {"halves_high": 5, "halves_low": 12}, [10, 3]),
        ("blocks of one name", ["inverted", "inverted_1"], {"value": 6}, [9, 7]),
    ],
)
def test_what_makes_two_modules(kind, modules, inputs, outputs, tmp_path):
    def arguments() -> dict:
        return {"inputs": Inputs(), "first": unsigned(4), "second": unsigned(4), "kind": kind}

    leaf = Leaf(in_pairs, arguments, tmp_path)
    assert [module.name for module in leaf.modules] == [*modules, "in_pairs"]
    assert list(leaf.modules[-1].instances.values()) == [modules[0], modules[-1]]
    stimulus = {f"inputs_{name}": value for name, value in inputs.items()}
    assert list(leaf.run_both([stimulus])[-1].values()) == outputs
