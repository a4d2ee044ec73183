# SPDX-License-Identifier: MIT
"""Structure of an elaborated design: its blocks, its processes, and the signals between them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from myhdl import ConcatSignal

from raycaster.hdl.internals import Block, Process, SignalType, SliceSignal, bits_of, operands_of
from raycaster.hdl.records import block_arguments, block_ports, signals_in


@dataclass(frozen=True)
class Part:
    """A block or a process inside a design, with the signals that it drives, and the others that it reads.

    Its clock and its reset do not count. Signals are given by identity; `Inside.names` has their names.
    """

    name: str
    is_block: bool
    within: tuple[str, ...]
    """Enclosing blocks, below the one that was asked for, outermost first."""

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
            if isinstance(sub, Block) and sub.func.__name__ in opened:
                visit(sub, (*within, sub.func.__name__))
            elif isinstance(sub, Block):
                around = _whole({id(signal): signal for signal in block_ports(sub).values()})
                reads, drives = (_whole(signals) & around for signals in _traffic(sub))
                parts.append(Part(sub.func.__name__, True, within, reads - drives, drives))
            else:
                reads, drives = (_whole(signals) for signals in _traffic_of_process(sub))
                parts.append(Part(sub.func.__name__, False, within, reads - drives, drives))

    visit(top, ())
    return Inside(tuple(parts), names, frozenset(id(signal) for signal in ports.values()))


Signals = dict[int, SignalType]


def _traffic(block: Block) -> tuple[Signals, Signals]:
    """Return all signals that are read, and all that are driven, in a block and below."""
    given = getattr(block.func, "given_verilog", None)
    reads: Signals = {}
    drives: Signals = {}
    if given:
        for name, signal in block_ports(block).items():
            (drives if name in given.outputs else reads)[id(signal)] = signal
    for sub in block.subs:
        more_reads, more_drives = _traffic(sub) if isinstance(sub, Block) else _traffic_of_process(sub)
        reads |= more_reads
        drives |= more_drives
    return reads, drives


def _traffic_of_process(process: Process) -> tuple[Signals, Signals]:
    """Return the signals that a process reads, and those that it drives, except the edges and reset it waits for."""

    def find(names: Collection[str]) -> Signals:
        return {id(signal): signal for name in names for _, signal in signals_in(name, process.symdict[name])}

    return find(process.inputs), find(process.outputs)


def _whole(signals: Signals) -> frozenset[int]:
    """Replace slices and concatenations by their whole signals."""
    found: set[int] = set()
    waiting = list(signals.values())
    while waiting:
        signal = waiting.pop()
        if isinstance(signal, SliceSignal):
            waiting.append(bits_of(signal)[0])
        elif isinstance(signal, ConcatSignal):
            waiting += [part for part in operands_of(signal) if isinstance(part, SignalType)]
        else:
            found.add(id(signal))
    return frozenset(found)
