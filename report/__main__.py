# SPDX-License-Identifier: MIT
"""`raycaster report`: error against run time and cells, and what happens in stiff and extreme scenes."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from raycaster.configuration import Configuration, configure
from raycaster.design import design_for
from raycaster.errors import UserError
from raycaster.fpga.area import with_units
from raycaster.golden.catalogue import Case, catalogue
from raycaster.golden.errors import DepthErrors, compare
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.jobs import add_job_options, executors
from raycaster.options import CommandParser
from raycaster.report import conclusions, hardware, plots
from raycaster.report.page import Section, write_csv, write_html, write_markdown
from raycaster.report.points import CASE, UNITS, CellsPoint, HitsPoint, PicturePoint, Point, TimePoint, View, command
from raycaster.report.sweep import Store, run
from raycaster.scene import load_scene
from raycaster.sim.simulator import SimulationError

SCENES = Path("scenes")
"""Of the clone that it runs in, so that the commands of its points say which file they mean."""

WORST_SCENE = SCENES / "mirror_room.toml"
"""With as many rectangles as the hardware has, so that no row takes longer; and the picture of the day."""

CASE_REFLECTIONS = 2
"""That the catalogue is looked at with."""

BOUNCES = 8
GROWING = ("facing_y_40", "facing_z", "box_20", "box_off_centre", "corner_reflector", "box_in_box")
"""Cases whose error is followed over all bounces."""

ROUNDINGS = ("truncate", "nearest")
INTRODUCTION = (
    "Pictures of the engines against the exact one, which is computed over the rationals; every figure is "
    "made anew by the command that made this page. Errors are of the golden model, which the hardware equals in every "
    "bit; run times are the hardware's own counters'."
)
_POINT_COLUMNS = (
    "scene", "F", "rounding", "reflections", "pixels", "wrong", "wrong, share", "PSNR, dB", "wrong first hits",
    "wrong reflections",
)  # fmt: skip
_DEPTH_COLUMNS = tuple(
    f"{what}, depth {depth}" for depth in range(3) for what in ("worst error", "mean error", "bound")
)


Results = Mapping[PicturePoint, Mapping[str, Any]]


@dataclass(frozen=True)
class Extent:
    """How much is swept."""

    fractions: Sequence[int]
    reflections: Sequence[int]
    design_fractions: Sequence[int]
    units: Sequence[int]
    exact_units: Sequence[int]
    cases: Sequence[Case]
    case_fractions: Sequence[int]
    case_screen: str
    probed_cases: Sequence[Case]
    probed: Sequence[Configuration]
    """Whose hit points are looked at in simulation."""

    screen: str
    """Of the designs."""

    frontier: int
    """Designs of the frontiers that are simulated, at most: those of all first, the fastest first."""

    culled: Sequence[str]
    """Engines of which each scene is simulated with culling and without."""


def extent(quick: bool) -> Extent:
    """Everything, or what takes less than three minutes."""
    cases = catalogue()
    if quick:
        probed = configure(screen="tiny", units=16, reflections=CASE_REFLECTIONS, divider_bits=3, allow_underrun=True)
        return Extent(
            (0, 2, 4), (1,), (0, 4), (16,), (4, 16), cases, (0,), "tiny", cases[::6], [probed], "tiny", 2, ["seed"]
        )
    probed_designs = [
        configure(reflections=CASE_REFLECTIONS, fraction_bits=f, rounding=r, divider_bits=3)
        for f, r in ((0, "truncate"), (0, "nearest"), (4, "nearest"))
    ]
    every = range(9)
    return Extent(
        every,
        (0, 1, 2),
        every,
        (20, 32),
        (4, 5, 8, 10, 16, 20, 32),
        cases,
        (0, 2, 4, 8),
        "vga",
        cases,
        probed_designs,
        "vga",
        24,
        ["seed", "exact"],
    )


@dataclass(frozen=True)
class Sweeper:
    """Finds points out, those that were stored before excepted."""

    store: Store
    make_executor: Callable[[], Executor]
    console: Console

    def __call__(self, what: str, points: Sequence[Point]) -> dict[Point, dict[str, Any]]:
        """As `raycaster.report.sweep.run`."""
        return run(what, points, self.store, self.make_executor, self.console)


def row_of(point: PicturePoint, result: Mapping[str, Any]) -> list:
    """A point for tables: the columns that all have, and those of each depth that there is."""
    flips = [depth["flips"] for depth in result["depths"]]
    row = [point.view.name, point.fraction_bits, point.rounding, point.reflections]
    row += [result["pixels"], result["wrong"], result["wrong_share"], result["psnr"], flips[0], sum(flips[1:])]
    for depth in range(3):
        has = depth < len(result["depths"])
        row += [result["depths"][depth][name] if has else None for name in ("worst", "mean", "bound")]
    return row


def write_report(directory: Path, what: Extent, sweep: Sweeper) -> Path:
    """Find everything out and write the pages.

    Returns:
        The page for a browser.

    Raises:
        UserError: there are no scenes here, or a tool is missing.
        SimulationError: the hardware departs from golden.
    """
    # All designs that are compared show the same scenes.
    paths = [path for path in sorted(SCENES.glob("*.toml")) if not any(load_scene(path).needs.values())]
    scenes = [View.of(str(path)) for path in paths]
    if not scenes:
        raise UserError(f"{SCENES}: has no scene files; run this in the project's directory")
    of_scenes = [
        PicturePoint(scene, f, rounding, reflections)
        for scene in scenes for f in what.fractions for rounding in ROUNDINGS for reflections in what.reflections
    ]  # fmt: skip
    of_cases = [
        PicturePoint(View.of(f"{CASE}{case.name}"), f, rounding, CASE_REFLECTIONS, what.case_screen)
        for case in what.cases for f in what.case_fractions for rounding in ROUNDINGS
    ]  # fmt: skip
    pictures = sweep("pictures", [*of_scenes, *of_cases])
    write_csv(
        (*_POINT_COLUMNS, *_DEPTH_COLUMNS, "command"),
        [[*row_of(point, result), command(point)] for point, result in pictures.items()],
        directory / "points.csv",
    )
    shown = {point: pictures[point] for point in of_scenes if point.reflections == 1}
    sections = [
        *_frontier_sections(directory, what, shown, sweep),
        _culling_section(directory, what, scenes, sweep),
        *_error_sections(directory, what, shown),
        *_catalogue_sections(directory, what, {point: pictures[point] for point in of_cases}, sweep),
    ]
    write_markdown(INTRODUCTION, sections, directory)
    return write_html(INTRODUCTION, sections, directory)


def _frontier_sections(directory: Path, what: Extent, results: Results, sweep: Sweeper) -> list[Section]:
    errors = {
        (f, rounding): float(
            np.mean([r["wrong_share"] for p, r in results.items() if (p.fraction_bits, p.rounding) == (f, rounding)])
        )
        for f in what.design_fractions
        for rounding in ROUNDINGS
    }
    engines = {
        "seed": hardware.seed_designs(what.design_fractions, what.units, what.screen),
        "exact": hardware.exact_designs(what.exact_units, what.screen),
    }
    checks = {
        "seed": hardware.checks(configure(units=max(what.units), screen=what.screen, culling=False)),
        "exact": hardware.checks(configure(engine="exact", screen=what.screen)),
    }
    alone = {
        config: CellsPoint(with_units(config, 1), UNITS[engine])
        for engine, configs in engines.items()
        for config in (*configs, *checks[engine])
    }
    wholes = [CellsPoint(check) for pair in checks.values() for check in pair]
    found = sweep("cells", [*wholes, *dict.fromkeys(alone.values())])
    cells = {config: found[point]["cells"] for config, point in alone.items()}
    candidates, said_of_cells = [], []
    for engine, configs in engines.items():
        first, other = checks[engine]
        shared = found[CellsPoint(first)]["cells"] - first.units * cells[first]
        candidates += [
            hardware.Candidate(
                config,
                # The exact engine's golden model is the exact one; that it is drawn is seen in simulation.
                0.0 if engine == "exact" else errors[config.fraction_bits, config.rounding],
                shared + config.units * cells[config],
                config.units * found[alone[config]]["multipliers"],
            )
            for config in configs
        ]
        foretold, whole = shared + other.units * cells[other], found[CellsPoint(other)]["cells"]
        said_of_cells.append(
            f"Cells of the {engine} engine are foretold as a shared part of {shared:,} LUT4 and so many times one unit "
            f"by itself. The shared part is that of {first.name}, which takes {found[CellsPoint(first)]['cells']:,}; "
            f"{other.name} takes {whole:,}, foretold {foretold:,} ({foretold / whole - 1:+.1%})."
        )
    best = hardware.frontier(candidates)
    # Also those of the seed engine that only designs of the other beat.
    of_seed = hardware.frontier([one for one in candidates if one.config.engine == "seed"])
    listed = [*best, *(one for one in of_seed if one not in best)]
    points = [TimePoint(View.of(str(WORST_SCENE)), one.config) for one in listed[: what.frontier]]
    timings = list(sweep("designs", points).values())
    plots.work_precision(candidates, best, of_seed, directory / "work_precision.png")
    columns = (
        "engine", "F", "rounding", "quotient bits a cycle", "units", "wrong, mean share", "LUT4, foretold",
        "multipliers", "cycles a group, foretold", "cycles a group: a pixel and unit", "cycles a row", "slack in a row",
        "frame, ms", "wrong against golden", "on the frontier of all", "command",
    )  # fmt: skip
    rows = []
    for place, one in enumerate(listed):
        config = one.config
        quotients = [config.fraction_bits, config.rounding, config.divider_bits]
        row = [config.engine, *(quotients if config.engine == "seed" else [None] * 3), config.units, one.error]
        row += [one.cells, one.multipliers, config.group_cycles]
        if place < len(timings):
            timing = timings[place]
            slack = config.screen_geometry.row_cycles - timing["row_cycles"]
            row += [timing["group_cycles"], timing["row_cycles"], slack]
            row += [hardware.frame_ms(config, timing["row_cycles"]), timing["wrong"]]
        else:
            row += [None] * 5
        rows.append([*row, "yes" if one in best else "no", command(TimePoint(View.of(str(WORST_SCENE)), config))])
    write_csv(columns, rows, directory / "frontier.csv")
    off = sum(t["group_cycles"] != one.config.group_cycles for one, t in zip(listed, timings, strict=False))
    sentences = [
        f"{len(timings)} of the {len(listed)} designs on the frontiers of all and of the seed engine were simulated "
        f"with {WORST_SCENE.stem}: {off} took other cycles than foretold, {sum(t['wrong'] for t in timings)} pixels "
        "were not golden's.",
        *said_of_cells,
    ]
    said = [
        *conclusions.of_the_frontier("all", best),
        *conclusions.of_the_frontier("the seed engine", of_seed),
        *conclusions.what_a_bit_costs({config: count for config, count in cells.items() if config.engine == "seed"}),
    ]
    return [
        Section(
            "Work and precision", "Each dot is a design that meets the row budget.", sentences, "work_precision.png"
        ),
        Section("What the numbers say", sentences=said),
        Section("The frontiers", columns=columns, rows=rows),
    ]


def _culling_section(directory: Path, what: Extent, scenes: Sequence[View], sweep: Sweeper) -> Section:
    """Cycles of a frame of every scene without culling and with it."""
    scenes = [scene for scene in scenes if scene.scene.reflections in what.reflections]
    points = {}
    for engine in what.culled:
        for scene in scenes:
            for culling in (False, True):
                options = {"engine": engine, "screen": what.screen, "culling": culling}
                design = design_for(Path(scene.source), options)
                points[engine, scene, culling] = TimePoint(scene, design.configuration)
    found = sweep("culling", list(points.values()))
    cycles = {key: found[point]["frame_cycles"] for key, point in points.items()}
    shares = {
        engine: {scene.name: cycles[engine, scene, True] / cycles[engine, scene, False] for scene in scenes}
        for engine in what.culled
    }
    plots.culling(shares, directory / "culling.png")
    columns = (
        "scene", "engine", "rectangles", "reflections", "frame cycles without", "frame cycles with", "share",
        "wrong against golden", "command",
    )  # fmt: skip
    rows = [
        [
            scene.name, engine, len(scene.scene.rect), points[engine, scene, True].config.reflections,
            cycles[engine, scene, False], cycles[engine, scene, True], shares[engine][scene.name],
            sum(found[points[engine, scene, culling]]["wrong"] for culling in (False, True)),
            command(points[engine, scene, True]),
        ]
        for engine in what.culled for scene in scenes
    ]  # fmt: skip
    write_csv(columns, rows, directory / "culling.csv")
    text = (
        "System cycles in which a frame is rendered, without culling and with it: what no ray of a group can hit is "
        "given up early. The worst case, which the row budget is for, stays."
    )
    return Section("What culling saves", text, plot="culling.png", columns=columns, rows=rows)


def _error_sections(directory: Path, what: Extent, results: Results) -> list[Section]:
    plots.error_by_fraction(results, directory / "error_by_fraction.png")
    day = View.of(str(WORST_SCENE))
    plots.picture_of_the_day(day, directory / "picture.png")
    sentences = [
        *conclusions.enough_fraction(results),
        *(sentence for f in what.fractions[:1] for sentence in conclusions.where_roundings_differ(results, f)),
    ]
    return [
        Section("The picture of the day", plot="picture.png"),
        Section("Which fraction is enough", "With one reflection.", sentences, "error_by_fraction.png"),
        Section(
            "Every scene", "Errors of hit points are in world units, over the rays that hit what the exact ray hits.",
            columns=(*_POINT_COLUMNS, *_DEPTH_COLUMNS), rows=[row_of(*pair) for pair in results.items()],
        ),
    ]  # fmt: skip


def _catalogue_sections(directory: Path, what: Extent, results: Results, sweep: Sweeper) -> list[Section]:
    probed = [HitsPoint(View.of(f"{CASE}{case.name}"), config) for config in what.probed for case in what.probed_cases]
    measured = sweep("catalogue", probed)
    strains = {case.name: case.strain for case in what.cases}
    rows, judged = [], []
    for point, result in results.items():
        name, depths = point.view.name, result["depths"]
        exceeded = sum(depth["exceeded"] for depth in depths)
        tightest = max(depth["tightest"] for depth in depths)
        flips = sum(depth["flips"] for depth in depths)
        judged.append((name, _arithmetic(point.fraction_bits, point.rounding), exceeded, tightest, flips))
        row = [name, strains[name], point.fraction_bits, point.rounding, result["wrong"], flips]
        row += [*(depth["worst"] for depth in depths), max(depth["bound"] for depth in depths), tightest]
        rows.append([*row, "holds" if exceeded == 0 else "EXCEEDED"])
    seen = [
        [
            point.view.name, point.config.name, result["different"], *(depth["worst"] for depth in result["depths"]),
            max(depth["bound"] for depth in result["depths"]), sum(depth["exceeded"] for depth in result["depths"]),
            command(point),
        ]
        for point, result in measured.items()
    ]  # fmt: skip
    worst = [f"worst, depth {depth}" for depth in range(CASE_REFLECTIONS + 1)]
    columns = "case", "strains", "F", "rounding", "wrong", "flips", *worst, "bound", "part of bound", "verdict"
    hardware_columns = "case", "design", "hit points not golden's", *worst, "bound", "over the bound", "command"
    write_csv(columns, rows, directory / "catalogue.csv")
    write_csv(hardware_columns, seen, directory / "catalogue_hardware.csv")
    _plot_catalogue(what, results, directory / "catalogue.png")
    plots.flips(_most_flips(results), directory / "flips.png")
    plots.growth({name: _growth(name) for name in GROWING}, directory / "growth.png")
    sentences = [
        *conclusions.of_the_catalogue(judged),
        f"The converted Verilog was simulated on {len(what.probed_cases)} cases and {len(what.probed)} designs: "
        f"{sum(one['different'] for one in measured.values())} hit points are not golden's to the bit, "
        f"{sum(depth['exceeded'] for one in measured.values() for depth in one['depths'])} coordinates are over their "
        "bound.",
    ]
    text = (
        "Of the rays that hit what the exact ray hits, a hit point's coordinate u is off by at most d'[u] = d[u] + "
        "|D[u] / e| d[a] + q, where d are the errors of the ray's origin, a is the axis of the plane, and q one unit "
        "in the last place (truncated) or half of one (nearest). Rays that hit something else are counted as flips."
    )
    return [
        Section("Stiff and extreme cases", text, sentences, "catalogue.png"),
        Section("Where rays flip", "The cases with most wrong pixels, each with the exact picture.", plot="flips.png"),
        Section("How errors grow", f"Over {BOUNCES} bounces of the golden model, F = 0, truncated.", plot="growth.png"),
        Section("Every case", columns=columns, rows=rows),
        Section("Every case in hardware", columns=hardware_columns, rows=seen),
    ]


def _arithmetic(fraction_bits: int, rounding: str) -> str:
    return f"F = {fraction_bits}, {rounding}"


def _most_flips(results: Results) -> list[PicturePoint]:
    """Of the cases with most wrong pixels each the worst point."""
    worst: dict[str, PicturePoint] = {}
    for point in sorted(results, key=lambda point: -results[point]["wrong"]):
        worst.setdefault(point.view.name, point)
    return list(worst.values())[: plots.FLIPPED]


def _plot_catalogue(what: Extent, results: Results, path: Path) -> None:
    """The first of the catalogue's fraction bits, for both roundings."""
    names = [case.name for case in what.cases]
    tightest, flips = {}, {}
    for rounding in ROUNDINGS:
        label = _arithmetic(what.case_fractions[0], rounding)
        of = {
            point.view.name: result
            for point, result in results.items()
            if _arithmetic(point.fraction_bits, point.rounding) == label
        }
        tightest[label] = [max(depth["tightest"] for depth in of[name]["depths"]) for name in names]
        flips[label] = [100 * sum(d["flips"] for d in of[name]["depths"]) / of[name]["pixels"] for name in names]
    plots.catalogue_verdict(names, tightest, flips, path)


def _growth(name: str) -> tuple[DepthErrors, ...]:
    scene = View.of(f"{CASE}{name}").scene
    slopes = primary_slopes(configure(screen="tiny", allow_underrun=True).screen_geometry).reshape(-1, 3)
    errors = compare(
        Rectangles.of_scene(scene), scene.camera.position, scene.background, slopes, BOUNCES, 0, "truncate"
    )
    return errors.depths


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("report", __doc__, "--quick")
    parser.add_argument("--output", type=Path, default=Path("build/report"), help="(default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="fewer points, in less than three minutes")
    add_job_options(parser, os.cpu_count() or 1)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """The command."""
    arguments = command_parser().parse_args(argv)
    console = Console()
    arguments.output.mkdir(parents=True, exist_ok=True)
    try:
        with executors(arguments.scheduler, arguments.jobs) as make_executor:
            sweeper = Sweeper(Store(arguments.output / "points"), make_executor, console)
            page = write_report(arguments.output, extent(arguments.quick), sweeper)
    except SimulationError as error:
        console.print(f"[red]{error}")
        return 1
    console.print(f"{page}, with report.md, plots and CSV beside it", highlight=False)
    return 0
