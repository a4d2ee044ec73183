# SPDX-License-Identifier: MIT
"""The traffic bench notices faults in the bus and in reset, and registers start unknown."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import BUILD, SMALL_SCENE, TINY, Bench, broken

from raycaster.buses import BRIDGED, OWN
from raycaster.sim.simulator import SimulationError, convert

SMALL = TINY["seed"]


BENCH = "verif.benches.traffic_bench"
GATED = {"CLOCK_GATING": 1}
"""Makes clocks rest in Icarus, as they do in Verilator's models; see `clock_gate`."""

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
    "over-another-copy": ("rect_mem", "place = 2;", "place = 1;", "pixels are wrong"),
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
    "answered-after-reset", "live-in-mid-frame", "rectangles-too-early", "unmapped-aliases", "waits-in-a-burst"
)
@pytest.mark.parametrize("fault", FAULTS | RESTING)
def test_is_noticed(bench: Bench, tmp_path, fault):
    """Each planted fault causes its complaint."""
    *place, complaint = (FAULTS | RESTING)[fault]
    said = rf"(seed \d+|the frame after reset): .*({complaint})" if fault in FAULTS else complaint
    with pytest.raises(SimulationError, match=said):
        bench(
            BENCH, SMALL, "icarus", seeds=(1, 2), verilog=broken(convert(SMALL, BUILD), tmp_path, *place),
            defines=GATED if fault in RESTING else None,
        )  # fmt: skip


def test_icarus_takes_clocks_that_rest(bench: Bench):
    bench(BENCH, SMALL, "icarus", seeds=(1, 2), defines=GATED)


STARTS = [*((OWN, start) for start in (1, 2, 3, 4)), *((bus, start) for bus in BRIDGED for start in (1, 2))]


@pytest.mark.slow_sets(quick=["avalon-1", "axi4lite-1"])
@pytest.mark.parametrize(("bus", "start"), STARTS)
def test_random_start(bench: Bench, bus, start):
    """Registers and memories start with random values, which have no effect after reset."""
    bench("sim.frame_bench", replace(SMALL, bus=bus), "verilator", SMALL_SCENE, plusargs=random_values(start))


def random_values(start: int) -> tuple[str, str]:
    """Return Verilator options that its models take at run time."""
    return "+verilator+rand+reset+2", f"+verilator+seed+{start}"


def test_the_start_is_random(bench: Bench, tmp_path):
    """Without its reset, a counter starts at a different random value each time."""
    files = broken(convert(SMALL, BUILD), tmp_path, "avalon_interface", "frame <= 0;", "frame <= frame;")
    complaints = set()
    for start in (1, 2, 3):
        with pytest.raises(SimulationError, match="status reads") as caught:
            bench(BENCH, SMALL, "verilator", seeds=(1,), verilog=files, plusargs=random_values(start))
        complaints.add(str(caught.value).partition(";")[0])
    assert len(complaints) == 3, complaints


def test_an_unknown_start_is_noticed(bench: Bench, tmp_path):
    """Without their reset, registers in Icarus start unknown and stay so."""
    files = broken(convert(SMALL, BUILD), tmp_path, "video_generator", "if (reset == 1)", "if (1'b0)")
    with pytest.raises(SimulationError, match=r"no leading edge of HS|neither 0 nor 1"):
        bench("sim.frame_bench", SMALL, "icarus", SMALL_SCENE, verilog=files)
