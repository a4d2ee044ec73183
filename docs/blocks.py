# SPDX-License-Identifier: MIT
"""Block diagrams, drawn from the elaborated design: its parts and the signals between them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import takewhile
from typing import Any

import pygraphviz
from myhdl import ConcatSignal

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.hdl.elaboration import elaborated, elaboration
from raycaster.hdl.internals import Block, Process, SignalType, SliceSignal, bits_of, operands_of
from raycaster.hdl.records import block_arguments, block_ports, signals_in
from raycaster.memory_map import PROGRAM_FILE
from raycaster.rtl.system.ports import module_ports, system_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.ray_caster_system import ray_caster_system

FONT = "Helvetica,Arial,sans-serif"
BLOCK_FILL, PROCESS_FILL, OPENED_FILL = "#d6e6f2", "#ffffff", "#f6f8fa"
INK, PALE, PORT_INK = "#20303c", "#8a99a5", "#0b5394"
EVERYWHERE = ("clk", "reset")
"""Signals that are not drawn."""

MOST_NAMES = 3
"""Names in a label; a longer label groups names with a common prefix."""


@dataclass(frozen=True)
class Drawing:
    """A diagram of one block, in which some inner blocks are opened."""

    name: str
    design: Callable[[Configuration], Block]
    block: str
    opened: frozenset[str] = frozenset()
    engine: str = "seed"


def _module(config: Configuration) -> Block:
    return elaborated(ray_caster_module, **module_ports(config), config=config)


def _system(config: Configuration) -> Block:
    return elaborated(ray_caster_system, **system_ports(config), config=config, program=PROGRAM_FILE)


DRAWINGS = (
    Drawing("system", _system, "ray_caster_system", frozenset({"processor_host", "ray_caster_module"}), "exact"),
    Drawing("renderer", _module, "ray_caster_renderer", frozenset({"ray_caster"})),
    Drawing("ray_unit", _module, "ray_unit", frozenset({"intersection_finder"})),
    Drawing("video_generator", _module, "video_generator"),
    Drawing("exact", _module, "ray_caster", frozenset({"exact_unit"}), "exact"),
    Drawing("span", _module, "span_renderer", frozenset({"span_unit"}), "span"),
)


@dataclass(frozen=True)
class Part:
    """A block or a process inside a design, with the signals that it drives, and the others that it reads.

    Its clock and its reset do not count. Signals are given by identity. `within` has the enclosing blocks below the one
    that is drawn, outermost first.
    """

    name: str
    is_block: bool
    within: tuple[str, ...]
    reads: frozenset[int]
    drives: frozenset[int]

    @property
    def key(self) -> str:
        """Key that identical parts in one place share, so that they are drawn as one."""
        return "/".join((*self.within, self.name))


@dataclass(frozen=True)
class Net:
    """Signals with the same drivers and the same readers, given by the parts' keys."""

    names: tuple[str, ...]
    drivers: frozenset[str]
    readers: frozenset[str]
    is_port: bool


def _find_block(top: Block, name: str) -> Block:
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


def look_inside(top: Block, opened: Collection[str]) -> tuple[list[Part], list[Net]]:
    """Return an elaborated block's parts, and the nets between them and to its ports.

    Blocks whose names are in `opened` are replaced by their own parts.
    """
    names: dict[int, tuple[str, str]] = {}  # the variable that gives access to a signal, and the signal's full name
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
    ports = {id(signal) for signal in block_ports(top).values()}
    together = defaultdict(list)
    for signal, name in names.items():
        if name[1] in EVERYWHERE:
            continue
        is_port = signal in ports
        drivers = frozenset(part.key for part in parts if signal in part.drives)
        readers = frozenset(part.key for part in parts if signal in part.reads) - drivers
        # A signal without a reader or a driver here is a constant, or belongs to another design.
        if (drivers or is_port) and (readers or (is_port and drivers)):
            together[drivers, readers, is_port].append(name)
    return parts, [Net(_labels(names), *ends) for ends, names in together.items()]


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


