# SPDX-License-Identifier: MIT
"""The Platform Designer component and the Nios system, run in a real Tcl; `test_take_home.py` checks the ports."""

from __future__ import annotations

from pathlib import Path

import pytest
from tcl import compare_calls, tcl_calls

from raycaster.configuration import MOST_RECTANGLES, configure
from raycaster.convert.platform_designer import COMPONENT, NIOS_SYSTEM, component, interfaces
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.hdl.hierarchy import Port
from raycaster.registers import address_bits

CONFIG = configure(screen="tiny", units=2, rectangles=2, allow_underrun=True)


def test_the_component(tmp_path):
    """Platform Designer gets the commands that were reviewed with its user guide; the files are checked elsewhere."""
    write_verilog(CONFIG, tmp_path / "verilog")
    calls = tcl_calls(tmp_path / "verilog", Path(COMPONENT))
    compare_calls("platform_designer", [call for call in calls if call[0] != "add_fileset_file"])


def test_an_unknown_port_is_refused():
    with pytest.raises(ValueError, match="strange belongs to 0 interfaces"):
        component(CONFIG, [Port("strange", 1, False, True)], [f"{TOP}.v"])


@pytest.mark.parametrize("processor", ["nios2", "niosv"])
def test_a_nios_system(processor, tmp_path):
    """The system has the commands that were reviewed, and connects each interface of the component."""
    calls = tcl_calls(tmp_path, NIOS_SYSTEM, f"set processor {processor}\nset family {{MAX 10}}\nset device X")
    compare_calls(f"nios_system_{processor}", calls)
    ends = {end for call in calls for end in call[1:] if end.startswith("raycaster.")}
    assert ends == {f"raycaster.{interface.name}" for interface in interfaces(CONFIG)}
    # The largest design's registers end before the next agent's.
    bases = {call[1]: int(call[3], 0) for call in calls if call[2:3] == ["baseAddress"]}
    [base] = [base for connection, base in bases.items() if connection.endswith("/raycaster.s0")]
    size = 4 << address_bits(MOST_RECTANGLES)
    assert base % size == 0
    assert not any(base < other < base + size for other in bases.values())
    assert ["add_instance", "raycaster", TOP] in calls


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
