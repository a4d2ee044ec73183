# SPDX-License-Identifier: MIT
"""Chapter on stability: stiff and extreme cases on every engine, with each error and its bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.configuration import configure
from raycaster.golden.catalogue import catalogue
from raycaster.golden.errors import DepthErrors, compare
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.report import plots
from raycaster.report.extent import CASE_REFLECTIONS, Extent
from raycaster.report.page import Plot, Section, Table, write_csv
from raycaster.report.points import CASE, CasesPoint, ConditionPoint, HitsPoint, PicturePoint, View, command
from raycaster.report.sweep import Sweep

ROUNDINGS = ("truncate", "nearest")
OF_SEED = ("materials", "patterns")
"""Looks that the seed engine's cases may need."""

SHARE = 12
"""Number of cases per simulation."""

BOUNCES = 8
GROWING = ("facing_y_40", "facing_z", "box_20", "box_off_centre", "corner_reflector", "box_in_box")
"""Cases whose error is computed over all bounces."""

LABELLED = 6
"""Number of labelled cases in the plot: half are the stiffest, half have the greatest error."""

LEAST = 0.1
"""Lower limit for drawing errors, in world units; smaller errors are drawn at this value."""

HOLDS, EXCEEDED, EXACT, WRONG = "holds", "EXCEEDED", "exact", "WRONG"
COLUMNS = (
    "case", "engine", "condition", "wrong pixels", "rays flipped", "worst error", "bound", "error / bound", "verdict",
)  # fmt: skip
SEEN_COLUMNS = "case", "design", "hit points unlike the model", "worst error", "bound", "over the bound"

Results = Mapping[PicturePoint, Mapping[str, Any]]


def stability_sections(
    what: Extent, directory: Path, sweep: Sweep
) -> tuple[list[Section], list[str], str, dict[str, int]]:
    """Write the plots and tables of the chapter, and return its sections, alarms, summary sentence and kept figures."""
    views = {case.name: View.of(f"{CASE}{case.name}") for case in what.cases}
    of_seed = [view for case in what.cases if not case.scene.lacks(OF_SEED) for view in [views[case.name]]]
    pictures = sweep(
        "catalogue",
        [
            PicturePoint(view, f, rounding, CASE_REFLECTIONS, what.case_screen)
            for view in of_seed for f in what.case_fractions for rounding in ROUNDINGS
        ],
    )  # fmt: skip
    asked = {name: ConditionPoint(view, CASE_REFLECTIONS, what.case_screen) for name, view in views.items()}
    found = sweep("conditions", list(asked.values()))
    conditions = {name: found[point]["worst"] for name, point in asked.items()}
    probed = [HitsPoint(View.of(f"{CASE}{case.name}"), config) for config in what.probed for case in what.probed_cases]
    measured = sweep("hit points", probed)
    shown = _shown(what, sweep)
    rows = _rows(pictures, shown, conditions)
    write_csv((*COLUMNS, "strains", "command"), _with_strains(what, rows), directory / "catalogue.csv")
    seen = [
        [
            point.view.name, point.config.name, result["different"],
            max(depth["worst"] for depth in result["depths"]), max(depth["bound"] for depth in result["depths"]),
            sum(depth["exceeded"] for depth in result["depths"]),
        ]
        for point, result in measured.items()
    ]  # fmt: skip
    write_csv(
        (*SEEN_COLUMNS, "command"),
        [[*row, command(point)] for row, point in zip(seen, measured, strict=True)],
        directory / "hit_points.csv",
    )
    said, alarms, summary = _judged(pictures, shown, measured, conditions)
    _plot(what, pictures, conditions, directory)
    at_first = {point: result for point, result in pictures.items() if point.fraction_bits == what.case_fractions[0]}
    of_page = [row[:-1] for row in _rows(at_first, shown, conditions)]
    text = (
        "These scenes strain fixed-point arithmetic: grazed planes, corners, slits, points, facing mirrors, turned "
        "cameras, and patterns hit on the borders of their cells. The condition number of a case is the distance, in "
        "world units, by which a hit moves if its ray is off by one pixel: the maximum over all rays and reflections. "
        "The exact and beam engines do not round, so they have no error in any case. The seed engine's camera cannot "
        "turn."
    )
    sections = [
        Section(
            "Stiff and extreme cases", text, said,
            [
                Plot("stiffness", f"Condition number, worst error and greatest bound of each case, with F = "
                     f"{what.case_fractions[0]}, truncated. Errors below {LEAST:g} are drawn at this value."),
                Plot("growth", f"Errors and bounds over {BOUNCES} bounces in the golden model, with F = 0, truncated."),
                Plot("flips", "The cases with the most wrong pixels: the seed engine's picture, the exact picture and "
                     "their difference."),
            ],
            [Table("catalogue", COLUMNS, of_page)],
        ),
        Section(
            "Hit points in the converted Verilog",
            f"Read from the simulated ray units, for {len(what.probed_cases)} cases and {len(what.probed)} designs.",
            tables=[Table("hit_points", SEEN_COLUMNS, seen)],
        ),
    ]  # fmt: skip
    kept = {
        "stiff_cases": len(what.probed_cases),
        "unlike_golden": sum(row[2] for row in seen),
        "over_bound": sum(row[-1] for row in seen),
    }
    return sections, alarms, summary, kept


