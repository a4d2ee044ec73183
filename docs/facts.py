# SPDX-License-Identifier: MIT
"""Markdown tables for the pages, from the design itself: options, cycles, registers."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pydantic.fields import FieldInfo
from systemrdl.node import FieldNode, Node, RegNode

from raycaster.buses import BUSES
from raycaster.configuration import FEATURES
from raycaster.design.decide import OPTIONS, configure
from raycaster.docs import spans
from raycaster.docs.timing import CONFIGURATION
from raycaster.registers import compile_registers
from raycaster.rtl.buffered.engine import GROUP_OVERHEAD
from raycaster.rtl.common.interfaces import AIM_CYCLES
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.engine.engine import Engine
from raycaster.rtl.engines import ENGINES, EXACT, SEED, SPAN
from raycaster.rtl.exact.exact_control import PATTERN_LATENCY, WRITE_AT
from raycaster.runs.outcomes import table

ACCESS = {"r": "read", "rw": "read, write", "woclr": "read, write 1 to clear", "woset": "read, write 1 to set"}


def options() -> str:
    """Table of a design's options, in the form of make's command line."""

    def default(field: FieldInfo) -> str:
        value = int(field.default) if isinstance(field.default, bool) else field.default
        return "automatic" if value is None else f"`{value}`"

    rows = ([f"`{name.upper()}`", OPTIONS[name].description, default(OPTIONS[name])] for name in OPTIONS)
    return table(["option", "meaning", "default"], rows)


def offers() -> str:
    """Table of the features and the screens of each engine, as it states them."""
    engines, facts = ENGINES.values(), [one.facts for one in ENGINES.values()]

    def cell(engine: Engine, place: tuple[str, int]) -> str:
        scales = sorted(engine.scales(engine.facts.screens[place])) if place in engine.facts.screens else []
        return f"scales {', '.join(map(str, scales))}" if len(scales) > 1 else "yes" * len(scales)

    rows = [[what, f"`{feature.upper()}=1`", *("yes" if feature in one.features else "" for one in facts)]
            for feature, what in FEATURES.items()]  # fmt: skip
    rows.append(["2 pixels per clock", "`PIXELS=2`", *("yes" if one.whole_frames else "" for one in facts)])
    rows.append(["fraction bits, rounding", "`FRACTION_BITS=`", *("yes" if one.divides else "" for one in facts)])
    rows.append(["most rectangles", "`RECTANGLES=`", *(str(one.rectangles) for one in facts)])
    screens = {place: screen for one in facts for place, screen in one.screens.items()}
    for (name, count), screen in sorted(screens.items(), key=lambda one: (one[0][0] != "vga", one[0])):
        size = f"{screen.horizontal.visible}x{screen.vertical.visible}"
        chosen = f"`ROWS={count}`" if name == "vga" else f"`SCREEN={name}`"
        rows.append([f"monitor with {size}", chosen, *(cell(one, (name, count)) for one in engines)])
    return table(["", "option", *ENGINES], rows)


def buses() -> str:
    """Table of the buses, with the cycles that their bench measures."""
    rows = [
        [f"`BUS={name}`", bus.title, f"`{bus.port}_*`", bus.unit, bus.write or "-", bus.read or "-"]
        for name, bus in BUSES.items()
    ]
    return table(["", "bus", "ports", "address unit", "cycles per write", "cycles per read"], rows)


def seed_cycles() -> str:
    """Table of the seed engine's cycles and budget per group, by reflections and quotient bits per cycle."""
    head = ["reflections", "quotient bits per cycle", "cycles per rectangle", "cycles per group, worst case"]
    rows = []
    for reflections in range(3):
        for bits in (1, 2, 3):
            config = configure(reflections=reflections, divider_bits=bits, allow_underrun=True)
            cycles = SEED.group_cycles(config)
            fits = "yes" if cycles <= config.group_budget else "no"
            rows.append([reflections, bits, SEED.rect_cycles(config), cycles, config.group_budget, fits])
    return table([*head, "budget per group", "fits"], rows)


