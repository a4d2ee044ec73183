# SPDX-License-Identifier: MIT
"""Structure of an elaborated design: its blocks, its processes, and the signals between them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from myhdl import ConcatSignal

from raycaster.hdl.internals import Block, Process, SignalType, SliceSignal, bits_of, operands_of
from raycaster.hdl.records import block_arguments, block_ports, signals_in


@dataclass(frozen=True)
class Part:
    """A block or a process inside a design, with the signals that it drives, and the others that it reads.

    Its clock and its reset do not count. Signals are given by identity; `Inside.names` has their names. `within` has
    the enclosing blocks below the one that was asked for, outermost first.
    """

    name: str
    is_block: bool
    within: tuple[str, ...]
    reads: frozenset[int]
    drives: frozenset[int]


@dataclass(frozen=True)
class Inside:
    """Structure of a block. `names` has the variable that gives access to a signal, and the signal's full name."""

    parts: tuple[Part, ...]
    names: dict[int, tuple[str, str]]
    ports: frozenset[int]


def find_block(top: Block, name: str) -> Block:
    """Return the first block of this name in an elaborated design.

    Raises:
        KeyError: there is no such block.
    """
    waiting = [top]
    for candidate in waiting:
        if candidate.func.__name__ == name:
            return candidate
        waiting += [sub for sub in candidate.subs if isinstance(sub, Block)]
    raise KeyError(name)


def look_inside(top: Block, opened: Collection[str]) -> Inside:
    """Return an elaborated block's structure; blocks whose names are in `opened` are replaced by their own parts."""
    ports = block_ports(top)
    names: dict[int, tuple[str, str]] = {}
    parts: list[Part] = []

    def visit(block: Block, within: tuple[str, ...]) -> None:
        scope = block_arguments(block)
        for sub in block.subs:
            scope |= {name: value for name, value in sub.callinfo.symdict.items() if not name.startswith("_")}
        for name, value in scope.items():
            for path, signal in signals_in(name, value):
                names.setdefault(id(signal), (name, path))
        for sub in block.subs:
            name = sub.func.__name__
            if isinstance(sub, Block) and name in opened:
                visit(sub, (*within, name))
                continue
            reads, drives = map(_whole, _traffic(sub))
            if isinstance(sub, Block):
                around = _whole(block_ports(sub).values())
                reads, drives = reads & around, drives & around
            parts.append(Part(name, isinstance(sub, Block), within, reads - drives, drives))

    visit(top, ())
    return Inside(tuple(parts), names, frozenset(id(signal) for signal in ports.values()))


def _traffic(part: Block | Process) -> tuple[list[SignalType], list[SignalType]]:
    """Return the signals that a process, or a block with everything below it, reads, and those that it drives.

    The edges and the reset that a process waits for do not count.
    """
    if isinstance(part, Process):
        reads, drives = (
            [signal for name in names for _, signal in signals_in(name, part.symdict[name])]
            for names in (part.inputs, part.outputs)
        )
        return reads, drives
    reads, drives = [], []
    if given := getattr(part.func, "given_verilog", None):
        for name, signal in block_ports(part).items():
            (drives if name in given.outputs else reads).append(signal)
    for sub in part.subs:
        more_reads, more_drives = _traffic(sub)
        reads += more_reads
        drives += more_drives
    return reads, drives


def _whole(signals: Iterable[SignalType]) -> frozenset[int]:
    """Replace slices and concatenations by their whole signals."""
    found: set[int] = set()
    waiting = list(signals)
    while waiting:
        signal = waiting.pop()
        if isinstance(signal, SliceSignal):
            waiting.append(bits_of(signal)[0])
        elif isinstance(signal, ConcatSignal):
            waiting += [part for part in operands_of(signal) if isinstance(part, SignalType)]
        else:
            found.add(id(signal))
    return frozenset(found)
