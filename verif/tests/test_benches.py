# SPDX-License-Identifier: MIT
"""Benches of the whole design beyond a single frame, on every engine.

Verilator runs the full scene memory; Icarus, some hundred times slower, gets a design and a scene of three rectangles.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, TINY, Bench

from raycaster.configuration import configure
from raycaster.engines import ENGINES, EXACT
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, run_bench
from raycaster.verif.seeds import seed

TRAFFIC_SEEDS = {"verilator": 2, "icarus": 1}
EVERYTHING = dict.fromkeys(EXACT.looks, True)
FULL_SCENE = ROOT / "scenes" / "mirror_room.toml"
DESIGNS = {
    **{engine: ("verilator", configure(engine=engine, screen="tiny"), FULL_SCENE) for engine in ENGINES},
    "small": ("verilator", TINY["exact"], SMALL_SCENE),
    "icarus": ("icarus", configure(screen="tiny", units=8, rectangles=3, culling=False), SMALL_SCENE),
    "everything": ("icarus", configure(engine="exact", screen="tiny", rectangles=3, **EVERYTHING), SMALL_SCENE),
}
"""Simulator, design and scene."""


@pytest.mark.slow_sets(quick=["register-small", "traffic-small"])
@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("name", ["register", "traffic"])
def test_bench(bench: Bench, name: str, design: str):
    """Registers and their effects on the picture; random traffic and resets, after which only whole frames change."""
    simulator, configuration, scene = DESIGNS[design]
    first = 100 * seed()
    seeds = tuple(range(first, first + TRAFFIC_SEEDS[simulator]))
    bench(f"verif.benches.{name}_bench", configuration, simulator, scene, seeds=seeds)


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


def test_the_main_program_matches_cocotb(tmp_path: Path):
    """Our main program and cocotb's main program give the same events and times in a frame without a wrong pixel."""
    configuration = TINY["exact"]
    events = []
    for own_main in (True, False):
        output = tmp_path / str(own_main)
        job = Job(configuration, scene=str(SMALL_SCENE), output=str(output))
        model = build_model(configuration, build=BUILD, own_main=own_main)
        run_bench(model, "raycaster.verif.benches.events_bench", job, output)
        events.append(json.loads((output / "events.json").read_text()))
    ours, theirs = events
    assert next((pair for pair in zip(ours, theirs, strict=False) if pair[0] != pair[1]), None) is None
    assert len(ours) == len(theirs) > 10 * configuration.screen_geometry.vertical.total