def exact_cycles() -> str:
    """Table of the exact engine's fewest units and their cycles, by reflections and rectangles."""
    rows = []
    for reflections in range(3):
        for rectangles in (12, 32):
            config = configure(engine="exact", reflections=reflections, rectangles=rectangles)
            rows.append([reflections, rectangles, config.units, EXACT.group_cycles(config), config.group_budget])
    return table(
        ["reflections", "rectangles", "fewest units", "cycles per group, worst case", "budget per group"], rows
    )


def register_overview() -> str:
    """Table with a row per register."""
    rows = []
    for node in _registers():
        values = [(field.get_property("reset"), field.low) for field in node.fields()]
        known = [value << low for value, low in values if isinstance(value, int)]
        reset = f"`{sum(known):#010x}`" if len(known) == len(values) else "as generated"
        said = re.fullmatch(r"(?:(Shadowed)(, except \w+)?\. )?(.*?)\.(?: .*)?", _about(node))
        shadowed = f"yes{said[2] or ''}" if said and said[1] else ""
        path, offset = _place(node)
        rows.append([f"`{path}`", f"`{offset}`", reset, shadowed, said[3] if said else ""])
    return table(["register", "offset", "after reset", "shadowed", "purpose"], rows)


def registers() -> str:
    """Section per register, with a table of its fields."""
    parts = []
    for node in _registers():
        rows = [
            [_bits(field), f"`{field.inst_name}`", _access(field), _about(field)]
            for field in sorted(node.fields(), key=lambda field: -field.high)
        ]
        path, offset = _place(node)
        parts += [f"## `{path}`, {offset}", _about(node), table(["bits", "field", "access", "meaning"], rows)]
    return "\n\n".join(parts)


def _registers() -> Iterator[RegNode]:
    """Yield all registers, with a single entry of the rectangle table."""
    top = compile_registers(configure().rectangles, lists=True)
    return (node for node in top.descendants() if isinstance(node, RegNode))


def _place(node: RegNode) -> tuple[str, str]:
    """Return a register's name and its offset in bytes."""
    path = node.get_path(empty_array_suffix="[i]").removeprefix("ray_caster.")
    if not node.parent.is_array:
        return path, f"{node.raw_absolute_address:#04x}"
    offset = node.parent.raw_absolute_address + node.address_offset
    return path, f"{offset:#04x} + {node.parent.array_stride:#x} i"


def _about(node: Node) -> str:
    """Return a description in one line."""
    return " ".join((node.get_property("desc") or "").split())


def _bits(field: FieldNode) -> str:
    """Return a field's bit range in the word."""
    return f"{field.high}:{field.low}" if field.width > 1 else f"{field.low}"


def _access(field: FieldNode) -> str:
    """Return a field's software access in words."""
    onwrite = field.get_property("onwrite")
    return ACCESS[onwrite.name if onwrite else field.get_property("sw").name]


def facts() -> dict[str, str]:
    """Return all tables and numbers that come from the design itself, by the names in the pages' markers."""
    default = configure()
    return {
        "options": options(),
        "offers": offers(),
        "buses": buses(),
        "seed_cycles": seed_cycles(),
        "exact_cycles": exact_cycles(),
        "span_rectangles": spans.rectangles(),
        "span_entries": spans.entries(),
        "span_runs": spans.runs(),
        "register_overview": register_overview(),
        "registers": registers(),
        "units": str(default.units),
        "rectangles": str(default.rectangles),
        "most_rectangles": f"{SEED.facts.rectangles}, or {SPAN.facts.rectangles} with the span engine",
        "rect_cycles": str(SEED.rect_cycles(default)),
        "seed_latency": str(SEED.pass_latency(default)),
        "overhead": str(GROUP_OVERHEAD),
        "verdict": str(WRITE_AT + 1),
        "exact_latency": str(EXACT.pass_latency(configure(engine="exact"))),
        "turned_slope_bits": str(exact_slope_bits(configure(engine="exact", turn=True))),
        "pattern_latency": str(PATTERN_LATENCY),
        "aim_cycles": str(AIM_CYCLES),
        "light_units": str(configure(engine="exact", light=True).units),
        "group": str(SEED.group_cycles(default)),
        "budget": str(default.group_budget),
        "row": f"{default.screen_geometry.row_cycles:,}",
        "traced_units": str(CONFIGURATION.units),
        "traced_group": str(SEED.group_cycles(CONFIGURATION)),
    }
