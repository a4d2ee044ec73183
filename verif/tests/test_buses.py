# SPDX-License-Identifier: MIT
"""The whole design behind each bus: third-party drivers write and read its registers, and it draws."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import BUILD, SMALL_SCENE, TINY, Bench, broken

from raycaster.buses import BRIDGED
from raycaster.configuration import ConfigurationError
from raycaster.convert.write import write_scene_system, write_system
from raycaster.fpga import verilog
from raycaster.scene import load_scene
from raycaster.sim.simulator import SIMULATORS, SimulationError, convert
from raycaster.verif.seeds import seed

SCENE = load_scene(SMALL_SCENE)


def small(bus: str):
    return replace(TINY["seed"], bus=bus)


@pytest.mark.slow_sets("apb-verilator", "axi4lite-verilator", "wishbone-icarus", "wishbone-verilator")
@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("bus", BRIDGED)
def test_bus(bench: Bench, bus, simulator):
    """Random words with back-pressure, a frame, and cycles per access; in Icarus, registers start unknown."""
    first = seed()
    bench("verif.benches.bus_bench", small(bus), simulator, SMALL_SCENE, seeds=(first, first + 1, first + 2))


@pytest.mark.slow_sets(quick=["axi4lite-s_axi"])
@pytest.mark.parametrize(
    ("bus", "right", "wrong", "complaint"),
    [
        ("axi4lite", "avm_m0_byteenable = s_axi_wstrb;", "avm_m0_byteenable = 15;", "reads 0x"),
        ("axi4lite", "s_axi_bresp = 0;", "s_axi_bresp = 2;", "got the response"),
        ("wishbone", "avm_m0_byteenable = wb_sel;", "avm_m0_byteenable = 15;", "reads 0x"),
        ("wishbone", "avm_m0_address = wb_adr;", "avm_m0_address = wb_adr | 1;", "reads 0x"),
        ("apb", "avm_m0_byteenable = s_apb_pstrb;", "avm_m0_byteenable = 15;", "reads 0x"),
        ("apb", "s_apb_paddr[", "s_apb_pwdata[", "reads 0x"),
    ],
)
def test_a_fault_is_noticed(bench: Bench, tmp_path, bus, right, wrong, complaint):
    files = broken(convert(small(bus), BUILD), tmp_path, f"{bus}_bridge", right, wrong)
    with pytest.raises(SimulationError, match=complaint):
        bench("verif.benches.bus_bench", small(bus), "icarus", SMALL_SCENE, seeds=(seed(),), verilog=files)


@pytest.mark.parametrize("write", [write_system, lambda *given: write_scene_system(*given[:1], SCENE, *given[1:])])
def test_systems_with_their_own_host_refuse_other_buses(tmp_path, write):
    with pytest.raises(ConfigurationError, match=r"bus: a system with.* processor drives .*; leave out apb$"):
        write(small("apb"), tmp_path / "verilog")
    assert not any(tmp_path.iterdir())


def test_an_unknown_bus_gets_one_line(refuses):
    error = refuses(verilog.main, "--bus", "pci")
    assert error.startswith("error: bus: ") and "axi4lite, wishbone or apb, got pci" in error
