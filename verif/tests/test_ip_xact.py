# SPDX-License-Identifier: MIT
"""The IP-XACT component, read by third-party readers and compared with the register map and the buses."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ipyxact.ipyxact import Component
from peakrdl_ipxact import IPXACTImporter
from systemrdl import RDLCompiler
from systemrdl.node import RegNode

from raycaster.configuration import Configuration, configure
from raycaster.convert.ip_xact import IP_XACT
from raycaster.convert.write import write_verilog
from raycaster.registers import address_bits, register_map

BUS_PORTS = {
    "axi4lite": "AWADDR AWVALID AWREADY WDATA WSTRB WVALID WREADY BRESP BVALID BREADY "
    "ARADDR ARVALID ARREADY RDATA RRESP RVALID RREADY",
    "apb": "PADDR PSEL PENABLE PWRITE PREADY PSLVERR PWDATA PSTRB PRDATA",
}
"""Ports by bus, from the specifications, without protection types."""


def small(bus: str) -> Configuration:
    return configure(screen="tiny", units=2, rectangles=3, allow_underrun=True, bus=bus)


@pytest.fixture(params=BUS_PORTS, scope="module")
def written(request, tmp_path_factory) -> tuple[str, Path]:
    directory = tmp_path_factory.mktemp("ip_xact") / "verilog"
    write_verilog(small(request.param), directory)
    return request.param, directory


def test_registers(written):
    """The component has every offset, and the bits and access of each field."""
    bus, directory = written
    compiler = RDLCompiler()
    IPXACTImporter(compiler).import_file(str(directory / IP_XACT))
    found = {}
    for node in compiler.elaborate().descendants():
        if isinstance(node, RegNode):
            fields = {field.inst_name: (field.low, field.width) for field in node.fields()}
            found[node.inst_name] = node.address_offset, fields
    config = small(bus)
    expected = {
        re.sub(r"\[(\d+)\]\.", r"_\1_", name): (
            4 * register.address,
            {field: (place.lsb, place.width) for field, place in register.fields.items()},
        )
        for name, register in register_map(config.table).items()
    }
    assert found == expected
    text = (directory / IP_XACT).read_text()
    assert f"<spirit:range>{4 << address_bits(config.table):#x}</spirit:range>" in text
    pending = text[text.index("<spirit:name>irq_pending<") :]
    assert "<spirit:modifiedWriteValue>oneToClear<" in pending[: pending.index("</spirit:register>")]


def test_interfaces(written):
    """Each port except the video belongs to one interface."""
    bus, directory = written
    component = Component()
    component.load(str(directory / IP_XACT))
    mapped = {
        interface.name: {one.logicalPort.name: one.physicalPort.name for one in interface.portMaps.portMap}
        for interface in component.busInterfaces.busInterface
    }
    name = {"axi4lite": "S_AXI", "apb": "S_APB"}[bus]
    assert set(mapped) == {name, "clk", "reset", "irq"}
    assert mapped[name] == {one: f"{name}_{one}".lower() for one in BUS_PORTS[bus].split()}
    owned = [physical for one in mapped.values() for physical in one.values()]
    assert sorted(owned) == sorted(port.name for port in component.model.ports.port if not port.name.startswith("vga_"))
