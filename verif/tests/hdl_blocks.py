# SPDX-License-Identifier: MIT
"""Blocks of the tests of `raycaster.hdl`."""

from pathlib import Path

import numpy as np
from myhdl import ConcatSignal, always, always_comb, block

from raycaster.hdl.hierarchy import Module, convert_hierarchy
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, bit, tied, unconnected, unsigned


class Pair(Interface):
    """Two nibbles."""

    def __init__(self):
        self.high, self.low = unsigned(4), unsigned(4)


class Packed(Record):
    """Record with one field of each kind."""

    def __init__(self):
        super().__init__({"flag": 1, "count": 3, "offset": Signed(5)})


@block
def swap(pair, swapped):
    """Swap the nibbles."""

    @always_comb
    def cross():
        swapped.high.next = pair.low
        swapped.low.next = pair.high

    return (cross,)


@block
def step(clk, value, step_by, stepped, wrapped):
    """stepped = value + step_by, one cycle after value and two after step_by; wrapped is the carry."""
    width = len(stepped)
    addend = unsigned(width)
    total = unsigned(width + 1)

    # The step is registered, since a constant never triggers a combinational process.
    @always(clk.posedge)
    def take():
        addend.next = step_by

    # Keep the carry.
    @always_comb
    def add():
        total.next = value + addend

    # A register.
    @always(clk.posedge)
    def keep():
        stepped.next = total[width:]
        wrapped.next = total[width]

    return take, add, keep


@block
def inverted(word, result):
    """~word."""

    @always_comb
    def invert():
        result.next = ~word

    return (invert,)


class Mirrored(Pair):
    """Pair that a block can recognise by its class."""


@block
def chosen_part(group, part):
    """Select the low half of a `Mirrored`, and the high half of anything else."""
    chosen = group.low if isinstance(group, Mirrored) else group.high

    @always_comb
    def choose():
        part.next = chosen

    return (choose,)


@block
def passed_on(word, result):
    """~word, by an instance."""
    inner = inverted(word, result)

    return (inner,)


@block
def another_inverted(word, result):
    """Do something else, with the name and the ports of `inverted`."""

    @always_comb
    def add():
        result.next = (word + 1) % 16

    return (add,)


another_inverted.func.__name__ = "inverted"


@block
def everything(clk, word, pair, joined, swapped, count, part, narrow, inverses):
    """Connect blocks in every way: by slices, joined signals, lists, interfaces and constants, and not at all."""
    halves = [unsigned(4) for _ in range(2)]
    carries = [unconnected(1), unconnected(1)]
    lower, upper = word(4, 0), word(8, 4)
    amounts = [tied(3, 4), tied(15, 4)]
    one = tied(1, 4)
    both = ConcatSignal(*reversed(halves))
    carry = bit()
    total = unsigned(4)
    side_by_side = ConcatSignal(pair.high, pair.low)
    mixed = ConcatSignal(True, pair.high(3, 0), "1010")

    first = step(clk, lower, amounts[0], halves[0], carries[0])
    second = step(clk, upper, amounts[1], halves[1], carries[1])
    third = step(clk, total, one, count, carry)
    # Other blocks read the rest of this slice's signal; of this interface only one signal is read.
    fourth = step(clk, pair.low(2, 0), pair.low(2, 0), narrow, unconnected(1))
    choosing = chosen_part(pair, part)
    crossing = swap(pair, swapped)
    inverting = inverted(side_by_side, inverses[0])
    passing = passed_on(side_by_side, inverses[1])
    mixing = inverted(mixed, inverses[2])
    padding = inverted(ConcatSignal(pair.low, tied(13, 4)), inverses[3])

    # Both halves side by side.
    @always_comb
    def join():
        joined.next = both

    # A process reads an output of an instance.
    @always_comb
    def choose():
        if carry:
            total.next = 0
        else:
            total.next = word[4:]

    return first, second, third, fourth, choosing, crossing, inverting, passing, mixing, padding, join, choose


def everything_arguments() -> dict:
    signals = {"clk": bit(), "word": unsigned(8), "pair": Pair(), "joined": unsigned(8), "swapped": Pair()}
    signals |= {"count": unsigned(4), "part": unsigned(4), "narrow": unsigned(2)}
    return signals | {"inverses": [unsigned(8) for _ in range(4)]}


def converted(top, directory: Path, **options) -> dict[str, Module]:
    directory.mkdir(exist_ok=True)
    return {module.name: module for module in convert_hierarchy(top, directory, "// {module}", **options)}


def random_inputs(leaf: Leaf, random: np.random.Generator, cycles: int) -> list[dict[str, int]]:
    """Return random values of all inputs for some cycles."""
    return [{name: int(random.integers(1 << one.width)) for name, one in leaf.given.items()} for _ in range(cycles)]