def _shown(what: Extent, sweep: Sweep) -> dict[CasesPoint, dict[str, Any]]:
    """Simulate every case that the designs without rounding can show."""
    points = []
    for config in what.shown:
        count = len(catalogue(config.looks))
        points += [CasesPoint(config, first, min(SHARE, count - first)) for first in range(0, count, SHARE)]
    return sweep("cases", points)


def _rows(pictures: Results, shown: Mapping[CasesPoint, Mapping], conditions: Mapping[str, float | None]) -> list[list]:
    """Return a row per case and engine, with the command last."""
    rows = []
    for point, result in pictures.items():
        depths = result["depths"]
        row = [point.view.name, f"seed F = {point.fraction_bits} {point.rounding}", conditions[point.view.name]]
        row += [result["wrong"], sum(depth["flips"] for depth in depths), max(depth["worst"] for depth in depths)]
        row += [max(depth[name] for depth in depths) for name in ("bound", "tightest")]
        rows.append([*row, EXCEEDED if any(depth["exceeded"] for depth in depths) else HOLDS, command(point)])
    for point, cases in shown.items():
        for name, one in cases.items():
            verdict = WRONG if one["wrong"] else EXACT
            rows.append(
                [name, point.config.engine, conditions[name], one["wrong"], 0, 0.0, 0.0, None, verdict, command(point)]
            )
    return rows


def _with_strains(what: Extent, rows: Sequence[Sequence]) -> list[list]:
    strains = {case.name: case.strain for case in what.cases}
    return [[*row[:-1], strains[row[0]], row[-1]] for row in rows]


