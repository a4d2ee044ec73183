# SPDX-License-Identifier: MIT
"""The ray tracer as a component for Intel's Platform Designer (Qsys, SOPC Builder's successor)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from raycaster.configuration import OPTIONS, Configuration
from raycaster.hdl.hierarchy import Port
from raycaster.registers import compile_registers

COMPONENT = "raycaster_hw.tcl"
"""File name; Platform Designer looks for `*_hw.tcl`."""

NIOS_SYSTEM = Path(__file__).with_name("nios_system.tcl")
"""Script for Platform Designer that builds a system with the component and a Nios processor."""

QSYS_VERSION = "13.0"
"""Version of the file's commands, which the last release for the Cyclone II has, and later ones still accept."""

READS_IN_FLIGHT = 2
"""Reads that may be accepted and not yet answered: one per cycle, each answered after two."""


@dataclasses.dataclass(frozen=True)
class Interface:
    """A group of ports as Platform Designer knows them.

    Attributes:
        name: name of the instance.
        kind: kind of interface, and which end of it this is.
        properties: properties of the interface, by name.
        prefix: prefix of its ports' names; the rest of a name is the port's role.
        roles: roles of ports whose names do not contain them, by name.
    """

    name: str
    kind: str
    properties: dict[str, str | int]
    prefix: str = ""
    roles: dict[str, str] = dataclasses.field(default_factory=dict)

    def role(self, port: str) -> str | None:
        """Return a port's role in this interface, or None if it belongs to another."""
        if port in self.roles:
            return self.roles[port]
        return port.removeprefix(self.prefix) if self.prefix and port.startswith(self.prefix) else None


_IN_CLOCK = {"associatedClock": "clock", "associatedReset": "reset"}


def interfaces(config: Configuration) -> tuple[Interface, ...]:
    """Return the component's interfaces, in the order in which they refer to each other."""
    return (
        Interface("clock", "clock end", {"clockRate": config.screen_geometry.clock_hz}, roles={"clk": "clk"}),
        Interface(
            "reset", "reset end", {"associatedClock": "clock", "synchronousEdges": "BOTH"}, roles={"reset": "reset"}
        ),
        Interface(
            "s0",
            "avalon end",
            {
                **_IN_CLOCK,
                "addressUnits": "WORDS",
                "bitsPerSymbol": 8,
                "maximumPendingReadTransactions": READS_IN_FLIGHT,
                "readLatency": 0,
                "isMemoryDevice": "false",
            },
            prefix="avs_s0_",
        ),
        Interface("irq", "interrupt end", {**_IN_CLOCK, "associatedAddressablePoint": "s0"}, roles={"irq": "irq"}),
        Interface("vga", "conduit end", {**_IN_CLOCK}, prefix="vga_"),
    )


def component(config: Configuration, ports: Sequence[Port], sources: Sequence[str]) -> str:
    """Return the component's description, in Tcl.

    The options become macros in the `system.h` of the system's software. Only a design with a scene built in also has
    `FIXED`, which is "rects" or "all".

    Args:
        config: the generated design.
        ports: ports of the top module.
        sources: names of the files, each after those that it needs; the top is the last.

    Raises:
        ValueError: a port belongs to no interface, or to more than one.
    """
    top = sources[-1].removesuffix(".v")
    lines = [
        "# SPDX-License-Identifier: MIT",
        f"# {top}, {config.name}, for Platform Designer. Not yet run there; docs/boards.md says what was tested.",
        f"package require -exact qsys {QSYS_VERSION}",
        "",
        f"set_module_property NAME {top}",
        f'set_module_property DISPLAY_NAME "{compile_registers(config.rectangles).get_property("name")}"',
        'set_module_property DESCRIPTION "A real-time ray tracer with a VGA output"',
        'set_module_property GROUP "Video"',
        f"set_module_property VERSION {version('raycaster')}",
        "set_module_property EDITABLE false",
        *(f"set_module_assignment embeddedsw.CMacro.{name} {value}" for name, value in _macros(config).items()),
    ]
    for fileset in ("QUARTUS_SYNTH", "SIM_VERILOG"):
        lines += ["", f'add_fileset {fileset.lower()} {fileset} "" ""']
        lines.append(f"set_fileset_property {fileset.lower()} TOP_LEVEL {top}")
        lines += [f"add_fileset_file {name} VERILOG PATH {name}" for name in sources]
    members = interfaces(config)
    owners = {port.name: [one for one in members if one.role(port.name)] for port in ports}
    for name, owned in owners.items():
        if len(owned) != 1:
            raise ValueError(f"{name} belongs to {len(owned)} interfaces")
    for interface in members:
        lines += ["", f"add_interface {interface.name} {interface.kind}"]
        for name, value in interface.properties.items():
            lines.append(f"set_interface_property {interface.name} {name} {value}")
        for port in ports:
            if role := interface.role(port.name):
                direction = "Output" if port.output else "Input"
                lines.append(f"add_interface_port {interface.name} {port.name} {role} {direction} {port.width}")
    return "\n".join(lines) + "\n"


def _macros(config: Configuration) -> dict[str, str | int]:
    """Return the macros that describe the design to software: C expressions, each as a word of Tcl, by name."""
    values = {name: getattr(config, name) for name in OPTIONS}
    if config.fixed:
        values["fixed"] = config.fixed.scope
    return {name.upper(): f'{{"{value}"}}' if isinstance(value, str) else int(value) for name, value in values.items()}
