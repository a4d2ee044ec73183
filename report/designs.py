# SPDX-License-Identifier: MIT
"""Chapter on designs: error against run time and cells, for all engines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from raycaster.configuration import OPTIONS, Rounding, configure
from raycaster.report import hardware, plots
from raycaster.report.extent import Extent
from raycaster.report.hardware import Candidate, cells, describe, error, predicted_cycles, time, unit_of
from raycaster.report.page import Plot, Section, Table, write_csv
from raycaster.report.points import UNITS, CellsPoint, TimePoint, View, command
from raycaster.report.statistics import Spread
from raycaster.report.sweep import Sweep

WORST_SCENE = Path("scenes/mirror_room.toml")
"""Scene for the simulations: it fills the designs' rectangle tables, so no row of another scene takes longer."""

Errors = Mapping[tuple[int, Rounding], float]


@dataclass(frozen=True)
class Designs:
    """All designs considered, and the best of them."""

    every: Sequence[Candidate]
    by_time: Sequence[Candidate]
    """Frontier of the seed engine's designs by time and error."""

    by_cells: Sequence[Candidate]
    """Frontier of the seed engine's designs by cells and error."""

    without_error: Sequence[Candidate]
    """Frontier of the designs without error by time and cells."""

    said: Sequence[str]

    @property
    def best(self) -> list[Candidate]:
        """Designs on any of the frontiers, without duplicates."""
        return list(dict.fromkeys([*self.without_error, *self.by_time, *self.by_cells]))


def to_keep(found: Designs) -> list[dict[str, Any]]:
    """Return a row per design with the figures for the manual's table and plot, and the non-default options."""
    defaults = OPTIONS
    best = found.best
    rows = []
    for one in found.every:
        values = {name: getattr(one.config, name) for name in OPTIONS}
        rows.append(
            {
                "design": describe(one.config),
                "options": {name: value for name, value in values.items() if value != defaults[name].default},
                "luts": one.cells,
                "frame_cycles": one.frame_cycles,
                "frame_ms": one.frame_ms,
                "wrong_share": one.error,
                "found": one.is_found,
                "best": one in best,
            }
        )
    return rows


def of_kept(rows: Sequence[Mapping[str, Any]]) -> Designs:
    """Restore the designs from the rows of `to_keep`."""
    every, best = [], []
    for row in rows:
        config = configure(**row["options"])
        if row["found"]:
            timing = {"frame_cycles": row["frame_cycles"]}
            one = Candidate(config, row["wrong_share"], counted={"cells": row["luts"]}, timing=timing)
        else:
            one = Candidate(config, row["wrong_share"], estimated=row["luts"])
        every.append(one)
        best += [one] if row["best"] else []
    seeds = [one for one in best if one.config.facts.divides]
    by_time, by_cells = (hardware.frontier(seeds, measure, error) for measure in (time, cells))
    return Designs(every, by_time, by_cells, [one for one in best if not one.config.facts.divides], [])


def error_and_time(found: Designs) -> Figure:
    """Draw the first plot of the report, which the README shows too."""
    ends = [min(found.without_error, key=measure) for measure in (cells, time)]
    labelled = dict.fromkeys([*found.by_time, *ends])
    return plots.designs(found.every, "pixel_ns", "error", [found.by_time], list(labelled))


