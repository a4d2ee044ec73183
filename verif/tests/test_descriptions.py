# SPDX-License-Identifier: MIT
"""Descriptions of the design for other tools and for software.

`test_take_home.py` checks the ports; `test_driver.py` compiles the driver with the header.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import ROOT
from systemrdl.node import RegNode
from tcl import compare_calls, tcl_calls

from raycaster.configuration import MOST_RECTANGLES, Configuration, configure
from raycaster.convert.platform_designer import COMPONENT, NIOS_SYSTEM, component, interfaces
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.hdl.hierarchy import Port
from raycaster.register_views import HEADER, SOFTWARE, write_header
from raycaster.registers import address_bits, compile_registers


def small(**options: object) -> Configuration:
    return configure(screen="tiny", units=2, rectangles=2, allow_underrun=True, **options)


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
