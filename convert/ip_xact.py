# SPDX-License-Identifier: MIT
"""The ray tracer as an IP-XACT component, in the 2009 version that Vivado reads: ports, bus, registers, files."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from xml.etree.ElementTree import Element, QName, SubElement, indent, register_namespace, tostring

from systemrdl.node import FieldNode, RegNode

from raycaster.configuration import Configuration
from raycaster.hdl.hierarchy import Port
from raycaster.registers import address_bits, compile_registers

IP_XACT = "component.xml"
"""File name that Vivado's catalogue looks for."""

SPIRIT = "http://www.spiritconsortium.org/XMLSchema/SPIRIT/1685-2009"
VENDOR = "xilinx.com"

BUS_TYPES = {"axi4lite": ("aximm", "s_axi_", {"PROTOCOL": "AXI4LITE"}), "apb": ("apb", "s_apb_", {})}
"""Buses that Vivado defines: Vivado's name, the prefix of the ports, and parameters."""

WRITES = {"woclr": "oneToClear", "woset": "oneToSet"}
"""IP-XACT's names for the values of SystemRDL's `onwrite`."""

VIEWS = {"synthesis": ":vivado.xilinx.com:synthesis", "simulation": ":vivado.xilinx.com:simulation"}

register_namespace("spirit", SPIRIT)


def _add(parent: Element, tag: str, text: object = None, /, **attributes: str) -> Element:
    """Add an element below another, with its text."""
    qualified = {QName(SPIRIT, key).text: value for key, value in attributes.items()}
    child = SubElement(parent, QName(SPIRIT, tag).text, qualified)
    child.text = None if text is None else str(text)
    return child


def component(config: Configuration, ports: Sequence[Port], sources: Sequence[str]) -> str:
    """Return the component's description, for a bus of `BUS_TYPES`.

    Args:
        config: the generated design.
        ports: ports of the top module.
        sources: names of the files, each after those that it needs; the top is the last.
    """
    top = sources[-1].removesuffix(".v")
    root = Element(QName(SPIRIT, "component").text)
    for name, text in (("vendor", "raycaster"), ("library", "video"), ("name", top), ("version", _version())):
        _add(root, name, text)
    _add_interfaces(_add(root, "busInterfaces"), config, ports)
    _add_registers(_add(root, "memoryMaps"), config)
    model = _add(root, "model")
    views = _add(model, "views")
    for name, environment in VIEWS.items():
        view = _add(views, "view")
        _add(view, "name", name)
        _add(view, "envIdentifier", f"verilogSource{environment}")
        _add(view, "language", "verilog")
        _add(view, "modelName", top)
        _add(_add(view, "fileSetRef"), "localName", "sources")
    _add_ports(_add(model, "ports"), ports)
    files = _add(_add(root, "fileSets"), "fileSet")
    _add(files, "name", "sources")
    for source in sources:
        file = _add(files, "file")
        _add(file, "name", source)
        _add(file, "fileType", "verilogSource")
    _add(root, "description", "A real-time ray tracer with a VGA output")
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'


def _version() -> str:
    """Return the version in Vivado's form of two numbers."""
    return ".".join(version("raycaster").split(".")[:2])


def _add_interfaces(parent: Element, config: Configuration, ports: Sequence[Port]) -> None:
    kind, prefix, parameters = BUS_TYPES[config.bus]
    name = prefix.rstrip("_").upper()
    bus = {port.name.removeprefix(prefix).upper(): port.name for port in ports if port.name.startswith(prefix)}
    _add_interface(parent, name, ("interface", kind), bus, parameters, registers=True)
    hertz = {"FREQ_HZ": str(config.screen_geometry.clock_hz)}
    clock = {"ASSOCIATED_BUSIF": name, "ASSOCIATED_RESET": "reset"} | hertz
    _add_interface(parent, "clk", ("signal", "clock"), {"CLK": "clk"}, clock)
    _add_interface(parent, "reset", ("signal", "reset"), {"RST": "reset"}, {"POLARITY": "ACTIVE_HIGH"})
    level = {"SENSITIVITY": "LEVEL_HIGH"}
    _add_interface(parent, "irq", ("signal", "interrupt"), {"INTERRUPT": "irq"}, level, role="master")


def _add_interface(
    parent: Element,
    name: str,
    kind: tuple[str, str],
    ports: dict[str, str],
    parameters: dict[str, str],
    *,
    role: str = "slave",
    registers: bool = False,
) -> None:
    """Add an interface, given by Vivado's library and name, with its ports by the bus's names for them."""
    library, bus = kind
    interface = _add(parent, "busInterface")
    _add(interface, "name", name)
    for element, abstraction in (("busType", bus), ("abstractionType", f"{bus}_rtl")):
        _add(interface, element, vendor=VENDOR, library=library, name=abstraction, version="1.0")
    end = _add(interface, role)
    if registers:
        _add(end, "memoryMapRef", memoryMapRef=name)
    maps = _add(interface, "portMaps")
    for logical, physical in ports.items():
        port = _add(maps, "portMap")
        _add(_add(port, "logicalPort"), "name", logical)
        _add(_add(port, "physicalPort"), "name", physical)
    if not parameters:
        return
    listed = _add(interface, "parameters")
    for parameter, value in parameters.items():
        one = _add(listed, "parameter")
        _add(one, "name", parameter)
        _add(one, "value", value, id=f"BUSIFPARAM_VALUE.{name.upper()}.{parameter}")


def _add_registers(parent: Element, config: Configuration) -> None:
    """Add every register of the design's map; registers of table entries have the entry's number in their names."""
    memory = _add(parent, "memoryMap")
    _add(memory, "name", BUS_TYPES[config.bus][1].rstrip("_").upper())
    block = _add(memory, "addressBlock")
    _add(block, "name", "registers")
    _add(block, "baseAddress", "0x0")
    _add(block, "range", f"{4 << address_bits(config.table):#x}")
    _add(block, "width", 32)
    _add(block, "usage", "register")
    for node in compile_registers(config.table).descendants(unroll=True):
        if not isinstance(node, RegNode):
            continue
        register = _add(block, "register")
        path = node.get_path().removeprefix("ray_caster.")
        _add(register, "name", path.replace("[", "_").replace("].", "_"))
        if about := node.get_property("desc"):
            _add(register, "description", " ".join(about.split()))
        _add(register, "addressOffset", f"{node.absolute_address:#x}")
        _add(register, "size", 32)
        for field in node.fields():
            _add_field(register, field)


def _add_field(register: Element, node: FieldNode) -> None:
    field = _add(register, "field")
    _add(field, "name", node.inst_name)
    if about := node.get_property("desc"):
        _add(field, "description", " ".join(about.split()))
    _add(field, "bitOffset", node.low)
    _add(field, "bitWidth", node.width)
    _add(field, "access", "read-write" if node.is_sw_writable else "read-only")
    if onwrite := node.get_property("onwrite"):
        _add(field, "modifiedWriteValue", WRITES[onwrite.name])


def _add_ports(parent: Element, ports: Sequence[Port]) -> None:
    for port in ports:
        element = _add(parent, "port")
        _add(element, "name", port.name)
        wire = _add(element, "wire")
        _add(wire, "direction", "out" if port.output else "in")
        if port.width > 1:
            vector = _add(wire, "vector")
            _add(vector, "left", port.width - 1)
            _add(vector, "right", 0)
