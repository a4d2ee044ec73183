# SPDX-License-Identifier: MIT
"""`raycaster verify coverage`: find lines and branches of each engine's Verilog that frames and benches never reach.

Verilator counts them while a design draws every packaged scene that it can draw, and hard cases with a light, and runs
two benches of the whole design. The holes are listed, to be read: each is code that cannot be reached, for a reason
that is known, or one that needs a scene or a test.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.convert.digest import verilog_digest
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser, add_build_option
from raycaster.output import Console, Table, emptied
from raycaster.runs.jobs import Kept, add_fresh_option, add_job_options, executors, run_jobs
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.scene import find_scene, load_scene, packaged_scenes
from raycaster.sim.job import Job
from raycaster.sim.simulator import (
    MODULE_BENCH,
    VERILATOR_FLAGS,
    Model,
    SimulationError,
    announced,
    build_model,
    run_bench,
)
from raycaster.verif.catalogue import catalogue
from raycaster.verif.soak.soak import bench_digest

# One design per engine that every bench can run, at full size, so that the counters run through their range. The seed
# engine has 16 units, not 32, and so a budget of 159 cycles per group. All 12 rectangles with two reflections take 202
# cycles; with culling, more than 159 remain only where the underrun bench needs them. Likewise for the exact engine
# with eight units: 112 cycles with shadow passes, and a budget of 79.
DESIGNS = {
    config.engine: config
    for config in (
        configure(units=16, reflections=2, divider_bits=2, allow_underrun=True),
        configure(engine="exact", units=8, reflections=2, culling=True, light=True, allow_underrun=True),
        configure(engine="span", scale=1, reflections=2),
    )
}

LIT_RECTANGLES = 8
FLAGS = (*VERILATOR_FLAGS, "--coverage-line")

READ = "the benches of the bus read this register"
REASONS: Mapping[str, str] = {
    "avalon_interface: elsif: else if (bus_address == engine_address) begin": READ,
    "avalon_interface: elsif: else if (bus_address == size_address) begin": READ,
    "avalon_interface: elsif: else if (bus_address == version_address) begin": READ,
    "camera_mem: if: if (select_light) begin": "this design has no light",
    "ray_caster_renderer: else: else if (progress_group_cycles != 65535) begin": "a row is abandoned after 3200 cycles",
    "ray_caster_renderer: else: if (progress_row_cycles != 65535) begin": "a row is abandoned after 3200 cycles",
    "ray_sequencer: else: else if (state == BLEND) begin": "in DONE the reset comes at once",
    "ray_sequencer: else: if (enable) begin": "the clock is stopped while the ray caster is not enabled",
    "ray_sequencer: if: if (early_out) begin": "a rectangle takes one cycle and has no early out",
    "rect_sequencer: else: if (start_ray || early_out || (cycle == 0)) begin": "a rectangle takes one cycle",
    "rect_sequencer: else: if (take || !fetched) begin": "a rectangle takes one cycle, so one is taken in each",
    "video_generator: else: if (pixel_end) begin": "a pixel takes one clock",
}
"""Reasons why holes cannot be reached, by hole."""

RECORD = re.compile(r"C '(?P<fields>.*)' (?P<count>\d+)")


@dataclass(frozen=True)
class Run:
    """A bench on a model with counters, with a scene, reflections that override the scene's, or hard cases to draw."""

    model: Model
    build: Path
    bench: str
    scene: Path | None = None
    reflections: int | None = None
    cases: tuple[int, ...] = ()

    @property
    def directory(self) -> Path:
        """Directory of the output, whose name depends on everything that decides the counts."""
        scene = self.scene.read_text() if self.scene else ""
        key = bench_digest(f"raycaster.{self.bench}", self.model, scene, self.reflections, self.cases)
        return (self.build / "coverage" / f"{self.bench}-{self.scene.stem if self.scene else ''}-{key}").resolve()

    def place(self) -> Path:
        """Return the file that keeps the counts."""
        return self.directory / "kept.pickle"

    def run(self) -> tuple[Counter[str], str]:
        """Return the counts, and a message if the bench failed."""
        emptied(self.directory)
        scene, counts = str(self.scene.resolve()) if self.scene else "", self.directory / "coverage.dat"
        job = Job(
            self.model.configuration, scene=scene, output=str(self.directory), reflections=self.reflections,
            seeds=self.cases, stiff=True,
        )  # fmt: skip
        plusargs = [f"+verilator+coverage+file+{counts}"]
        try:
            run_bench(self.model, f"raycaster.{self.bench}", job, self.directory, plusargs=plusargs)
        except SimulationError as error:
            return Counter(), f"{self.directory.name}: {error}"
        return read_counts(counts), ""