def _labels(names: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Return the names to draw; many signals of one variable are abbreviated to their common prefix."""
    labels = _shortened(sorted(set(names)))
    if len(labels) > MOST_NAMES:
        labels = _shortened((label.partition("_")[0], label) for label in labels)
    return tuple(sorted(labels))


def _shortened(names: Iterable[tuple[str, str]]) -> list[str]:
    """Abbreviate names, each given with its group, to their common prefix if a group has many of them."""
    groups = defaultdict(list)
    for group, name in names:
        groups[group].append(name)
    shortened = []
    for of_group in groups.values():
        common = _in_common(name.split("_") for name in of_group)
        shortened += [f"{'_'.join(common)}_*"] if len(of_group) >= MOST_NAMES and common else of_group
    return shortened


def _in_common(sequences: Iterable[Sequence[str]]) -> tuple[str, ...]:
    """Return the common prefix of all sequences."""
    return tuple(column[0] for column in takewhile(lambda column: len(set(column)) == 1, zip(*sequences, strict=False)))


@cache
def _elaborate(design: Callable[[Configuration], Block], engine: str) -> Block:
    """Elaborate the default design of an engine once for all drawings."""
    with elaboration():
        return design(configure(engine=engine))


def graph(drawing: Drawing) -> pygraphviz.AGraph:
    """Return the diagram, without a layout."""
    top = _find_block(_elaborate(drawing.design, drawing.engine), drawing.block)
    parts, nets = look_inside(top, drawing.opened)
    drawn = pygraphviz.AGraph(directed=True, strict=False, name=drawing.name)
    drawn.graph_attr.update(
        rankdir="TB", fontname=FONT, fontsize=11, nodesep=0.08, ranksep=0.3, outputorder="edgesfirst"
    )
    drawn.node_attr.update(fontname=FONT, fontsize=11, fontcolor=INK, color=INK, height=0.25, margin="0.08,0.04")
    drawn.edge_attr.update(fontname=FONT, fontsize=9, fontcolor=INK, color=PALE, arrowsize=0.6)
    counts = Counter(part.key for part in parts)
    clusters: dict[tuple[str, ...], pygraphviz.AGraph] = {(): drawn}
    for part in parts:
        for depth in range(1, len(part.within) + 1):
            place = part.within[:depth]
            if place not in clusters:
                clusters[place] = clusters[place[:-1]].add_subgraph(
                    name="cluster_" + "_".join(place), label=place[-1], style="filled,rounded", fillcolor=OPENED_FILL,
                    color=PALE, fontname=FONT, fontcolor=INK, labeljust="l",
                )  # fmt: skip
        count = counts[part.key]
        label = part.name if count == 1 else f"{part.name}\nx {count}"
        look = {"style": "filled", "fillcolor": BLOCK_FILL}
        if not part.is_block:
            look = {"style": "filled,rounded", "fillcolor": PROCESS_FILL, "fontsize": 10, "color": PALE}
        clusters[part.within].add_node(part.key, label=label, shape="box", **look)
    places = {part.key: part.within for part in parts}
    for number, net in enumerate(nets):
        around = () if net.is_port else _in_common(places[part] for part in net.drivers | net.readers)
        _add_net(drawn, clusters[around], net, f"net {number}")
    return drawn


def _add_net(drawn: pygraphviz.AGraph, cluster: pygraphviz.AGraph, net: Net, name: str) -> None:
    """Add a net: a labelled edge from one part to another, or a label node if it has more ends or is a port."""
    label = "\n".join(net.names)
    if not net.is_port and len(net.drivers) == len(net.readers) == 1:
        drawn.add_edge(*net.drivers, *net.readers, label=label)
        return
    cluster.add_node(
        name, label=label, shape="plaintext", style="filled", fillcolor="#ffffffc0", fontsize=9,
        fontcolor=PORT_INK if net.is_port else INK, margin="0.03,0.01", width=0, height=0.15,
    )  # fmt: skip
    for driver in sorted(net.drivers):
        drawn.add_edge(driver, name, arrowhead="none")
    for reader in sorted(net.readers):
        drawn.add_edge(name, reader)


def draw(drawing: Drawing) -> str:
    """Return a diagram as SVG."""
    # Not into a file: pygraphviz would open it itself, which fails in some versions of Python.
    svg: Any = graph(drawing).draw(format="svg", prog="dot")
    return svg.decode()
