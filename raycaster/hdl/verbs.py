# SPDX-License-Identifier: MIT
"""Processes of one assignment as calls, each an `assign` in Verilog: `see_carry = assign(carry, lambda: a and b)`.

A call may drive several signals: `keep = register(clk, (start, stop), lambda: (low, high), found)`. The others are
operators, and make the signal for their result: `total, add = plus(a, b, 9)`. The operands are signals or integers. A
block gives the signal a variable of its own, which is its name in Verilog; so names here begin with an underscore.
"""

from collections.abc import Callable
from types import FunctionType
from typing import Any

from myhdl import Signal

from raycaster.hdl.internals import Assignment, Process, Register, SignalType, adopted, calling_block
from raycaster.hdl.signals import bit, initial

Driven = SignalType | tuple[SignalType, ...]
"""A signal, or several signals; then the lambda returns a tuple with a value for each."""


def assign(target: Driven, value: Callable[[], Any]) -> Assignment:
    """Return a process that drives a signal with the value of a lambda: `assign(carry, lambda: a and b)`."""
    assert isinstance(value, FunctionType)
    return Assignment(value, calling_block())


def register(clk: SignalType, target: Driven, value: Callable[[], Any], when: SignalType | bool = True) -> Register:
    """Return a process that a clock drives: `register(clk, memory[place], lambda: word, write)`.

    It takes the value at the clock's rising edges at which the last argument is high, and always if there is none.
    """
    assert isinstance(value, FunctionType)
    return Register(clk, value, calling_block())


def plus(_a: Any, _b: Any, width: int) -> tuple[SignalType, Process]:
    """Return _a + _b in a signal of this width, `Signed` for two's complement, and its process."""
    _sum = Signal(initial(0, width))
    add = assign(_sum, lambda: _a + _b)
    return _sum, adopted(add)


def minus(_a: Any, _b: Any, width: int) -> tuple[SignalType, Process]:
    """Return _a - _b in a signal of this width, `Signed` for two's complement, and its process."""
    _difference = Signal(initial(0, width))
    subtract = assign(_difference, lambda: _a - _b)
    return _difference, adopted(subtract)


def times(_a: Any, _b: Any, width: int) -> tuple[SignalType, Process]:
    """Return _a * _b in a signal of this width, `Signed` for two's complement, and its process."""
    _product = Signal(initial(0, width))
    multiply = assign(_product, lambda: _a * _b)
    return _product, adopted(multiply)


def less(_a: Any, _b: Any) -> tuple[SignalType, Process]:
    """Return a flag that is high if _a < _b, and its process."""
    _is_less = bit()
    compare = assign(_is_less, lambda: _a < _b)
    return _is_less, adopted(compare)
