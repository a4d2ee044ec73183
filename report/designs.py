# SPDX-License-Identifier: MIT
"""Chapter on designs: work-precision diagrams, error against run time, cells and simulation time, for all engines."""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from matplotlib.figure import Figure

from raycaster.configuration import OPTIONS, Configuration, Rounding, configure
from raycaster.convert.take_home import TOP
from raycaster.fpga.area import with_units
from raycaster.report import plots
from raycaster.report.hardware import Candidate, frontier
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import UNITS, Point, predicted_cycles
from raycaster.report.statistics import Spread
from raycaster.report.sweep import Sweep

WORST_SCENE = "scenes/mirror_room.toml"
"""Scene for the simulations: it fills the designs' rectangle tables, so no row of another scene takes longer."""

RUNS = 5
"""Number of simulations by which a design's simulation time is measured."""

COSTS = "frame_ms", "work", "cells"
"""Attributes of a design that are its cost; on each frontier, one of them is set against the error."""

Spreads = Mapping[tuple[int, Rounding], Spread]
"""Distributions of the share of wrong pixels, by fraction bits and rounding."""


@dataclass(frozen=True)
class Designs:
    """All designs considered."""

    every: Sequence[Candidate]

    @property
    def rounded(self) -> list[Candidate]:
        """Designs that round, and have errors."""
        return [one for one in self.every if one.config.facts.divides]

    @property
    def exact(self) -> list[Candidate]:
        """Designs without error."""
        return [one for one in self.every if not one.config.facts.divides]

    def by(self, cost: str) -> list[Candidate]:
        """Return the frontier of the designs that round, by one of `COSTS` and error, ordered by cost."""
        return frontier(self.rounded, cost, "error")

    @property
    def best(self) -> list[Candidate]:
        """Designs on any of the frontiers, without duplicates; those without error first."""
        of_rounded = itertools.chain.from_iterable(map(self.by, COSTS))
        return list(dict.fromkeys([*frontier(self.exact, "frame_ms", "cells"), *of_rounded]))


def to_keep(found: Designs) -> list[dict[str, Any]]:
    """Return a row per design with the figures for the manual's table and plot, and the non-default options."""
    best = found.best
    return [
        {
            "design": one.title,
            "options": {k: v for k, option in OPTIONS.items() if (v := getattr(one.config, k)) != option.default},
            "luts": one.cells, "frame_cycles": one.frame_cycles,
            "frame_ms": one.required_ms,
            "wrong_share": one.error, "found": one.is_found, "best": one in best,
        }
        for one in found.every
    ]  # fmt: skip


def of_kept(rows: Sequence[Mapping[str, Any]]) -> Designs:
    """Restore the designs from the rows of `to_keep`, except any with culling, whose time depends on the scene."""
    every = []
    for row in rows:
        one = Candidate(configure(**row["options"]), row["wrong_share"], row["luts"])
        if row["found"]:
            one = replace(one, counted={"cells": row["luts"]}, timing={"frame_cycles": row["frame_cycles"]})
        every += [] if one.config.culling else [one]
    return Designs(every)


def error_and_time(found: Designs) -> Figure:
    """Draw the first plot of the report, which the README shows too."""
    return plots.work_precision(found.rounded, found.exact, "frame_ms", found.by("frame_ms"))


def find_designs(
    rounded: Sequence[Configuration], exact: Sequence[Configuration], spreads: Spreads, sweep: Sweep
) -> Designs:
    """Estimate the designs that round; simulate and count the best until no estimate is left on a frontier.

    Args:
        rounded: designs of the seed engine.
        exact: designs without error; each is simulated and counted.
        spreads: distributions whose means are the designs' errors.
        sweep: computes points.
    """
    base = max(rounded, key=lambda config: (config.units, -config.fraction_bits, -config.divider_bits))
    units = {one: Point("cells", UNITS["seed"], with_units(one, 1)) for one in rounded}
    counted = sweep("cells of units", [_cells_point(base), *units.values()])
    alone = {config: counted[point]["cells"] for config, point in units.items()}
    shared = counted[_cells_point(base)]["cells"] - base.units * alone[base]
    seeds = [
        Candidate(one, spreads[one.fraction_bits, one.rounding].mean, shared + one.units * alone[one])
        for one in rounded
    ]
    exacts = _find([Candidate(one, 0.0) for one in exact], sweep)
    found = Designs([*seeds, *exacts])
    while missing := [one for one in found.best if not one.is_found]:
        now = dict(zip(missing, _find(missing, sweep), strict=True))
        seeds = [now.get(one, one) for one in seeds]
        found = Designs([*seeds, *exacts])
    return found


def _cells_point(config: Configuration) -> Point:
    return Point("cells", TOP, config)


def _time_point(config: Configuration) -> Point:
    return Point("time", WORST_SCENE, config, RUNS)


def _find(candidates: Sequence[Candidate], sweep: Sweep) -> list[Candidate]:
    """Simulate the designs and count their cells."""
    counted = sweep("cells", [_cells_point(one.config) for one in candidates])
    timed = sweep("designs", [_time_point(one.config) for one in candidates])
    return [
        replace(one, counted=counted[_cells_point(one.config)], timing=timed[_time_point(one.config)])
        for one in candidates
    ]


