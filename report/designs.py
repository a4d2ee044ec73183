# SPDX-License-Identifier: MIT
"""Chapter on designs: error against run time and cells, for all engines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from raycaster.configuration import OPTIONS, Configuration, Rounding, configure
from raycaster.convert.take_home import TOP
from raycaster.report import hardware, plots
from raycaster.report.extent import Extent
from raycaster.report.hardware import Candidate, describe, frontier, predicted_cycles, unit_of
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import UNITS, Point
from raycaster.report.statistics import Spread
from raycaster.report.sweep import Sweep

WORST_SCENE = Path("scenes/mirror_room.toml")
"""Scene for the simulations: it fills the designs' rectangle tables, so no row of another scene takes longer."""

cells, time = attrgetter("cells"), attrgetter("pixel_ns")

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

    said: str = ""

    @property
    def best(self) -> list[Candidate]:
        """Designs on any of the frontiers, without duplicates."""
        return list(dict.fromkeys([*self.without_error, *self.by_time, *self.by_cells]))


def to_keep(found: Designs) -> list[dict[str, Any]]:
    """Return a row per design with the figures for the manual's table and plot, and the non-default options."""
    return [
        {
            "design": describe(one.config),
            "options": {
                name: value
                for name, option in OPTIONS.items()
                if (value := getattr(one.config, name)) != option.default
            },
            "luts": one.cells,
            "frame_cycles": one.frame_cycles,
            "frame_ms": one.frame_ms,
            "wrong_share": one.error,
            "found": one.is_found,
            "best": one in found.best,
        }
        for one in found.every
    ]  # fmt: skip


def of_kept(rows: Sequence[Mapping[str, Any]]) -> Designs:
    """Restore the designs from the rows of `to_keep`."""
    every, best = [], []
    for row in rows:
        one = Candidate(configure(**row["options"]), row["wrong_share"], estimated=row["luts"])
        if row["found"]:
            one = replace(one, counted={"cells": row["luts"]}, timing={"frame_cycles": row["frame_cycles"]})
        every.append(one)
        best += [one] if row["best"] else []
    seeds, others = _by_error(best)
    return Designs(every, frontier(seeds, "pixel_ns", "error"), frontier(seeds, "cells", "error"), others)


def _by_error(every: Sequence[Candidate]) -> tuple[list[Candidate], list[Candidate]]:
    """Separate the designs that round from the designs without error."""
    rounded = [one for one in every if one.config.facts.divides]
    return rounded, [one for one in every if not one.config.facts.divides]


def error_and_time(found: Designs) -> Figure:
    """Draw the first plot of the report, which the README shows too."""
    ends = [min(found.without_error, key=measure) for measure in (cells, time)]
    labelled = dict.fromkeys([*found.by_time, *ends])
    return plots.designs(found.every, "pixel_ns", "error", found.by_time, list(labelled))


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
        config: Point("cells", UNITS[config.engine], config)
        for config in dict.fromkeys(unit_of(one) for one in [*(one.config for one in seeds), base])
    }
    whole = _cells_point(base)
    found = sweep("cells of units", [whole, *units.values()])
    alone = {config: found[point]["cells"] for config, point in units.items()}
    seeds = hardware.with_estimates(seeds, found[whole], base, alone)
    # The page lists every design without error, so none of them stays an estimate.
    others = [*hardware.exact_designs(what.exact_units, what.screen), *hardware.beam_designs(what.screen)]
    exacts = _find([Candidate(config, 0.0) for config in others], sweep)
    culled = [
        Candidate(config, errors[config.fraction_bits, config.rounding] if config.facts.divides else 0.0)
        for config in hardware.culled_designs(what.design_fractions, what.screen)
        if config.engine in what.culled
    ]
    culled = _find(culled, sweep)
    while True:
        by_time, by_cells = (frontier(seeds, name, "error")[: what.frontier] for name in ("pixel_ns", "cells"))
        missing = [one for one in dict.fromkeys([*by_time, *by_cells]) if not one.is_found]
        if not missing:
            break
        now = dict(zip(missing, _find(missing, sweep), strict=True))
        seeds = [now.get(one, one) for one in seeds]
    off = [one.estimated / one.counted["cells"] - 1 for one in seeds if one.counted and one.estimated]
    said = (
        f"{len(off)} designs of the seed engine are on a frontier. Each of these, and each of the {len(exacts)} "
        f"designs of the other engines, was simulated with {WORST_SCENE.stem}, and its cells were counted. For the "
        f"other {len(seeds) - len(off)} designs, the cells of the shared part and of each unit are added up. "
        f"Compared with the counts, such estimates are off by {min(off):+.1%} to {max(off):+.1%}."
    )
    return Designs([*seeds, *exacts, *culled], by_time, by_cells, frontier(exacts, "pixel_ns", "cells"), said)


