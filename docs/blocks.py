# SPDX-License-Identifier: MIT
"""Block diagrams, drawn from the elaborated design: its parts and the signals between them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import takewhile
from typing import Any

import pygraphviz

from raycaster.configuration import Configuration, configure
from raycaster.docs.inside import Inside, Part, find_block, look_inside
from raycaster.hdl.elaboration import elaborated, elaboration
from raycaster.hdl.internals import Block
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
    Drawing("beam", _module, "beam_renderer", frozenset({"beam_caster", "beam_lane"}), "beam"),
)


@dataclass(frozen=True)
class Net:
    """Signals with the same drivers and the same readers, given by the parts' keys."""

    names: tuple[str, ...]
    drivers: frozenset[str]
    readers: frozenset[str]
    is_port: bool


def _key(part: Part) -> str:
    """Return a key that identical parts in one place share, so that they are drawn as one."""
    return "/".join((*part.within, part.name))


def nets(inside: Inside) -> list[Net]:
    """Return the nets between the parts, and between the parts and the ports."""
    together = defaultdict(list)
    for signal, name in inside.names.items():
        if name[1] in EVERYWHERE:
            continue
        is_port = signal in inside.ports
        drivers = frozenset(_key(part) for part in inside.parts if signal in part.drives)
        readers = frozenset(_key(part) for part in inside.parts if signal in part.reads) - drivers
        # A signal without a reader or a driver here is a constant, or belongs to another design.
        if (drivers or is_port) and (readers or (is_port and drivers)):
            together[drivers, readers, is_port].append(name)
    return [Net(_labels(names), *ends) for ends, names in together.items()]


def _labels(names: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Return the names to draw; many signals of one variable are abbreviated to their common prefix."""
    groups = defaultdict(list)
    for variable, path in sorted(set(names)):
        groups[variable].append(path)
    labels = [label for paths in groups.values() for label in _shortened(paths)]
    families = defaultdict(list)
    for label in labels:
        families[label.partition("_")[0]].append(label)
    if len(labels) > MOST_NAMES:
        labels = [label for family in families.values() for label in _shortened(family)]
    return tuple(sorted(labels))


def _shortened(paths: list[str]) -> list[str]:
    common = _in_common(path.split("_") for path in paths)
    return [f"{'_'.join(common)}_*"] if len(paths) >= MOST_NAMES and common else paths


def _in_common(sequences: Iterable[Sequence[str]]) -> tuple[str, ...]:
    """Return the common prefix of all sequences."""
    return tuple(column[0] for column in takewhile(lambda column: len(set(column)) == 1, zip(*sequences, strict=False)))


@cache
def _elaborate(design: Callable[[Configuration], Block], engine: str) -> Block:
    """Elaborate the default design of an engine once for all drawings."""
    with elaboration():
        return design(configure(engine=engine))


def inside_of(drawing: Drawing) -> Inside:
    """Return the parts of the drawn block."""
    return look_inside(find_block(_elaborate(drawing.design, drawing.engine), drawing.block), drawing.opened)


def graph(drawing: Drawing, inside: Inside) -> pygraphviz.AGraph:
    """Return the diagram, without a layout."""
    drawn = pygraphviz.AGraph(directed=True, strict=False, name=drawing.name)
    drawn.graph_attr.update(
        rankdir="TB", fontname=FONT, fontsize=11, nodesep=0.08, ranksep=0.3, outputorder="edgesfirst"
    )
    drawn.node_attr.update(fontname=FONT, fontsize=11, fontcolor=INK, color=INK, height=0.25, margin="0.08,0.04")
    drawn.edge_attr.update(fontname=FONT, fontsize=9, fontcolor=INK, color=PALE, arrowsize=0.6)
    counts = Counter(map(_key, inside.parts))
    clusters: dict[tuple[str, ...], pygraphviz.AGraph] = {(): drawn}
    for part in inside.parts:
        for depth in range(1, len(part.within) + 1):
            place = part.within[:depth]
            if place not in clusters:
                clusters[place] = clusters[place[:-1]].add_subgraph(
                    name="cluster_" + "_".join(place), label=place[-1], style="filled,rounded", fillcolor=OPENED_FILL,
                    color=PALE, fontname=FONT, fontcolor=INK, labeljust="l",
                )  # fmt: skip
        key = _key(part)
        label = part.name if counts[key] == 1 else f"{part.name}\nx {counts[key]}"
        look = {"style": "filled", "fillcolor": BLOCK_FILL}
        if not part.is_block:
            look = {"style": "filled,rounded", "fillcolor": PROCESS_FILL, "fontsize": 10, "color": PALE}
        clusters[part.within].add_node(key, label=label, shape="box", **look)
    places = {_key(part): part.within for part in inside.parts}
    for number, net in enumerate(nets(inside)):
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
    svg: Any = graph(drawing, inside_of(drawing)).draw(format="svg", prog="dot")
    return svg.decode()