def find_designs(what: Extent, errors: Errors, sweep: Sweep) -> Designs:
    """Estimate all designs; simulate and count the best ones until no estimate is left among them.

    Args:
        what: extent of the sweep.
        errors: mean share of wrong pixels, by fraction bits and rounding.
        sweep: computes points.
    """
    seeds = [
        Candidate(config, errors[config.fraction_bits, config.rounding])
        for config in hardware.seed_designs(what.design_fractions, what.units, what.screen)
    ]
    base = configure(units=max(what.units), screen=what.screen, culling=False)
    units = {
        config: CellsPoint(config, UNITS[config.engine])
        for config in dict.fromkeys(unit_of(one.config) for one in [*seeds, Candidate(base, 0)])
    }
    found = sweep("cells of units", [CellsPoint(base), *units.values()])
    alone = {config: found[point]["cells"] for config, point in units.items()}
    seeds = hardware.with_estimates(seeds, found[CellsPoint(base)], base, alone)
    # The page lists every design without error, so none of them stays an estimate.
    exacts = [
        Candidate(config, 0.0)
        for config in [
            *hardware.exact_designs(what.exact_units, what.screen),
            *hardware.beam_designs(what.screen),
        ]
    ]
    culled = [
        Candidate(config, errors[config.fraction_bits, config.rounding] if config.facts.divides else 0.0)
        for config in hardware.culled_designs(what.design_fractions, what.screen)
        if config.engine in what.culled
    ]
    exacts, culled = (_find(some, sweep) for some in (exacts, culled))
    while True:
        by_time, by_cells = (hardware.frontier(seeds, measure, error)[: what.frontier] for measure in (time, cells))
        missing = [one for one in dict.fromkeys([*by_time, *by_cells]) if not one.is_found]
        if not missing:
            break
        now = dict(zip(missing, _find(missing, sweep), strict=True))
        seeds = [now.get(one, one) for one in seeds]
    checked = [one for one in seeds if one.counted]
    off = [one.estimated / one.counted["cells"] - 1 for one in seeds if one.counted and one.estimated]
    said = [
        f"{len(checked)} designs of the seed engine are on a frontier. Each of these, and each of the {len(exacts)} "
        f"designs of the other engines, was simulated with {WORST_SCENE.stem}, and its cells were counted. For the "
        f"other {len(seeds) - len(checked)} designs, the cells of the shared part and of each unit are added up. "
        f"Compared with the counts, such estimates are off by {min(off):+.1%} to {max(off):+.1%}.",
    ]
    every = [*seeds, *exacts, *culled]
    return Designs(every, by_time, by_cells, hardware.frontier(exacts, time, cells), said)


def _find(candidates: Sequence[Candidate], sweep: Sweep) -> list[Candidate]:
    """Simulate the designs and count their cells."""
    counting = {one: CellsPoint(one.config) for one in candidates}
    counted = sweep("cells", list(dict.fromkeys(counting.values())))
    timing = {one: time_point(one) for one in candidates}
    timed = sweep("designs", list(dict.fromkeys(timing.values())))
    return [replace(one, counted=counted[counting[one]], timing=timed[timing[one]]) for one in candidates]


def time_point(one: Candidate) -> TimePoint:
    """Return the point that simulates the design."""
    return TimePoint(View.of(str(WORST_SCENE)), one.config)


COLUMNS = (
    "design", "wrong pixels: mean, %", "median, %", "maximum, %", "LUT4", "multipliers", "ns per pixel", "ms per frame",
    "clock", "simulation, s",
)  # fmt: skip
EVERY_COLUMNS = (
    "engine", "F", "rounding", "quotient bits per cycle", "units", "culling", "screen", "mean share of wrong pixels",
    "LUT4", "LUT4 estimated", "registers", "multipliers", "cycles per frame", "simulated and counted", "ns per pixel",
    "ms per frame", "clock MHz", "routed MHz", "simulation, s", "pixels unlike the model", "on a frontier",
    "timing command", "cells command",
)  # fmt: skip


