# SPDX-License-Identifier: MIT
"""Blocks of the tests of `raycaster.hdl`."""

from pathlib import Path

from myhdl import ConcatSignal, always, always_comb, block

from raycaster.hdl.hierarchy import Module, convert_hierarchy
from raycaster.hdl.records import Interface
from raycaster.hdl.signals import bit, tied, unconnected, unsigned


class Pair(Interface):
    """Two nibbles."""

    def __init__(self):
        self.high, self.low = unsigned(4), unsigned(4)


@block
def swap(pair, swapped):
    """Swap the nibbles."""

    @always_comb
    def cross():
        swapped.high.next = pair.low
        swapped.low.next = pair.high

    return (cross,)


@block
def step(clk, value, step_by, stepped, wrapped, gain=1):
    """stepped = value + gain * step_by, one cycle after value and two after step_by; wrapped is the carry."""
    width = len(stepped)
    limit = 1 << width
    product = unsigned(width)
    total = unsigned(width + 1)

    # The step is registered, since a constant never triggers a combinational process.
    @always(clk.posedge)
    def multiply():
        product.next = (step_by * gain) % limit

    # Keep the carry.
    @always_comb
    def add():
        total.next = value + product

    # A register.
    @always(clk.posedge)
    def keep():
        stepped.next = total[width:]
        wrapped.next = total[width]

    return multiply, add, keep


@block
def everything(clk, word, pair, joined, swapped, count):
    """Connect blocks in every way: by slices, lists, interfaces and constants, and not at all."""
    halves = [unsigned(4) for _ in range(2)]
    carries = [unconnected(1), unconnected(1)]
    lower, upper = word(4, 0), word(8, 4)
    amounts = [tied(3, 4), tied(15, 4)]
    one = tied(1, 4)
    both = ConcatSignal(*reversed(halves))
    carry = bit()
    total = unsigned(4)

    first = step(clk, lower, amounts[0], halves[0], carries[0])
    second = step(clk, upper, amounts[1], halves[1], carries[1])
    third = step(clk, total, one, count, carry)
    crossing = swap(pair, swapped)

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

    return first, second, third, crossing, join, choose


def everything_arguments() -> dict:
    signals = {"clk": bit(), "word": unsigned(8), "pair": Pair(), "joined": unsigned(8), "swapped": Pair()}
    return signals | {"count": unsigned(4)}


@block
def inverted(word, result):
    """~word."""

    @always_comb
    def invert():
        result.next = ~word

    return (invert,)


def _another():
    """Return a different block with the name and ports of `inverted`."""

    @block
    def inverted(word, result):
        @always_comb
        def add():
            result.next = (word + 1) % 16

        return (add,)

    return inverted


another_inverted = _another()


def converted(top, directory: Path, **options) -> dict[str, Module]:
    directory.mkdir(exist_ok=True)
    return {module.name: module for module in convert_hierarchy(top, directory, "// {module}", **options)}
