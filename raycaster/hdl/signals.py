# SPDX-License-Identifier: MIT
"""Signals of a given width; and instance ports without a signal: tied to a constant, or left open."""

from typing import Any

from myhdl import ConcatSignal, ResetSignal, Signal, intbv

from raycaster.hdl.internals import DerivedClock, SignalType


class Signed(int):
    """The width in bits of a two's complement value; a plain `int` is the width of an unsigned one."""


def initial(value: int, like: int | SignalType) -> bool | intbv:
    """Return a value for a given width or for another signal's type; one unsigned bit is a bool, as in MyHDL.

    Args:
        value: the initial value.
        like: a width in bits, `Signed` for two's complement, or a signal.
    """
    if isinstance(like, Signed):
        return intbv(value, min=-(1 << (like - 1)), max=1 << (like - 1))
    if isinstance(like, int):
        return intbv(value)[like:] if like > 1 else bool(value)
    return bool(value) if like.min is None else intbv(value, min=like.min, max=like.max)


class Tied(SignalType):
    """A constant made by `tied`. In Verilog it is a number in connections, and a localparam if a process reads it."""


class Unconnected(SignalType):
    """An open output made by `unconnected`. In Verilog it is an empty connection."""


def tied(value: int, like: int | SignalType) -> Tied:
    """Return a constant signal for inputs of instances, any number of levels down; `like` as for `initial`."""
    return Tied(initial(value, like))


def unconnected(like: int | SignalType) -> Unconnected:
    """Return a signal for an instance's output that nothing reads; `like` as for `initial`."""
    return Unconnected(initial(0, like))


def derived_clock(clk: SignalType) -> DerivedClock:
    """Return a clock that given Verilog, such as a clock gate, derives from clk; in MyHDL it rises with clk.

    A clock that a process derived would rise only after the registers of clk had changed.
    """
    return DerivedClock(clk)


def bits_for(count: int) -> int:
    """Width of a counter with this many values; a signal has at least one bit."""
    return max(1, (count - 1).bit_length())


def unsigned(width: int) -> SignalType:
    """Return an unsigned signal, initially 0."""
    return Signal(intbv(0)[width:])


def signed(width: int) -> SignalType:
    """Return a two's complement signal, initially 0."""
    return Signal(initial(0, Signed(width)))


class Unset(list):
    """Words of a large block RAM: unknown at power-up, so Verilog gives them no initial values.

    In MyHDL a word is made when a process first reads or writes it, and begins with 0, so nothing may depend on a word
    before it is written. Nor may anything depend on a word that is read in the cycle in which it is written, so that
    tools need not see to that. Only clocked processes may read it, as no process can wait for a word that is not made
    yet.
    """

    def __init__(self, places: int, width: int):
        super().__init__([unsigned(width)])
        self._places, self._width, self._made = places, width, dict(enumerate(self))

    def __len__(self) -> int:
        return self._places

    def __getitem__(self, place: Any) -> Any:
        number = range(self._places)[int(place)]
        if number not in self._made:
            self._made[number] = unsigned(self._width)
        return self._made[number]


def bit() -> SignalType:
    """Return a one-bit signal, initially low."""
    return Signal(bool(0))


def side_by_side(signals: list) -> SignalType:
    """Return the signals as one vector, the first in the lowest bits."""
    return ConcatSignal(*reversed(signals)) if len(signals) > 1 else signals[0]


def reset_signal() -> ResetSignal:
    """Return a reset as all modules use it: synchronous and active high."""
    return ResetSignal(0, active=1, isasync=False)
