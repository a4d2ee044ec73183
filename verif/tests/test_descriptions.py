# SPDX-License-Identifier: MIT
"""Descriptions of the design for other tools and for software, most of them read by third-party readers.

`test_take_home.py` checks the ports; `test_driver.py` compiles the driver with the header.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import ROOT
from ipyxact.ipyxact import Component
from peakrdl_ipxact import IPXACTImporter
from systemrdl import RDLCompiler
from systemrdl.node import RegNode
from tcl import compare_calls, tcl_calls

from raycaster.configuration import MOST_RECTANGLES, Configuration, configure
from raycaster.convert.ip_xact import IP_XACT
from raycaster.convert.platform_designer import COMPONENT, NIOS_SYSTEM, component, interfaces
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.hdl.hierarchy import Port
from raycaster.register_views import HEADER, SOFTWARE, write_header
from raycaster.registers import address_bits, compile_registers, register_map

BUS_PORTS = {
    "axi4lite": "AWADDR AWVALID AWREADY WDATA WSTRB WVALID WREADY BRESP BVALID BREADY "
    "ARADDR ARVALID ARREADY RDATA RRESP RVALID RREADY",
    "apb": "PADDR PSEL PENABLE PWRITE PREADY PSLVERR PWDATA PSTRB PRDATA",
}
"""Ports by bus, from the specifications, without protection types."""


def small(**options: object) -> Configuration:
    return configure(screen="tiny", units=2, rectangles=2, allow_underrun=True, **options)


@pytest.fixture(params=BUS_PORTS, scope="module")
def written(request, tmp_path_factory) -> tuple[str, Path]:
    """Write a design with a bus that IP-XACT knows; return the bus and the component."""
    directory = tmp_path_factory.mktemp("ip_xact") / "verilog"
    write_verilog(small(bus=request.param), directory)
    return request.param, directory / IP_XACT


def test_registers_of_ip_xact(written):
    """The component has every offset, and the bits and access of each field; the C header has the table's length."""
    bus, path = written
    compiler = RDLCompiler()
    IPXACTImporter(compiler).import_file(str(path))
    found = {}
    for node in compiler.elaborate().descendants():
        if isinstance(node, RegNode):
            fields = {field.inst_name: (field.low, field.width) for field in node.fields()}
            found[node.inst_name] = node.address_offset, fields
    table = small(bus=bus).table
    assert found == {
        re.sub(r"\[(\d+)\]\.", r"_\1_", name): (
            4 * register.address,
            {field: (place.lsb, place.width) for field, place in register.fields.items()},
        )
        for name, register in register_map(table).items()
    }
    text = path.read_text()
    assert f"<spirit:range>{4 << address_bits(table):#x}</spirit:range>" in text
    pending = text[text.index("<spirit:name>irq_pending<") :]
    assert "<spirit:modifiedWriteValue>oneToClear<" in pending[: pending.index("</spirit:register>")]
    assert f"rectangle[{table}];" in (path.parent / HEADER).read_text()


def test_interfaces_of_ip_xact(written):
    """Each port except the video belongs to one interface."""
    bus, path = written
    component = Component()
    component.load(str(path))
    mapped = {
        interface.name: {one.logicalPort.name: one.physicalPort.name for one in interface.portMaps.portMap}
        for interface in component.busInterfaces.busInterface
    }
    name = {"axi4lite": "S_AXI", "apb": "S_APB"}[bus]
    assert set(mapped) == {name, "clk", "reset", "irq"}
    assert mapped[name] == {one: f"{name}_{one}".lower() for one in BUS_PORTS[bus].split()}
    owned = [physical for one in mapped.values() for physical in one.values()]
    assert sorted(owned) == sorted(port.name for port in component.model.ports.port if not port.name.startswith("vga_"))


def test_the_component_of_platform_designer(tmp_path):
    """Platform Designer gets the commands that were reviewed with its user guide; others are checked elsewhere."""
    write_verilog(small(), tmp_path / "verilog")
    calls = tcl_calls(tmp_path / "verilog", Path(COMPONENT))
    elsewhere = "add_fileset_file", "set_module_assignment"
    compare_calls("platform_designer", [call for call in calls if call[0] not in elsewhere])


@pytest.mark.parametrize(
    ("options", "hz"), [({}, 50_000_000), ({"engine": "beam", "rows": 180}, 74_250_000)], ids=["640x480", "1280x720"]
)
def test_the_clock_of_the_component(options, hz):
    text = component(configure(**options), [Port("clk", 1, False, True)], [f"{TOP}.v"])
    assert f"set_interface_property clock clockRate {hz}\n" in text


def test_an_unknown_port_is_refused():
    with pytest.raises(ValueError, match="strange belongs to 0 interfaces"):
        component(small(), [Port("strange", 1, False, True)], [f"{TOP}.v"])


@pytest.mark.parametrize("processor", ["nios2", "niosv"])
def test_a_nios_system(processor, tmp_path):
    """The system has the commands that were reviewed, and connects each interface of the component."""
    calls, base = (
        tcl_calls(tmp_path, NIOS_SYSTEM, f"set processor {one}\nset family {{MAX 10}}\nset device X")
        for one in (processor, "nios2")
    )
    compare_calls(f"nios_system_{processor}", calls, base if processor != "nios2" else ())
    ends = {end for call in calls for end in call[1:] if end.startswith("raycaster.")}
    assert ends == {f"raycaster.{interface.name}" for interface in interfaces(small())}
    # The registers of the largest design end below the next agent's base address.
    bases = {call[1]: int(call[3], 0) for call in calls if call[2:3] == ["baseAddress"]}
    [base] = [base for connection, base in bases.items() if connection.endswith("/raycaster.s0")]
    size = 4 << address_bits(MOST_RECTANGLES)
    assert base % size == 0
    assert not any(base < other < base + size for other in bases.values())


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ("set processor nios2\nset family {MAX 10}", "device is not set; see the head of nios_system.tcl"),
        ("set processor arm\nset family x\nset device x", "processor: expected nios2 or niosv, got arm"),
    ],
)
def test_a_nios_system_says_what_it_needs(settings, complaint, tmp_path):
    with pytest.raises(AssertionError, match=f"^{complaint}"):
        tcl_calls(tmp_path, NIOS_SYSTEM, settings)


def test_the_header_has_not_drifted(tmp_path):
    write_header(12, tmp_path / HEADER)
    assert (ROOT / SOFTWARE / HEADER).read_text() == (tmp_path / HEADER).read_text(), "outdated; run make registers"


def test_each_register_and_field_has_a_text():
    """All texts differ, except those of a rectangle's two corners, which share a type."""
    registers = [node for node in compile_registers(12).descendants() if isinstance(node, RegNode)]
    texts = {node.get_path(): node.get_property("desc") for node in registers}
    assert all(texts.values())
    assert len(set(texts.values())) == len(texts) - 1
    assert all(field.get_property("desc") for node in registers for field in node.fields())