def runs_of(design: Configuration, model: Model, build: Path) -> list[Run]:
    """List the benches, the longest first, and a frame of each scene that the design can draw."""
    # With culling the floor meets the row budget even with two reflections.
    benches = [
        Run(model, build, "verif.benches.register_bench", find_scene("floor"), 2),
        Run(model, build, "verif.benches.underrun_bench"),
    ]
    # More rectangles would not meet the row budget.
    scenes_of_cases = enumerate(case.scene for case in catalogue(design.features))
    lit = tuple(number for number, scene in scenes_of_cases if scene.light and len(scene.rect) <= LIT_RECTANGLES)
    benches += [Run(model, build, "verif.soak.bench", cases=lit)] if lit else []
    shown = {path: load_scene(path) for path in packaged_scenes().values()}
    scenes = [
        path for path, scene in shown.items()
        if not scene.lacks(design.features) and len(scene.rect) <= design.rectangles
    ]  # fmt: skip
    return [*benches, *(Run(model, build, "sim.frame_bench", scene) for scene in scenes)]


def read_counts(path: Path) -> Counter[str]:
    """Count how often each line and branch was reached, including never, by module, way of reaching it, and its text.

    Args:
        path: Verilator's coverage.dat; the Verilog files that it names must exist.
    """
    counts: Counter[str] = Counter()
    sources: dict[str, list[str]] = {}
    for match in map(RECORD.fullmatch, path.read_text().splitlines()):
        # Each field is \1 name \2 value. Verilator adds a suffix to the names of modules with parameters.
        fields = dict(part.split("\2", 1) for part in match["fields"].split("\1") if part) if match else {}
        module = fields.get("page", "").partition("/")[2].partition("__")[0]
        if match and module not in MODULE_BENCH.modules:
            lines = sources.setdefault(fields["f"], Path(fields["f"]).read_text().splitlines())
            counts[f"{module}: {fields['o']}: {lines[int(fields['l']) - 1].strip()}"] += int(match["count"])
    return counts


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify coverage", __doc__, "--engine span")
    parser.add_argument(
        "--engine", choices=list(DESIGNS), action="append", metavar="NAME", help=f"{', '.join(DESIGNS)} (default: all)"
    )
    add_job_options(parser)
    add_fresh_option(parser)
    add_build_option(parser)
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that is covered."""
    return verilog_digest(*(DESIGNS[engine] for engine in arguments.engine or DESIGNS))


def main(argv: list[str] | None = None) -> int:
    """Run the command; it fails if a bench fails."""
    arguments = command_parser().parse_args(argv)
    console = Console()
    runs: list[Run] = []
    for engine in arguments.engine or DESIGNS:
        with announced(console, f"building {DESIGNS[engine].name}", DESIGNS[engine].facts):
            model = build_model(DESIGNS[engine], build=arguments.build, flags=FLAGS)
        runs += runs_of(DESIGNS[engine], model, arguments.build)
    kept = Kept(Run.place, arguments.fresh, complete=lambda found: not found[1])
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        found = run_jobs("benches", Run.run, runs, make_executor, console, kept=kept)
    table, figures = Table("engine", "reached", "of", "share", title="Lines and branches of the Verilog"), {}
    for engine in arguments.engine or DESIGNS:
        counts: Counter[str] = Counter()
        for run, (of_run, _) in zip(runs, found, strict=True):
            if run.model.configuration.engine == engine:
                counts.update(of_run)
        holes = {hole: REASONS.get(hole, "") for hole in sorted(counts) if not counts[hole]}
        reached = len(counts) - len(holes)
        table.add_row(engine, reached, len(counts), f"{reached / max(len(counts), 1):.1%}")
        figures[engine] = {"reached": reached, "all": len(counts), "holes": holes}
        for hole, reason in holes.items():
            console.print(f"{engine}: {hole}{f'  ({reason})' if reason else ''}", soft_wrap=True)
    console.print(table)
    keep(arguments, figures, verilog, "a camera that turns, materials and patterns")
    failures = [failure for _, failure in found if failure]
    for failure in failures:
        console.print(failure, style="red", soft_wrap=True)
    return 1 if failures else 0