def design_sections(
    found: Designs, spreads: Mapping[tuple[int, Rounding], Spread], directory: Path
) -> tuple[list[Section], list[str], list[str]]:
    """Write the plots and tables of the chapter, and return its sections, alarms and summary sentences.

    Args:
        found: all designs.
        spreads: distributions of the share of wrong pixels, by fraction bits and rounding.
        directory: directory for plots and tables.
    """
    every, best = found.every, found.best
    write_csv(EVERY_COLUMNS, [_whole_row(one, one in best) for one in every], directory / "designs.csv")
    rounded = [one for one in every if one.config.facts.divides]
    exact = [one for one in every if not one.config.facts.divides]
    fewest, fastest = (min(found.without_error, key=measure) for measure in (cells, time))
    by_cells = list(dict.fromkeys([*found.by_cells, fewest, fastest]))
    figures = (
        ("work_precision", error_and_time(found),
         "Error against computing time per pixel, at the clock that the design needs."),
        ("cells_precision", plots.designs(every, "cells", "error", [found.by_cells], by_cells), "Error against cells."),
        ("cells_time", plots.designs(every, "pixel_ns", "cells", [found.without_error], exact), "Cells against time."),
    )  # fmt: skip
    drawn = []
    for name, figure, caption in figures:
        plots.save(figure, directory / f"{name}.svg")
        drawn.append(Plot(name, caption, "designs"))
    rows = [_row(one, spreads) for one in dict.fromkeys([*exact, *best, *rounded]) if one.is_found]
    write_csv(COLUMNS, rows, directory / "best.csv")
    wrong = sum(one.timing["wrong"] for one in every if one.timing)
    estimated = [one for one in best if not one.is_found]
    off = sum(
        one.timing["frame_cycles"] != predicted_cycles(one.config)
        for one in every
        if one.timing and not one.config.culling
    )
    alarms = [f"In simulations of the designs, {wrong} pixels differ from the golden model."] if wrong else []
    alarms += [f"{len(estimated)} designs on a frontier were not simulated and counted."] if estimated else []
    said = [
        *found.said,
        f"{len(best)} designs are on a frontier, {len(estimated)} of them only estimated. In simulation, {off} designs "
        f"took more or fewer cycles than predicted, and {wrong} pixels differ from the golden model.",
        *_beaten(rounded, exact),
    ]
    exactest = min(found.by_cells, key=error)
    summary = [
        f"No design that rounds is worth its error. Without error, {describe(fewest.config)} is the smallest design, "
        f"with {fewest.cells:,} LUT4 and {fewest.pixel_ns:.3g} ns per pixel, and {describe(fastest.config)} is the "
        f"fastest, with {fastest.cells:,} LUT4 and {fastest.pixel_ns:.3g} ns. The most accurate of the seed engine's "
        f"best designs, {describe(exactest.config)}, takes {exactest.cells:,} LUT4 and {exactest.pixel_ns:.3g} ns, and "
        f"{exactest.error:.3%} of its pixels are wrong."
        if _all_beaten(rounded, exact)
        else f"The smallest design without error, {describe(fewest.config)}, takes {fewest.cells:,} LUT4 and "
        f"{fewest.pixel_ns:.3g} ns per pixel."
    ]
    text = (
        "Each mark is a design that meets its row budget, with one reflection. Filled marks were simulated with "
        f"{WORST_SCENE.stem} and had their cells counted; hollow marks are estimates. Times come from the hardware's "
        "own counter of busy cycles, at the clock that the design needs for its monitor; the table shows which designs "
        "were placed and routed for this clock. Lines connect designs on a frontier: no other design is better in one "
        "respect without being worse in the other. Labels: fraction bits and rounding (n nearest, t truncate) for the "
        "seed engine, units for the exact engine, rows of the picture for the beam engine, x2 with two pixels per "
        "clock. Small marks have culling, and their time is for this scene. There are no energy figures, because the "
        "tools have no power model of the chip."
    )
    sections = [
        Section("Error against run time", text, said, drawn[:1]),
        Section("Cells", plots=drawn[1:], tables=[Table("best", COLUMNS, rows)]),
    ]
    return sections, alarms, summary


def _row(one: Candidate, spreads: Mapping[tuple[int, Rounding], Spread]) -> list:
    config, counted, timing = one.config, one.counted or {}, one.timing or {}
    spread = spreads[config.fraction_bits, config.rounding] if config.facts.divides else Spread(0, 0, 0, 0)
    row = [describe(config), *(round(100 * share, 4) for share in (spread.mean, spread.median, spread.most))]
    row += [one.cells, counted["multipliers"], one.pixel_ns, one.frame_ms]
    return [*row, hardware.clock_words(config), timing["seconds"]]


def _whole_row(one: Candidate, is_best: bool) -> list:
    config, counted, timing = one.config, one.counted or {}, one.timing or {}
    quotients = [config.fraction_bits, config.rounding, config.divider_bits]
    screen = config.screen_geometry
    return [
        config.engine, *(quotients if config.facts.divides else [None] * 3), config.units, int(bool(config.culling)),
        f"{screen.columns}x{screen.rows}", one.error, counted.get("cells"), one.estimated, counted.get("registers"),
        counted.get("multipliers"), one.frame_cycles, "yes" if one.is_found else "no", one.pixel_ns, one.frame_ms,
        screen.clock_hz / 1e6, hardware.routed_clocks().get(config.name), timing.get("seconds"), timing.get("wrong"),
        "yes" if is_best else "no", command(time_point(one)), command(CellsPoint(config)),
    ]  # fmt: skip


def _is_beaten(one: Candidate, exact: Sequence[Candidate]) -> bool:
    return any(other.is_found and other.cells <= one.cells and other.pixel_ns <= one.pixel_ns for other in exact)


def _all_beaten(rounded: Sequence[Candidate], exact: Sequence[Candidate]) -> bool:
    return all(_is_beaten(one, exact) for one in rounded)


def _beaten(rounded: Sequence[Candidate], exact: Sequence[Candidate]) -> list[str]:
    count = sum(_is_beaten(one, exact) for one in rounded)
    return [
        f"Among the {len(rounded)} designs of the seed engine, {count} are neither smaller nor faster than some design "
        "without error."
    ]
