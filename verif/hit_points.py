# SPDX-License-Identifier: MIT
"""Read the hit points of a frame from the converted Verilog, to find errors that no pixel shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from raycaster.configuration import Configuration
from raycaster.scene import Scene, dump_scene
from raycaster.sim.job import Job
from raycaster.sim.simulator import BUILD, VERILATOR_FLAGS, Model, build_model, convert, run_bench

PROBE = Path(__file__).with_name("hit_probe.v")


def build_probed_model(configuration: Configuration, build: Path = BUILD) -> Model:
    """Build a model of the seed engine, in Verilator, that records its hit points; see `build_model`."""
    return build_model(
        configuration,
        "verilator",
        build=build,
        verilog=[*convert(configuration, build), PROBE],
        flags=(*VERILATOR_FLAGS, f"+define+PROBED_UNITS={configuration.units}"),
    )


def hit_points(model: Model, scene: Scene, reflections: int, directory: Path) -> tuple[np.ndarray, ...]:
    """Simulate a frame, check every pixel, and read the hit points that the probes recorded.

    Args:
        model: from `build_probed_model`.
        scene: what to show.
        reflections: no more than the hardware has.
        directory: for the frame's pictures, results and logs.

    Returns:
        For the primary ray and each reflection, int64 (rays, 3): the hit point in units of 2^-F, -1 for a miss; rays
        in the order of rows and columns.

    Raises:
        SimulationError: the frame differs from the golden model.
    """
    directory.mkdir(parents=True, exist_ok=True)
    file = directory / "scene.toml"
    file.write_text(dump_scene(scene))
    job = Job(model.configuration, scene=str(file.resolve()), output=str(directory.resolve()), reflections=reflections)
    run_bench(model, "raycaster.sim.frame_bench", job, directory)
    screen = model.configuration.screen_geometry
    points = np.full((reflections + 1, screen.rows, screen.columns, 3), -1, dtype=np.int64)
    for path in sorted(directory.glob("hits.*")):
        # The file goes on with the first rows of the next frame, whose rays are the same.
        lines = np.array(path.read_text().split(), dtype=np.int64).reshape(-1, 6)
        row, column, depth = lines[:, :3].T
        points[depth, row, column] = lines[:, 3:]
        path.unlink()
    for depth in range(1, reflections + 1):
        # The control, shared by all units, also continues rays that missed; their results are ignored.
        points[depth][points[depth - 1] < 0] = -1
    return tuple(points.reshape(reflections + 1, -1, 3))
