# SPDX-License-Identifier: MIT
"""The chapter of stability: stiff and extreme cases, on every engine, each error against its bound."""

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
"""What the seed engine's cases may need."""

SHARE = 12
"""Cases of one simulation."""

BOUNCES = 8
GROWING = ("facing_y_40", "facing_z", "box_20", "box_off_centre", "corner_reflector", "box_in_box")
"""Cases whose error is followed over all bounces."""

LABELLED = 6
"""Cases of the plot that have a label: the stiffest, and those with the greatest error."""

LEAST = 0.1
"""World units: smaller errors are drawn as this."""

HOLDS, EXCEEDED, EXACT, WRONG = "holds", "EXCEEDED", "as the model", "WRONG"
COLUMNS = (
    "case", "engine", "condition", "wrong pixels", "rays flipped", "worst error", "bound", "part of bound", "verdict",
)  # fmt: skip
SEEN_COLUMNS = "case", "design", "hit points not golden's", "worst error", "bound", "over the bound"

Results = Mapping[PicturePoint, Mapping[str, Any]]


def stability_sections(
    what: Extent, directory: Path, sweep: Sweep
) -> tuple[list[Section], list[str], str, dict[str, int]]:
    """The sections, alarms, what a reader should know in one sentence, and the figures to keep."""
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
        "Scenes that strain fixed point: grazed planes, corners, slits, points, mirrors face to face, turned cameras, "
        "patterns on the borders of their cells. The condition number of a case is how far its hits move for a ray "
        "that is off by one pixel, in world units: the greatest of all rays and reflections. The exact and the beam "
        "engine round nothing, so that they have no error in any case; the seed engine's camera cannot turn."
    )
    sections = [
        Section(
            "Stiff and extreme cases", text, said,
            [
                Plot("stiffness", f"Each case's condition, its worst error and its greatest bound, F = "
                     f"{what.case_fractions[0]}, truncated; an error of {LEAST:g} stands for none or less."),
                Plot("growth", f"From bounce to bounce over {BOUNCES} bounces of the golden model, F = 0, truncated."),
                Plot("flips", "The cases with most wrong pixels: the seed engine's picture, the exact one, and where "
                              "they "
                     "differ."),
            ],
            [Table("catalogue", COLUMNS, of_page)],
        ),
        Section(
            "The same hit points in the converted Verilog",
            f"Read out of the simulated ray units, of {len(what.probed_cases)} cases and {len(what.probed)} designs.",
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
    """Of the designs without rounding, every case that they can show."""
    points = []
    for config in what.shown:
        count = len(catalogue(config.looks))
        points += [CasesPoint(config, first, min(SHARE, count - first)) for first in range(0, count, SHARE)]
    return sweep("cases", points)


def _rows(pictures: Results, shown: Mapping[CasesPoint, Mapping], conditions: Mapping[str, float | None]) -> list[list]:
    """A row a case and engine, with the command last."""
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
    """What is said, what is alarming, and the summary."""
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
    engines = " and ".join(f"the {engine} engine {count}" for engine, count in by_engine.items())
    stiffest = max((name for name in conditions if conditions[name]), key=lambda name: conditions[name] or 0)
    alarms = [
        f"A bound is exceeded: {point.view.name}, F = {point.fraction_bits}, {point.rounding}. {command(point)}"
        for point in over
    ]
    if over_seen or different:
        alarms.append(
            f"In simulation {different} hit points are not golden's, {over_seen} coordinates over their bound."
        )
    if wrong:
        alarms.append(f"In simulation {wrong} pixels of the catalogue's cases are not golden's.")
    said = [
        f"The stiffest of {len(conditions)} cases is {stiffest}: for a pixel a hit moves by up to "
        f"{conditions[stiffest]:,.0f} world units.",
        f"{len(over)} of {len(pictures)} pictures of the seed engine, of {len(cases)} cases, have a coordinate over "
        f"its bound; the closest to it is {tightest.view.name} (F = {tightest.fraction_bits}, {tightest.rounding}), "
        f"at {part:.2%} of it.",
    ]
    for rounding in ROUNDINGS:
        most = max((p for p in pictures if p.rounding == rounding), key=lambda point: pictures[point]["wrong"])
        result = pictures[most]
        said.append(
            f"Most pixels are wrong in {most.view.name} with F = {most.fraction_bits}, rounding: {rounding}: "
            f"{result['wrong']:,} of {result['pixels']:,}."
        )
    if measured:
        said.append(
            f"The seed engine's converted Verilog: {different} hit points of {len(measured)} frames are not the "
            f"model's to the bit, {over_seen} coordinates are over their bound."
        )
    if shown:
        said.append(f"In simulation {engines} cases drew: {wrong} pixels are not those of exact arithmetic.")
    summary = (
        f"In {len(conditions)} stiff and extreme cases {len(over)} bounds are exceeded, the closest error is at "
        f"{part:.1%} of its bound, and the engines without rounding "
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
