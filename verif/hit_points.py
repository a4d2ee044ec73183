# SPDX-License-Identifier: MIT
"""Read the hit points of a frame from the converted Verilog, to find errors that no pixel shows."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from raycaster.configuration import Configuration
from raycaster.debug.probes.engines import description_of
from raycaster.scene import Scene, dump_scene
from raycaster.sim.job import Job
from raycaster.sim.simulator import BUILD, Model, build_model, convert, run_bench

_PROBE = """\
// SPDX-License-Identifier: MIT
// Writes a line "row column depth x y z" for each ray that hits something, in units of 2^-F, into the file `hits`.

module hit_probe (input wire clk);
    integer depth = 0;              // of the ray that ended last
    integer file;
    initial file = $fopen("hits", "w");
    // Blocking assignments: each statement sees the updates of the same clock edge.
    always @(posedge clk)
        if ({add_colour}) begin
            depth = {initial_ray} ? 0 : depth + 1;
{units}
        end
endmodule

bind ray_caster_module hit_probe hit_probe_i (.clk(clk));
"""
_UNIT = """\
            if ({found})
                $fwrite(file, "%0d %0d %0d %0d %0d %0d\\n", {row}, {offset} * {units} + {unit}, depth, {point});
"""


def probe_verilog(configuration: Configuration) -> str:
    """Generate the probe, from the description of the engine's signals."""
    each = [description_of(configuration, unit).signals for unit in range(configuration.units)]
    names = {"add_colour": "steps_add_colour", "initial_ray": "comes from the camera"}
    names |= {"row": "place_row", "offset": "place_column_offset"}
    common = {field: each[0](name)[0] for field, name in names.items()}
    units = (
        _UNIT.format(
            **common, units=len(each), unit=unit, found=signals("found")[0], point=", ".join(signals("nearest point"))
        )
        for unit, signals in enumerate(each)
    )
    return _PROBE.format(**common, units="".join(units).rstrip())


def build_probed_model(configuration: Configuration, build: Path = BUILD) -> Model:
    """Build a model of the seed engine, in Verilator, that records its hit points; see `build_model`."""
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        probe = Path(scratch) / "hit_probe.v"
        probe.write_text(probe_verilog(configuration))
        return build_model(configuration, build=build, verilog=[*convert(configuration, build), probe])


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
    # The file goes on with the first rows of the next frame, whose rays are the same.
    recorded = directory / "hits"
    lines = np.array(recorded.read_text().split(), dtype=np.int64).reshape(-1, 6)
    row, column, depth = lines[:, :3].T
    points[depth, row, column] = lines[:, 3:]
    recorded.unlink()
    for depth in range(1, reflections + 1):
        # The control, shared by all units, also continues rays that missed; their results are ignored.
        points[depth][points[depth - 1] < 0] = -1
    return tuple(points.reshape(reflections + 1, -1, 3))