COLUMNS = (
    "design", "wrong pixels: mean, %", "median, %", "maximum, %", "LUT4", "LUT4 estimated", "registers", "multipliers",
    "cycles per frame", "clock, MHz", "clock", "ms per frame", "LUT4 x s", "simulation: median, s", "minimum, s",
    "maximum, s", "pixels unlike the model", "command",
)  # fmt: skip
SHOWN = 0, 1, 3, 4, 7, 8, 9, 10, 11, 12, 13
"""Columns on the page."""


def design_chapter(found: Designs, spreads: Spreads) -> Chapter:
    """Return the chapter."""
    rounded, exact, best = found.rounded, found.exact, found.best
    shown = [one for one in [*exact, *rounded] if one.is_found]
    estimates = [one for one in rounded if not one.is_found]
    data = Data("designs", COLUMNS, [_row(one, spreads) for one in [*shown, *estimates]])
    table = Table(data, [COLUMNS[at] for at in SHOWN], [[row[at] for at in SHOWN] for row in data.rows[: len(shown)]])
    sums = [one.estimated / one.cells - 1 for one in shown if one.estimated]
    captions = {
        "frame_ms": "Error against time per frame. Filled: at the clock that the design reached when it was placed and "
        "routed. Hollow: at the clock that its monitor requires.",
        "work": "Error against cells times time per frame.",
        "cells": "Error against cells.",
        "simulated_s": f"Error against the time per frame in Verilator, on one core: median of {RUNS} runs, and bars "
        "from minimum to maximum.",
    }
    drawn = [
        Plot(f"work_{cost}", caption, plots.work_precision(rounded, exact, cost, line), data)
        for cost, caption in captions.items()
        for line in [found.by(cost) if cost in COSTS else []]
    ]
    wrong = sum(one.timing["wrong"] for one in shown if one.timing)
    off = sum(one.frame_cycles != predicted_cycles(one.config) for one in shown)
    beaten = [
        any(other.cells <= one.cells and other.required_ms <= one.required_ms for other in exact) for one in rounded
    ]
    said = [
        f"{len(best)} designs are on a frontier. In simulation, {off} designs took more or fewer cycles than "
        f"predicted, and {wrong} pixels differ from the golden model.",
        f"Among the {len(rounded)} designs of the seed engine, {sum(beaten)} are neither smaller nor, at the "
        "required clock, faster than some design without error.",
    ]
    ends = {"smallest": min(exact, key=lambda one: one.cells), "fastest": min(exact, key=lambda one: one.frame_ms)}
    words = (
        f"the {which} is {one.title}, with {one.cells:,} LUT4 and {one.frame_ms:.3g} ms per frame"
        for which, one in ends.items()
    )
    verdict = "No design that rounds is worth its error. " if all(beaten) else ""
    text = (
        "Work-precision diagrams, with one reflection. The upper panel shows the designs that round: the mean share of "
        "wrong pixels against the cost. The lower panel shows the designs without error, on the same axis. Grey dots "
        "are estimates; a line is a frontier, on which no other design that rounds is better in one respect without "
        "being worse in the other. Labels: fraction bits F and rounding (n nearest, t truncate) for the seed engine, "
        "units for the exact engine, rows of the picture for the beam engine, x2 with two pixels per clock. The seed "
        "and exact engines draw 320x240 pixels; the beam engine computes every pixel that the monitor shows."
    )
    routed = ", ".join(one.title for one in shown if one.is_routed) or "no designs"
    tuned = [
        f"Placed and routed, at the slowest clock of all boards and seeds measured: {routed}. All "
        "other times are for the clock that the monitor requires, which the designs may miss or exceed.",
        "Tuned, within the row budget: the seed engine has 20 or 32 units and up to 3 quotient bits per cycle, the "
        "exact engine 4 to 16 units. Nothing was chosen for a scene, and all have the same options of Yosys and "
        "Verilator.",
        f"{len(sums)} of {len(rounded)} designs of the seed engine were counted and simulated; by its estimate, no "
        "other is on a frontier. An estimate adds up the cells of the shared part and of each unit, synthesised "
        f"once; estimates differ from the counts by {min(sums):+.1%} to {max(sums):+.1%}.",
        "Left out: other numbers of units and fraction bits; culling, whose time depends on the scene; turned cameras, "
        "patterns, mirror strengths and lights, which cost cells in every engine; and energy, as the tools have no "
        f"power model of the chip. Each simulation draws one frame of {WORST_SCENE}.",
    ]
    sections = [
        Section("Error against run time", text, said, drawn, [table]),
        Section("What was left out, and what was tuned", sentences=tuned),
    ]
    alarms = [f"In simulations of the designs, {wrong} pixels differ from the golden model."] if wrong else []
    return Chapter(sections, alarms, [f"{verdict}Among the designs without error, {', and '.join(words)}."])


def _row(one: Candidate, spreads: Spreads) -> list:
    config, counted, timing = one.config, one.counted or {}, one.timing or {}
    spread = spreads[config.fraction_bits, config.rounding] if config.facts.divides else Spread(0, 0, 0, 0)
    return [
        one.title, *(round(100 * share, 4) for share in (spread.mean, spread.median, spread.most)),
        counted.get("cells"), one.estimated or None, counted.get("registers"), counted.get("multipliers"),
        one.frame_cycles, one.clock_mhz, "routed" if one.is_routed else "required", one.frame_ms, one.work,
        *(of(one.seconds) if one.seconds else None for of in (statistics.median, min, max)), timing.get("wrong"),
        _time_point(config).command,
    ]  # fmt: skip
