# SPDX-License-Identifier: MIT
"""Chapter on designs: work-precision diagrams, error against run time, cells and simulation time, for all engines."""

from __future__ import annotations

import itertools
import json
import statistics
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from matplotlib.figure import Figure

from raycaster.configuration import OPTIONS, Configuration, ConfigurationError, Rounding, configure
from raycaster.convert.take_home import TOP
from raycaster.fpga.area import with_units
from raycaster.outcomes import RESULTS
from raycaster.report import plots
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

BEAMS: Sequence[Mapping[str, Any]] = (
    {"scale": 1}, {}, {"pixels": 2}, {"rows": 180}, {"rows": 180, "pixels": 2}, {"rows": 180, "scale": 6},
    {"rows": 180, "scale": 6, "pixels": 2},
)  # fmt: skip
"""Options for the beam engine at scales 1, 2, 4 and 6, with one or two pixels per clock."""

Spreads = Mapping[tuple[int, Rounding], Spread]
"""Distributions of the share of wrong pixels, by fraction bits and rounding."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A design with its estimated and measured cost."""

    config: Configuration
    error: float
    """Mean share of wrong pixels."""

    estimated: int = 0
    """Estimated ECP5 LUT4 count: the shared part plus the units times the size of one."""

    counted: Mapping[str, int] | None = None
    """Counted cells of the whole design, by kind."""

    timing: Mapping[str, Any] | None = None
    """Simulation result: a point of the kind time, see `raycaster.report.points`."""

    @property
    def is_found(self) -> bool:
        """True if the design was simulated and its cells were counted."""
        return self.counted is not None and self.timing is not None

    @property
    def cells(self) -> int:
        """LUT4 count, or its estimate if the cells were not counted."""
        return self.counted["cells"] if self.counted else self.estimated

    @property
    def frame_cycles(self) -> int:
        """Cycles to compute a frame: from the hardware's counter if simulated, otherwise predicted."""
        return self.timing["frame_cycles"] if self.timing else predicted_cycles(self.config)

    @property
    def is_routed(self) -> bool:
        """True if the design was placed and routed, so that its time is at the clock that it reached."""
        return self.config.name in routed_clocks()

    @property
    def clock_mhz(self) -> float:
        """Routed clock, or the one that the design's monitor requires if it was not placed and routed."""
        return routed_clocks().get(self.config.name, required_mhz(self.config))

    @property
    def frame_ms(self) -> float:
        """Milliseconds to compute a frame, at `clock_mhz`."""
        return self.frame_cycles / self.clock_mhz / 1000

    @property
    def work(self) -> float:
        """LUT4 occupied for a frame's time, in LUT4 times seconds."""
        return self.cells * self.frame_ms / 1000

    @property
    def seconds(self) -> Sequence[float]:
        """Seconds per frame that each run of Verilator's model took; none if it was not simulated here."""
        return (self.timing or {}).get("seconds", ())

    @property
    def simulated_s(self) -> float:
        """Median of `seconds`; NaN without any."""
        return statistics.median(self.seconds) if self.seconds else float("nan")


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


def seed_designs(fractions: Iterable[int], units: Iterable[int], screen: str = "vga") -> list[Configuration]:
    """List the seed engine's designs with these options that meet the row budget, with one reflection.

    They have no culling, so that a design's time does not depend on the scene.
    """
    names = "fraction_bits", "units", "rounding", "divider_bits"
    choices = itertools.product(fractions, units, ("truncate", "nearest"), (1, 2, 3))
    return _possible(screen, ({"culling": False, **dict(zip(names, choice, strict=True))} for choice in choices))


def exact_designs(units: Iterable[int], screen: str = "vga") -> list[Configuration]:
    """List designs without error: the exact engine's that meet the row budget, and the beam engine's.

    The beam engine has just one for screens other than VGA.
    """
    beams = BEAMS if screen == "vga" else [{}]
    exacts = ({"engine": "exact", "units": count} for count in units)
    return _possible(screen, [*exacts, *({"engine": "beam", **one} for one in beams)])


def _possible(screen: str, choices: Iterable[Mapping[str, Any]]) -> list[Configuration]:
    found = []
    for choice in choices:
        with suppress(ConfigurationError):
            found.append(configure(screen=screen, **choice))
    return found


