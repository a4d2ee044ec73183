# SPDX-License-Identifier: MIT
"""The ray tracer as a component for Intel's Platform Designer (Qsys, SOPC Builder's successor), which never ran it."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.hdl.hierarchy import Port

COMPONENT = "raycaster_hw.tcl"
"""File name; Platform Designer looks for `*_hw.tcl`."""

NIOS_SYSTEM = Path(__file__).with_name("nios_system.tcl")
"""Script for Platform Designer that builds a system with the component and a Nios processor."""

_CLOCKED = ("associatedClock clock", "associatedReset reset")
_WORDS = ("addressUnits WORDS", "bitsPerSymbol 8", "isMemoryDevice false")
# One read per cycle is accepted, and each is answered after two.
_READS = ("maximumPendingReadTransactions 2", "readLatency 0")

INTERFACES = (
    ("clock", "clock", "clk", ("clockRate {clock_hz}",)),
    ("reset", "reset", "reset", ("associatedClock clock", "synchronousEdges BOTH")),
    ("s0", "avalon", "avs_s0_", (*_CLOCKED, *_WORDS, *_READS)),
    ("irq", "interrupt", "irq", (*_CLOCKED, "associatedAddressablePoint s0")),
    ("vga", "conduit", "vga_", _CLOCKED),
)
"""Interfaces, in the order in which they refer to each other: name, kind, the beginning of their ports' names, and
properties. The rest of a port's name, or all of it if there is none, is the port's role."""


def component(config: Configuration, ports: Sequence[Port], sources: Sequence[str]) -> str:
    """Return the component's description, in Tcl.

    Args:
        config: the generated design.
        ports: ports of the top module.
        sources: names of the files, each after those that it needs; the top is the last.
    """
    top = sources[-1].removesuffix(".v")
    lines = [
        "# SPDX-License-Identifier: MIT",
        f"# {top}, {config.name}, for Platform Designer. Not yet run there; docs/boards.md says what was tested.",
        # The last release for the Cyclone II has the commands of this version, and later ones still accept them.
        "package require -exact qsys 13.0",
        f"set_module_property NAME {top}",
        "set_module_property DISPLAY_NAME RayCaster",
        'set_module_property DESCRIPTION "A real-time ray tracer with a VGA output"',
        "set_module_property GROUP Video",
        f"set_module_property VERSION {version('raycaster')}",
        "set_module_property EDITABLE false",
    ]
    for fileset in ("QUARTUS_SYNTH", "SIM_VERILOG"):
        lines.append(f'add_fileset {fileset.lower()} {fileset} "" ""')
        lines.append(f"set_fileset_property {fileset.lower()} TOP_LEVEL {top}")
        lines += [f"add_fileset_file {name} VERILOG PATH {name}" for name in sources]
    for name, kind, prefix, properties in INTERFACES:
        lines.append(f"add_interface {name} {kind} end")
        for text in properties:
            lines.append(f"set_interface_property {name} {text.format(clock_hz=config.screen_geometry.clock_hz)}")
        for port in ports:
            if port.name.startswith(prefix):
                role, direction = port.name.removeprefix(prefix) or port.name, "Output" if port.output else "Input"
                lines.append(f"add_interface_port {name} {port.name} {role} {direction} {port.width}")
    return "\n".join(lines) + "\n"