def _judged(
    pictures: Results,
    shown: Mapping[CasesPoint, Mapping],
    measured: Mapping[HitsPoint, Mapping],
    conditions: Mapping[str, float | None],
) -> tuple[list[str], list[str], str]:
    """Return the sentences, the alarms and the summary."""
    cases = {point.view.name for point in pictures}
    over = [point for point, result in pictures.items() if any(depth["exceeded"] for depth in result["depths"])]
    tightest = max(pictures, key=lambda point: max(depth["tightest"] for depth in pictures[point]["depths"]))
    part = max(depth["tightest"] for depth in pictures[tightest]["depths"])
    different = sum(one["different"] for one in measured.values())
    over_seen = sum(depth["exceeded"] for one in measured.values() for depth in one["depths"])
    wrong = sum(case["wrong"] for one in shown.values() for case in one.values())
    by_engine: dict[str, int] = {}
    for point, one in shown.items():
        by_engine[point.config.engine] = by_engine.get(point.config.engine, 0) + len(one)
    engines = ", ".join(f"{engine} engine {count}" for engine, count in by_engine.items())
    stiffest = max((name for name in conditions if conditions[name]), key=lambda name: conditions[name] or 0)
    alarms = [
        f"A bound is exceeded: {point.view.name}, F = {point.fraction_bits}, {point.rounding}. {command(point)}"
        for point in over
    ]
    if over_seen or different:
        alarms.append(
            f"In simulation, {different} hit points differ from the golden model, and {over_seen} coordinates exceed "
            "their bound."
        )
    if wrong:
        alarms.append(f"In simulation, {wrong} pixels of the catalogue's cases differ from the golden model.")
    said = [
        f"The stiffest of {len(conditions)} cases is {stiffest}: hits move by up to {conditions[stiffest]:,.0f} world "
        "units per pixel of error in the ray.",
        f"{len(over)} of the seed engine's {len(pictures)} pictures, for {len(cases)} cases, have a coordinate over "
        f"its bound. The closest to its bound is in {tightest.view.name} (F = {tightest.fraction_bits}, "
        f"{tightest.rounding}), with {part:.2%} of it.",
    ]
    for rounding in ROUNDINGS:
        most = max((p for p in pictures if p.rounding == rounding), key=lambda point: pictures[point]["wrong"])
        result = pictures[most]
        said.append(
            f"The most wrong pixels are in {most.view.name} with F = {most.fraction_bits} (rounding: {rounding}): "
            f"{result['wrong']:,} of {result['pixels']:,}."
        )
    if measured:
        said.append(
            f"In the seed engine's converted Verilog, {different} hit points of {len(measured)} frames differ from "
            f"the golden model, and {over_seen} coordinates exceed their bound."
        )
    if shown:
        said.append(f"Cases drawn in simulation: {engines}; {wrong} pixels differ from exact arithmetic.")
    summary = (
        f"In {len(conditions)} stiff and extreme cases, {len(over)} bounds are exceeded, errors reach at most "
        f"{part:.1%} of their bound, and the engines without rounding "
        + (f"have {wrong} wrong pixels in simulation." if shown else "were not simulated here.")
    )
    return said, alarms, summary


def _plot(what: Extent, pictures: Results, conditions: Mapping[str, float | None], directory: Path) -> None:
    first = what.case_fractions[0]
    stiff = {}
    for point, result in pictures.items():
        condition = conditions[point.view.name]
        if (point.fraction_bits, point.rounding) == (first, "truncate") and condition:
            worst, bound = (max(depth[name] for depth in result["depths"]) for name in ("worst", "bound"))
            stiff[point.view.name] = condition, max(worst, LEAST), max(bound, LEAST)
    labelled = [name for place in (0, 1) for name in sorted(stiff, key=lambda one: -stiff[one][place])[: LABELLED // 2]]
    plots.save(plots.stiffness(stiff, list(dict.fromkeys(labelled))), directory / "stiffness.svg")
    write_csv(
        ("case", "condition", "worst error", "bound"),
        [[name, *values] for name, values in stiff.items()],
        directory / "stiffness.csv",
    )
    by_case: dict[str, PicturePoint] = {}
    for point in sorted(pictures, key=lambda point: -pictures[point]["wrong"]):
        by_case.setdefault(point.view.name, point)
    flipped = list(by_case.values())[: plots.FLIPPED]
    plots.save(plots.flips(flipped), directory / "flips.svg")
    write_csv(
        ("case", "F", "rounding", "wrong", "command"),
        [[one.view.name, one.fraction_bits, one.rounding, pictures[one]["wrong"], command(one)] for one in flipped],
        directory / "flips.csv",
    )
    grown = {name: _growth(name) for name in GROWING}
    plots.save(plots.growth(grown), directory / "growth.svg")
    write_csv(
        ("case", "bounces", "mean", "worst", "bound"),
        [
            [name, depth, one.mean, one.worst, one.bound]
            for name, depths in grown.items()
            for depth, one in enumerate(depths)
        ],
        directory / "growth.csv",
    )


def _growth(name: str) -> tuple[DepthErrors, ...]:
    scene = View.of(f"{CASE}{name}").scene
    slopes = primary_slopes(configure(screen="tiny", allow_underrun=True).screen_geometry).reshape(-1, 3)
    return compare(Rectangles.of_scene(scene), scene.camera.position, slopes, BOUNCES, 0, "truncate")
