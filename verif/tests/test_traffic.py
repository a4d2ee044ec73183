# SPDX-License-Identifier: MIT
"""The traffic bench notices faults in the bus and in reset, and registers start unknown."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import BUILD, SMALL_SCENE, Bench

from raycaster.configuration import configure
from raycaster.sim.simulator import SimulationError, convert

SMALL = configure(screen="tiny", units=8, rectangles=3)


def broken(directory: Path, module: str, right: str, wrong: str) -> list[Path]:
    """Return the design's files with one module changed."""
    files = []
    for source in convert(SMALL, BUILD):
        text = source.read_text()
        if source.stem == module:
            assert right in text, f"{module} has no {right!r}"
            text = text.replace(right, wrong)
        files.append(directory / source.name)
        files[-1].write_text(text)
    return files


@pytest.mark.slow_sets(
    "answered-after-reset", "live-in-mid-frame", "rectangles-too-early", "unmapped-aliases", "waits-in-a-burst"
)
@pytest.mark.parametrize(
    ("module", "right", "wrong", "complaint"),
    [
        pytest.param("avalon_interface", "if (avs_s0_byteenable[2])", "if (1'b1)", "reads 0x", id="a-lane-always"),
        pytest.param("rect_mem", "= pattern_word;", "= old_surface;", "reads 0x", id="unmapped-aliases"),
        pytest.param(
            "avalon_interface", "readdatavalid <= reading;", "readdatavalid <= reading && !avs_s0_read;",
            "avs_s0_readdatavalid is 0, expected 1", id="answer-lost",
        ),
        pytest.param(
            "avalon_interface", "reading <= 0;", "reading <= reading;", "avs_s0_readdatavalid is X|is 1, expected 0",
            id="answered-after-reset",
        ),
        pytest.param(
            "avalon_interface", "wait_request <= 1'b0;", "wait_request <= avs_s0_write && bus_write;",
            "avs_s0_waitrequest is 1, expected 0", id="waits-in-a-burst",
        ),
        pytest.param(
            "scene_word", "if (bus_go_live)", "if (bus_go_live || bus_commit)", "pixels are wrong|cycles reads",
            id="live-in-mid-frame",
        ),
        pytest.param("rect_slot", "if (bus_go_live)", "if (bus_commit)", "pixels are wrong", id="rectangles-too-early"),
        pytest.param("rect_mem", "place = 2;", "place = 1;", "pixels are wrong", id="over-another-copy"),
        pytest.param("video_generator", "x <= -32;", "x <= -31;", "irq is 0, expected 1", id="restarts-too-early"),
    ],
)  # fmt: skip
def test_is_noticed(bench: Bench, tmp_path, module, right, wrong, complaint):
    """Each planted fault causes its complaint."""
    files = broken(tmp_path, module, right, wrong)
    with pytest.raises(SimulationError, match=rf"(seed \d+|the frame after reset): .*({complaint})"):
        bench("verif.benches.traffic_bench", SMALL, "icarus", seeds=(1, 2), verilog=files)


GATED = {"CLOCK_GATING": 1}


def test_icarus_takes_clocks_that_rest(bench: Bench):
    """Icarus can simulate gated clocks, as Verilator's models do; see `clock_gate`."""
    bench("verif.benches.traffic_bench", SMALL, "icarus", seeds=(1, 2), defines=GATED)


@pytest.mark.parametrize(
    ("module", "right", "wrong", "complaint"),
    [
        pytest.param("clock_gate", "open = awake;", "open = !awake;", "non-0/1", id="the-other-way"),
        pytest.param(
            "ray_caster_renderer", "enable || reset_ray_caster", "reset_ray_caster", "cycles reads", id="rendering"
        ),
        pytest.param("ray_caster_module", "|| bus_write ", "", "reads 0x", id="a-write"),
        pytest.param("ray_caster_module", "|| bus_commit ", "", "pixels are wrong", id="a-commit"),
        pytest.param("ray_caster_module", "|| bus_go_live ", "", "pixels are wrong", id="start-screen"),
        pytest.param("ray_caster_module", "|| progress_busy", "", "pixels are wrong", id="a-fetch"),
        pytest.param("ray_caster_module", "= reset ||", "=", "reads 0x", id="a-reset"),
    ],
)
def test_a_clock_that_rests_too_long_is_noticed(bench: Bench, tmp_path, module, right, wrong, complaint):
    """Each reason to wake the clock is left out alone."""
    files = broken(tmp_path, module, right, wrong)
    with pytest.raises(SimulationError, match=complaint):
        bench("verif.benches.traffic_bench", SMALL, "icarus", seeds=(1, 2), verilog=files, defines=GATED)


@pytest.mark.slow_sets("2", "3", "4")
@pytest.mark.parametrize("start", [1, 2, 3, 4])
def test_random_start(bench: Bench, start):
    """Registers and memories start with random values, which have no effect after reset."""
    bench("sim.frame_bench", SMALL, "verilator", SMALL_SCENE, plusargs=random_values(start))


def random_values(start: int) -> tuple[str, str]:
    """Return Verilator options that its models take at run time."""
    return "+verilator+rand+reset+2", f"+verilator+seed+{start}"


def test_the_start_is_random(bench: Bench, tmp_path):
    """Without its reset, a counter starts at a different random value each time."""
    files = broken(tmp_path, "avalon_interface", "frame <= 0;", "frame <= frame;")
    complaints = set()
    for start in (1, 2, 3):
        with pytest.raises(SimulationError, match="status reads") as caught:
            bench(
                "verif.benches.traffic_bench",
                SMALL,
                "verilator",
                seeds=(1,),
                verilog=files,
                plusargs=random_values(start),
            )
        complaints.add(str(caught.value).partition(";")[0])
    assert len(complaints) == 3, complaints


def test_an_unknown_start_is_noticed(bench: Bench, tmp_path):
    """Without their reset, registers in Icarus start unknown and stay so."""
    files = broken(tmp_path, "video_generator", "if (reset == 1)", "if (1'b0)")
    with pytest.raises(SimulationError, match=r"no leading edge of HS|neither 0 nor 1"):
        bench("sim.frame_bench", SMALL, "icarus", SMALL_SCENE, verilog=files)
