# SPDX-License-Identifier: MIT
"""Descriptions of the design for other tools and for software.

`test_take_home.py` checks the ports; `test_driver.py` compiles the driver with the header.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import ROOT
from tcl import compare_calls, tcl_calls

from raycaster.configuration import MOST_RECTANGLES, Configuration
from raycaster.convert.platform_designer import COMPONENT, INTERFACES, NIOS_SYSTEM
from raycaster.convert.register_views import HEADER, SOFTWARE, write_header
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.registers import address_bits


def small(**options: object) -> Configuration:
    return configure(screen="tiny", units=2, rectangles=2, allow_underrun=True, **options)


def test_the_component_of_platform_designer(tmp_path):
    """Platform Designer gets the commands that were reviewed with its user guide; files are checked elsewhere."""
    write_verilog(small(), tmp_path / "verilog")
    calls = tcl_calls(tmp_path / "verilog", Path(COMPONENT))
    compare_calls("platform_designer", [call for call in calls if call[0] != "add_fileset_file"])


@pytest.mark.parametrize(
    ("config", "period", "relation"),
    [
        # 50 MHz, two clocks per pixel.
        (small(), "20.000", ("-divide_by", "2")),
        # 74.25 MHz, the pixel clock of 1280x720 in CTA-861.
        (configure(engine="span", rows=180, rectangles=1, reflections=0), "13.468", ("-invert",)),
    ],
    ids=["divided", "inverted"],
)
def test_the_constraints(config, period, relation, tmp_path):
    """`vga_clk` rises in the middle of each pixel."""
    write_verilog(config, tmp_path / "verilog")
    assert tcl_calls(tmp_path / "verilog", Path(f"{TOP}.sdc")) == [
        ["create_clock", "-name", "clk", "-period", period, "[get_ports clk]"],
        ["create_generated_clock", "-name", "vga_clk", "-source", "[get_ports clk]", *relation, "[get_ports vga_clk]"],
    ]


def test_the_nios_system(tmp_path):
    """The system has the commands that were reviewed, and connects each interface of the component."""
    calls = tcl_calls(tmp_path, NIOS_SYSTEM, "set family {MAX 10}\nset device X")
    compare_calls("nios_system", calls)
    # The usual chip is that of Terasic's DE2-115.
    usual = [call[1:] for call in tcl_calls(tmp_path, NIOS_SYSTEM) if call not in calls]
    assert usual == [["DEVICE_FAMILY", "Cyclone IV E"], ["DEVICE", "EP4CE115F29C7"]]
    ends = {end for call in calls for end in call[1:] if end.startswith("raycaster.")}
    assert ends == {f"raycaster.{interface[0]}" for interface in INTERFACES}
    # The registers of the largest design end below the next agent's base address.
    bases = {call[1]: int(call[3], 0) for call in calls if call[2:3] == ["baseAddress"]}
    [base] = [base for connection, base in bases.items() if connection.endswith("/raycaster.s0")]
    size = 4 << address_bits(MOST_RECTANGLES)
    assert base % size == 0
    assert not any(base < other < base + size for other in bases.values())


def test_the_header_has_not_drifted(tmp_path):
    write_header(12, tmp_path / HEADER)
    assert (ROOT / SOFTWARE / HEADER).read_text() == (tmp_path / HEADER).read_text(), "outdated; run make registers"
