# SPDX-License-Identifier: MIT
"""The two ways to leave an instance's port without a signal of one's own: tied to a value, and open."""

from myhdl import intbv
from myhdl._Signal import _Signal


class Signed(int):
    """The width in bits of a two's complement value; a plain `int` is that of an unsigned one."""


def initial(value: int, like: int | _Signal) -> bool | intbv:
    """A value in the shape of a width or of another signal; one unsigned bit is a bool, as MyHDL's bits are.

    Args:
        value: what it starts with.
        like: a width in bits, `Signed` for two's complement, or a signal.
    """
    if isinstance(like, Signed):
        return intbv(value, min=-(1 << (like - 1)), max=1 << (like - 1))
    if isinstance(like, int):
        return intbv(value)[like:] if like > 1 else bool(value)
    return bool(value) if like.min is None else intbv(value, min=like.min, max=like.max)


class Tied(_Signal):
    """What `tied` makes; it prints as a number where it is connected, and as a localparam where a process reads it."""


class Unconnected(_Signal):
    """What `unconnected` makes; it prints as an empty connection."""


def tied(value: int, like: int | _Signal) -> Tied:
    """A signal that never changes, for inputs of instances however many levels down; `like` as for `initial`."""
    return Tied(initial(value, like))


def unconnected(like: int | _Signal) -> Unconnected:
    """A signal for an output of an instance that is not read; `like` as for `initial`."""
    return Unconnected(initial(0, like))
