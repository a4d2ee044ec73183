# SPDX-License-Identifier: MIT
"""Benches of the whole design beyond a single frame, on every engine.

Verilator runs the full scene memory; Icarus, some hundred times slower, gets a design and a scene of three rectangles.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, Bench

from raycaster.configuration import Configuration, configure
from raycaster.engines import ENGINES, EXACT
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, run_bench
from raycaster.verif.seeds import seed

TRAFFIC_SEEDS = {"verilator": 2, "icarus": 1}
EVERYTHING = dict.fromkeys(EXACT.looks, True)
FULL_SCENE = ROOT / "scenes" / "mirror_room.toml"
DESIGNS = [
    *(pytest.param("verilator", configure(engine=engine, screen="tiny"), FULL_SCENE, id=engine) for engine in ENGINES),
    pytest.param("icarus", configure(screen="tiny", units=8, rectangles=3, culling=False), SMALL_SCENE, id="icarus"),
    pytest.param(
        "icarus", configure(engine="exact", screen="tiny", rectangles=3, **EVERYTHING), SMALL_SCENE, id="everything"
    ),
]
on_every_engine = pytest.mark.parametrize(("simulator", "configuration", "scene"), DESIGNS)


@pytest.mark.slow_sets(quick=["exact"])
@on_every_engine
def test_motion(bench: Bench, simulator: str, configuration: Configuration, scene: Path):
    """Changes appear only in whole frames; StartScreen interrupts."""
    bench("verif.benches.motion_bench", configuration, simulator, scene)


@pytest.mark.slow
def test_motion_full_size(bench: Bench):
    """Motion at 640x480."""
    bench("verif.benches.motion_bench", configure(), "verilator", FULL_SCENE)


@pytest.mark.usefixtures("random")
@pytest.mark.slow_sets("beam", "everything", "icarus", "seed")
@on_every_engine
def test_registers(bench: Bench, simulator: str, configuration: Configuration, scene: Path):
    """The scene's words, and the effects of registers on the picture."""
    bench("verif.benches.register_bench", configuration, simulator, scene)


@pytest.mark.usefixtures("random")
@pytest.mark.slow_sets("beam", "everything", "icarus", "seed")
@on_every_engine
def test_traffic(bench: Bench, simulator: str, configuration: Configuration, scene: Path):
    """Random traffic, and resets at any time: check every answer, the interrupt, the sync and the picture."""
    first = 100 * seed()
    seeds = tuple(range(first, first + TRAFFIC_SEEDS[simulator]))
    bench("verif.benches.traffic_bench", configuration, simulator, seeds=seeds)


@pytest.mark.slow_sets("beam-pairs", "exact", "icarus", "seed")
@pytest.mark.parametrize(
    ("simulator", "options"),
    [
        pytest.param("verilator", {"units": 4}, id="seed"),
        pytest.param("verilator", {"engine": "exact", "units": 2}, id="exact"),
        pytest.param("verilator", {"engine": "beam", "allow_underrun": False}, id="beam"),
        pytest.param("verilator", {"engine": "beam", "pixels": 2, "allow_underrun": False}, id="beam-pairs"),
        pytest.param("icarus", {"units": 4, "rectangles": 3, "divider_bits": 1, "culling": False}, id="icarus"),
    ],
)
def test_underrun(bench: Bench, simulator: str, options: dict[str, Any]):
    """Fewer units than the scene needs; the beam engine tests all rectangles at once and is never late."""
    configuration = configure(**{"screen": "tiny", "allow_underrun": True} | options)
    bench("verif.benches.underrun_bench", configuration, simulator)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_main_program_matches_cocotb(tmp_path: Path, engine: str):
    """Our main program and cocotb's main program give the same events, times and picture."""
    configuration = configure(engine=engine, screen="tiny", rectangles=3, **{"units": 8} if engine == "seed" else {})
    events, pictures = [], []
    for own_main in (True, False):
        output = tmp_path / str(own_main)
        job = Job(configuration, scene=str(SMALL_SCENE), output=str(output))
        model = build_model(configuration, build=BUILD, own_main=own_main)
        run_bench(model, "raycaster.verif.benches.events_bench", job, output)
        events.append([tuple(event) for event in json.loads((output / "events.json").read_text())])
        pictures.append((output / "frame.png").read_bytes())
    ours, theirs = events
    assert next((pair for pair in zip(ours, theirs, strict=False) if pair[0] != pair[1]), None) is None
    assert len(ours) == len(theirs) > 10 * configuration.screen_geometry.vertical.total
    assert pictures[0] == pictures[1]
