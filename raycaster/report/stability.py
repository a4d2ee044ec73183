# SPDX-License-Identifier: MIT
"""Chapter on stability: stiff and extreme cases on every engine, with each error and its bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from raycaster.report import plots
from raycaster.report.errors import ROUNDINGS
from raycaster.report.extent import CASE_REFLECTIONS, Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import CASE, Point, Sweep, name_of, picture

Results = Mapping[Point, Mapping[str, Any]]

OF_SEED = ("materials", "patterns")
"""Looks that the seed engine's cases may need."""

FLIPPED, LABELLED = 12, 6
"""Number of cases whose pictures are shown; of labelled cases, half of them stiff and half with a great error."""

LEAST = 0.1
"""Lower limit for drawing errors, in world units; smaller errors are drawn at this value."""

COLUMNS = (
    "case", "F", "rounding", "condition", "wrong pixels", "rays flipped", "worst error", "bound", "error / bound",
    "verdict",
)  # fmt: skip


def stability_chapter(what: Extent, sweep: Sweep) -> Chapter:
    """Return the chapter."""
    found = sweep(
        "catalogue",
        [
            picture(f"{CASE}{case.name}", f, rounding, CASE_REFLECTIONS, what.case_screen)
            for case in what.cases if not case.scene.lacks(OF_SEED)
            for f in what.case_fractions for rounding in ROUNDINGS
        ],
    )  # fmt: skip
    pictures = {point: {**result, **_extremes(result["depths"])} for point, result in found.items()}
    conditions = {name_of(one.what): of["condition"] for one, of in found.items()}
    said, alarms, summary = _judged(pictures, conditions)
    strains, rows = {case.name: case.strain for case in what.cases}, []
    for point, one in pictures.items():
        counts = [one[key] for key in ("wrong", "flips", "worst", "bound", "tightest")]
        name, verdict = name_of(point.what), "EXCEEDED" if one["exceeded"] else "holds"
        row = [name, point.config.fraction_bits, point.config.rounding, conditions[name], *counts, verdict]
        rows.append([*row, strains[name], point.command])
    first = what.case_fractions[0]
    of_page = [row[: len(COLUMNS)] for row in rows if row[1] == first]
    text = (
        "These scenes strain fixed-point arithmetic: grazed planes, corners, slits, points, facing mirrors, and "
        "patterns hit on the borders of their cells. The relative condition number of a hit is the "
        "relative change of the hit point per relative change of the slope, for small changes: one over the cosine of "
        "the angle of incidence, in mirrors too; the condition of a case is the maximum over all hits. Only the seed "
        "engine rounds, so only its cases are shown."
    )
    drawn = [_stiffness(pictures, conditions, first), _flips(pictures)]
    table = Table(Data("catalogue", (*COLUMNS, "strains", "command"), rows), COLUMNS, of_page)
    section = Section("Stiff and extreme cases", text, said, drawn, [table])
    return Chapter([section], alarms, [summary])


def _extremes(depths: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Summarise the errors of all depths."""
    extremes = {name: max(depth[name] for depth in depths) for name in ("worst", "bound", "tightest")}
    return extremes | {name: sum(depth[name] for depth in depths) for name in ("flips", "exceeded")}


def _judged(pictures: Results, conditions: Mapping[str, float | None]) -> tuple[list[str], list[str], str]:
    """Return the sentences, the alarms and the summary."""

    def words(point: Point) -> str:
        return f"{name_of(point.what)}, F = {point.config.fraction_bits}, {point.config.rounding}"

    over = [point for point, result in pictures.items() if result["exceeded"]]
    tightest, most = (max(pictures, key=lambda point: pictures[point][key]) for key in ("tightest", "wrong"))
    part = pictures[tightest]["tightest"]
    stiffest = max(conditions, key=lambda name: conditions[name] or 0)
    alarms = [f"A bound is exceeded: {words(one)}. {one.command}" for one in over]
    said = [
        f"The stiffest of {len(conditions)} cases is {stiffest}: a hit moves by up to {conditions[stiffest]:,.0f} "
        "times the relative error of its ray.",
        f"{len(over)} of the seed engine's {len(pictures)} pictures of these cases have a coordinate over its bound. "
        f"The closest to its bound ({words(tightest)}) has {part:.2%} of it. The most wrong pixels ({words(most)}) are "
        f"{pictures[most]['wrong']:,} of {pictures[most]['pixels']:,}.",
    ]
    summary = (
        f"In {len(conditions)} stiff and extreme cases, {len(over)} bounds are exceeded, and errors reach at most "
        f"{part:.1%} of their bound."
    )
    return said, alarms, summary


def _stiffness(pictures: Results, conditions: Mapping[str, float | None], first: int) -> Plot:
    stiff = {}
    for point, one in pictures.items():
        name = name_of(point.what)
        if (point.config.fraction_bits, point.config.rounding) == (first, "truncate") and conditions[name]:
            stiff[name] = conditions[name], max(one["worst"], LEAST), max(one["bound"], LEAST)
    labelled = [name for place in (0, 1) for name in sorted(stiff, key=lambda one: -stiff[one][place])[: LABELLED // 2]]
    caption = (
        f"Condition number, worst error and greatest bound of each case, with F = {first}, truncated. Errors below "
        f"{LEAST:g} are drawn at this value."
    )
    rows = [[name, *values] for name, values in stiff.items()]
    data = Data("stiffness", ("case", "condition", "worst error", "bound"), rows)
    return Plot("stiffness", caption, plots.stiffness(stiff, list(dict.fromkeys(labelled))), data)


def _flips(pictures: Results) -> Plot:
    worst: dict[str, Point] = {}
    for point in sorted(pictures, key=lambda point: -pictures[point]["wrong"]):
        worst.setdefault(point.what, point)
    shown = list(worst.values())[:FLIPPED]
    data = Data(
        "flips", ("case", "wrong", "command"), [[name_of(p.what), pictures[p]["wrong"], p.command] for p in shown]
    )
    return Plot("flips", "The cases with the most wrong pixels, in pink.", plots.wrong_by_scene(shown), data)