def frontier(candidates: Sequence[Candidate], *measures: str) -> list[Candidate]:
    """Return the designs that no other one dominates, ordered by the first of these attributes.

    A design dominates another if it is better by one measure and not worse by any.
    """
    values = {one: tuple(getattr(one, name) for name in measures) for one in candidates}

    def dominates(theirs: tuple[float, ...], mine: tuple[float, ...]) -> bool:
        return theirs != mine and all(a <= b for a, b in zip(theirs, mine, strict=True))

    best = (one for one, mine in values.items() if not any(dominates(theirs, mine) for theirs in values.values()))
    return sorted(best, key=values.__getitem__)


@cache
def routed_clocks() -> dict[str, float]:
    """Return the MHz that the system clock reached when a design was placed and routed, by configuration name.

    The slowest counts, if a design was routed for several boards, with several seeds, or without a board.
    """
    found: dict[str, float] = {}
    for path in sorted(RESULTS.glob("*.json")):
        kept = json.loads(path.read_text())
        name, figures, reached = kept["scope"].get("configuration"), kept["figures"], []
        if path.name.startswith("bitstream-"):
            reached = [(name, clock) for clock in figures["clocks"].get("clk", [])[:1]]
        elif path.name.startswith("area-") and "routed_mhz" in figures:
            reached = [(name, figures["routed_mhz"])]
        elif path.name == "beside.json":
            ours = (row["design"].partition("RayCaster, ") + (row,) for row in figures["designs"])
            reached = [(configure(engine=engine).name, row["routed_mhz"]) for _, known, engine, row in ours if known]
        for one, mhz in reached:
            found[one] = min(mhz, found.get(one, mhz))
    return found


def required_mhz(config: Configuration) -> float:
    """Return the clock that the design's monitor requires, in MHz."""
    return config.screen_geometry.clock_hz / 1e6


def describe(config: Configuration) -> str:
    """Describe a design in a few words."""
    return config.facts.describe(config)


def to_keep(found: Designs) -> list[dict[str, Any]]:
    """Return a row per design with the figures for the manual's table and plot, and the non-default options."""
    best = found.best
    return [
        {
            "design": describe(one.config),
            "options": {k: v for k, option in OPTIONS.items() if (v := getattr(one.config, k)) != option.default},
            "luts": one.cells, "frame_cycles": one.frame_cycles,
            "frame_ms": one.frame_cycles / required_mhz(one.config) / 1000,
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
        exact: designs without error, all of which are simulated and counted.
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
    beaten = [any(other.cells <= one.cells and other.frame_ms <= one.frame_ms for other in exact) for one in rounded]
    said = [
        f"{len(best)} designs are on a frontier. In simulation, {off} designs took more or fewer cycles than "
        f"predicted, and {wrong} pixels differ from the golden model.",
        f"Among the {len(rounded)} designs of the seed engine, {sum(beaten)} are neither smaller nor faster than some "
        "design without error.",
    ]
    ends = {"smallest": min(exact, key=lambda one: one.cells), "fastest": min(exact, key=lambda one: one.frame_ms)}
    words = (
        f"the {which} is {describe(one.config)}, with {one.cells:,} LUT4 and {one.frame_ms:.3g} ms per frame"
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
    routed = ", ".join(describe(one.config) for one in shown if one.is_routed) or "no designs"
    tuned = [
        f"Placed and routed, some for several boards or with several seeds, of which the slowest counts: {routed}. All "
        "other times are for the clock that the monitor requires, which the designs may miss or exceed.",
        "Tuned, within the row budget: the seed engine has 20 or 32 units and up to 3 quotient bits per cycle, the "
        "exact engine 4 to 16 units. Nothing was chosen for a scene, and all have the same options of Yosys and "
        "Verilator.",
        f"{len(sums)} of {len(rounded)} designs of the seed engine were counted and simulated, as no other can be on a "
        "frontier. For the others, the cells of the shared part and of each unit, which is synthesised once, are added "
        f"up; such sums differ from the counts by {min(sums):+.1%} to {max(sums):+.1%}.",
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
        describe(config), *(round(100 * share, 4) for share in (spread.mean, spread.median, spread.most)),
        counted.get("cells"), one.estimated or None, counted.get("registers"), counted.get("multipliers"),
        one.frame_cycles, one.clock_mhz, "routed" if one.is_routed else "required", one.frame_ms, one.work,
        *(of(one.seconds) if one.seconds else None for of in (statistics.median, min, max)), timing.get("wrong"),
        _time_point(config).command,
    ]  # fmt: skip