def _cells_point(config: Configuration) -> Point:
    return Point("cells", TOP, config)


def _time_point(config: Configuration) -> Point:
    return Point("time", str(WORST_SCENE), config)


def _find(candidates: Sequence[Candidate], sweep: Sweep) -> list[Candidate]:
    """Simulate the designs and count their cells."""
    counted = sweep("cells", [_cells_point(one.config) for one in candidates])
    timed = sweep("designs", [_time_point(one.config) for one in candidates])
    return [
        replace(one, counted=counted[_cells_point(one.config)], timing=timed[_time_point(one.config)])
        for one in candidates
    ]


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


def design_chapter(found: Designs, spreads: Mapping[tuple[int, Rounding], Spread]) -> Chapter:
    """Return the chapter; it takes the distributions of the share of wrong pixels, by fraction bits and rounding."""
    every, best = found.every, found.best
    rounded, exact = _by_error(every)
    fewest, fastest = (min(found.without_error, key=measure) for measure in (cells, time))
    by_cells = list(dict.fromkeys([*found.by_cells, fewest, fastest]))
    data = Data("designs", EVERY_COLUMNS, [_whole_row(one, one in best) for one in every])
    drawn = [
        Plot(name, caption, figure, data)
        for name, figure, caption in (
            ("work_precision", error_and_time(found),
             "Error against computing time per pixel, at the clock that the design needs."),
            ("cells_precision", plots.designs(every, "cells", "error", found.by_cells, by_cells),
             "Error against cells."),
            ("cells_time", plots.designs(every, "pixel_ns", "cells", found.without_error, exact),
             "Cells against time."),
        )
    ]  # fmt: skip
    rows = [_row(one, spreads) for one in dict.fromkeys([*exact, *best, *rounded]) if one.is_found]
    timed = [(one.config, one.timing) for one in every if one.timing]
    wrong = sum(timing["wrong"] for _, timing in timed)
    off = sum(timing["frame_cycles"] != predicted_cycles(config) for config, timing in timed if not config.culling)
    estimated = sum(not one.is_found for one in best)
    beaten = [_is_beaten(one, exact) for one in rounded]
    said = [
        found.said,
        f"{len(best)} designs are on a frontier, {estimated} of them only estimated. In simulation, {off} designs "
        f"took more or fewer cycles than predicted, and {wrong} pixels differ from the golden model.",
        f"Among the {len(rounded)} designs of the seed engine, {sum(beaten)} are neither smaller nor faster than some "
        "design without error.",
    ]
    alarms = [f"In simulations of the designs, {wrong} pixels differ from the golden model."] if wrong else []
    alarms += [f"{estimated} designs on a frontier were not simulated and counted."] if estimated else []
    exactest = min(found.by_cells, key=attrgetter("error"))
    summary = (
        f"No design that rounds is worth its error. Without error, {describe(fewest.config)} is the smallest design, "
        f"with {fewest.cells:,} LUT4 and {fewest.pixel_ns:.3g} ns per pixel, and {describe(fastest.config)} is the "
        f"fastest, with {fastest.cells:,} LUT4 and {fastest.pixel_ns:.3g} ns. The most accurate of the seed engine's "
        f"best designs, {describe(exactest.config)}, takes {exactest.cells:,} LUT4 and {exactest.pixel_ns:.3g} ns, and "
        f"{exactest.error:.3%} of its pixels are wrong."
        if all(beaten)
        else f"The smallest design without error, {describe(fewest.config)}, takes {fewest.cells:,} LUT4 and "
        f"{fewest.pixel_ns:.3g} ns per pixel."
    )
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
        Section("Cells", plots=drawn[1:], tables=[Table.of(Data("best", COLUMNS, rows))]),
    ]
    return Chapter(sections, alarms, [summary])


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
        "yes" if is_best else "no", _time_point(config).command, _cells_point(config).command,
    ]  # fmt: skip


def _is_beaten(one: Candidate, exact: Sequence[Candidate]) -> bool:
    return any(other.is_found and other.cells <= one.cells and other.pixel_ns <= one.pixel_ns for other in exact)
