# SPDX-License-Identifier: MIT
"""The benches of the whole design beyond a single frame.

Verilator has the full scene memory; Icarus, some hundred times slower, a design and a scene of three rectangles.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import ROOT, SMALL_SCENE, Bench

from raycaster.configuration import Configuration, configure
from raycaster.sim.simulator import SimulationError
from raycaster.verif.seeds import repeat, seed

TRAFFIC_SEEDS = {"verilator": 2, "icarus": 1}
FULL_SCENE = ROOT / "scenes" / "mirror_room.toml"
DESIGNS = [
    pytest.param("verilator", configure(screen="tiny"), FULL_SCENE, id="verilator"),
    pytest.param("icarus", configure(screen="tiny", units=8, rectangles=3, culling=False), SMALL_SCENE, id="icarus"),
    pytest.param("verilator", configure(engine="beam", screen="tiny"), FULL_SCENE, id="beam"),
]


@pytest.mark.parametrize(("simulator", "configuration", "scene"), DESIGNS)
def test_motion(bench: Bench, simulator: str, configuration: Configuration, scene: Path):
    """Changes show in whole frames only; StartScreen and its interrupt."""
    bench("verif.benches.motion_bench", configuration, simulator, scene)


def test_motion_full_size(bench: Bench):
    """The same at 640x480."""
    bench("verif.benches.motion_bench", configure(), "verilator", FULL_SCENE)


@pytest.mark.parametrize(("simulator", "configuration", "scene"), DESIGNS)
def test_registers(bench: Bench, simulator: str, configuration: Configuration, scene: Path):
    """The register map, and what its bits do."""
    bench("verif.benches.register_bench", configuration, simulator, scene)


@pytest.mark.parametrize(("simulator", "configuration", "scene"), DESIGNS)
def test_traffic(bench: Bench, simulator: str, configuration: Configuration, scene: Path):
    """Random traffic and a reset at every moment: each answer, the interrupt, the sync and the picture."""
    first = 100 * seed()
    try:
        bench(
            "verif.benches.traffic_bench",
            configuration,
            simulator,
            seeds=tuple(range(first, first + TRAFFIC_SEEDS[simulator])),
        )
    except SimulationError as error:
        pytest.fail(f"{error}; {repeat()}")


@pytest.mark.parametrize(
    ("simulator", "options"),
    [
        pytest.param("verilator", {"units": 4}, id="verilator"),
        pytest.param("icarus", {"units": 4, "rectangles": 3, "divider_bits": 1, "culling": False}, id="icarus"),
    ],
)
def test_underrun(bench: Bench, simulator: str, options: dict[str, int]):
    """Fewer units than the scene would need."""
    bench("verif.benches.underrun_bench", configure(screen="tiny", allow_underrun=True, **options), simulator)
