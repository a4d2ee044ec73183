# SPDX-License-Identifier: MIT
"""The whole design behind each bus: random accesses, resting clocks, random starts, and faults that are noticed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import pytest
from conftest import BUILD, SMALL_SCENE, TINY, Bench, broken

from raycaster.buses import BRIDGED, OWN
from raycaster.configuration import ConfigurationError
from raycaster.convert.write import write_scene_system, write_system
from raycaster.scene import load_scene
from raycaster.sim.simulator import SIMULATORS, SimulationError, convert
from raycaster.verif.seeds import seed

SCENE = load_scene(SMALL_SCENE)
SMALL = {bus: replace(TINY["seed"], bus=bus) for bus in (OWN, *BRIDGED)}
BUS_BENCH, TRAFFIC_BENCH = "verif.benches.bus_bench", "verif.benches.traffic_bench"
GATED = {"CLOCK_GATING": 1}
"""Makes clocks rest in Icarus, as they do in Verilator's models; see `clock_gate`."""

Noticed = Callable[..., str]


@pytest.fixture
def noticed(bench: Bench, tmp_path) -> Noticed:
    """Return a function that plants a fault, runs a bench, which must fail, and returns its complaint."""

    def run(where: tuple[str, str, str], module: str, simulator: str = "icarus", bus: str = OWN, **options) -> str:
        files = broken(convert(SMALL[bus], BUILD), tmp_path, *where)
        with pytest.raises(SimulationError) as error:
            bench(module, SMALL[bus], simulator, SMALL_SCENE, verilog=files, **options)
        return str(error.value)

    return run


@pytest.mark.slow_sets("apb", "axi4lite-verilator", "wishbone-icarus", "wishbone-verilator")
@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("bus", BRIDGED)
def test_bus(bench: Bench, bus, simulator):
    """Random words with back-pressure, a frame, and cycles per access; in Icarus, registers start unknown."""
    first = seed()
    bench(BUS_BENCH, SMALL[bus], simulator, SMALL_SCENE, seeds=(first, first + 1, first + 2))


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
def test_a_fault_in_a_bridge_is_noticed(noticed: Noticed, bus, right, wrong, complaint):
    assert complaint in noticed((f"{bus}_bridge", right, wrong), BUS_BENCH, bus=bus, seeds=(seed(),))


FAULTS = {
    "a-lane-always": ("avalon_interface", "if (avs_s0_byteenable[2])", "if (1'b1)", "reads 0x"),
    "unmapped-aliases": ("rect_mem", "= pattern_word;", "= old_surface;", "reads 0x"),
    "answer-lost": (
        "avalon_interface", "readdatavalid <= reading;", "readdatavalid <= reading && !avs_s0_read;",
        "avs_s0_readdatavalid is 0, expected 1",
    ),
    "answered-after-reset": (
        "avalon_interface", "reading <= 0;", "reading <= reading;", "avs_s0_readdatavalid is X|is 1, expected 0",
    ),
    "waits-in-a-burst": (
        "avalon_interface", "wait_request <= 1'b0;", "wait_request <= avs_s0_write && bus_write;",
        "avs_s0_waitrequest is 1, expected 0",
    ),
    "live-in-mid-frame": (
        "scene_word", "if (bus_go_live)", "if (bus_go_live || bus_commit)", "pixels are wrong|cycles reads",
    ),
    "rectangles-too-early": ("rect_slot", "if (bus_go_live)", "if (bus_commit)", "pixels are wrong"),
    "over-another-copy": ("rect_mem", "bank = 2;", "bank = 1;", "pixels are wrong"),
    "restarts-too-early": ("video_generator", "x <= -32;", "x <= -31;", "irq is 0, expected 1"),
}  # fmt: skip
"""Module, right and wrong Verilog, and the complaint."""

RESTING = {
    "the-other-way": ("clock_gate", "open = awake;", "open = !awake;", "non-0/1"),
    "rendering": ("ray_caster_renderer", "enable || reset_ray_caster", "reset_ray_caster", "cycles reads"),
    "a-write": ("ray_caster_module", "|| bus_write ", "", "reads 0x"),
    "a-commit": ("ray_caster_module", "|| bus_commit ", "", "pixels are wrong"),
    "start-screen": ("ray_caster_module", "|| bus_go_live ", "", "pixels are wrong"),
    "a-fetch": ("ray_caster_module", "|| progress_busy", "", "pixels are wrong"),
    "a-reset": ("ray_caster_module", "= reset ||", "=", "reads 0x"),
}
"""Faults that let a clock rest too long: each reason to wake it is left out alone."""


@pytest.mark.slow_sets(
    "a-commit", "a-fetch", "answered-after-reset", "live-in-mid-frame", "rectangles-too-early", "start-screen",
    "unmapped-aliases", "waits-in-a-burst",
)  # fmt: skip
@pytest.mark.parametrize("fault", FAULTS | RESTING)
def test_a_fault_is_noticed_in_traffic(noticed: Noticed, fault):
    *where, complaint = (FAULTS | RESTING)[fault]
    place = r"(seed \d+|the frame after reset): .*" if fault in FAULTS else ""
    said = noticed(where, TRAFFIC_BENCH, seeds=(1, 2), defines=GATED if fault in RESTING else None)
    assert re.search(f"{place}({complaint})", said)


def test_icarus_takes_clocks_that_rest(bench: Bench):
    bench(TRAFFIC_BENCH, SMALL[OWN], "icarus", seeds=(1,), defines=GATED)


def random_values(start: int) -> tuple[str, str]:
    """Return Verilator options that its models take at run time."""
    return "+verilator+rand+reset+2", f"+verilator+seed+{start}"


@pytest.mark.slow_sets(quick=["avalon-1", "axi4lite-1"])
@pytest.mark.parametrize(
    ("bus", "start"), [(bus, start) for bus in SMALL for start in ((1, 2, 3, 4) if bus == OWN else (1, 2))]
)
def test_random_start(bench: Bench, bus, start):
    """Registers and memories start with random values, which have no effect after reset."""
    bench("sim.frame_bench", SMALL[bus], "verilator", SMALL_SCENE, plusargs=random_values(start))


def test_the_start_is_random(noticed: Noticed):
    """Without its reset, a counter starts at a different random value each time."""
    fault = "avalon_interface", "frame <= 0;", "frame <= frame;"
    complaints = {
        noticed(fault, TRAFFIC_BENCH, "verilator", seeds=(1,), plusargs=random_values(start)).partition(";")[0]
        for start in (1, 2, 3)
    }
    assert len(complaints) == 3
    assert all("status reads" in complaint for complaint in complaints)


def test_an_unknown_start_is_noticed(noticed: Noticed):
    """Without their reset, registers in Icarus start unknown and stay so."""
    said = noticed(("video_generator", "if (reset == 1)", "if (1'b0)"), "sim.frame_bench")
    assert "no leading edge of HS" in said or "neither 0 nor 1" in said


@pytest.mark.parametrize("write", [write_system, lambda *given: write_scene_system(*given[:1], SCENE, *given[1:])])
def test_systems_with_their_own_host_refuse_other_buses(tmp_path, write):
    with pytest.raises(ConfigurationError, match=r"bus: a system with.* processor drives .*; leave out apb$"):
        write(SMALL["apb"], tmp_path / "verilog")
    assert not any(tmp_path.iterdir())
