# SPDX-License-Identifier: MIT
"""Chapter on designs: work-precision diagrams, error against run time, cells and simulation time, for all engines."""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from raycaster.configuration import Configuration, ConfigurationError, Rounding
from raycaster.convert.take_home import TOP
from raycaster.design.decide import OPTIONS, configure
from raycaster.fpga.fit import cycles_a_frame
from raycaster.report import plots
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import Point, Sweep, required_mhz
from raycaster.rtl.engines import engine_of
from raycaster.runs.outcomes import RESULTS, kept_outcomes
from raycaster.scene import load_scene

WORST_SCENE = "raycaster/scenes/mirror_room.toml"
"""Scene for the simulations: it fills the designs' rectangle tables, so no row of another scene takes longer."""

RUNS = 5
"""Number of simulations by which a design's simulation time is measured."""

COSTS = "frame_ms", "work", "cells"
"""Attributes of a design that are its cost; on each frontier, one of them is set against the error."""

WORDS = {
    "frame_ms": "time per frame, ms",
    "work": "cells x time per frame, LUT4 x s",
    "cells": "cells, ECP5 LUT4",
    "simulated_s": "simulation time per frame, s",
    "error": "mean share of wrong pixels",
}
CLOCKED = "frame_ms", "work"
"""Costs that depend on the clock."""

SPANS: Sequence[Mapping[str, Any]] = (
    {"scale": 1}, {"scale": 1, "units": 2}, {}, {"units": 2}, {"units": 3}, {"rows": 180, "units": 3},
    {"rows": 180, "scale": 6, "pixels": 2, "units": 3},
)  # fmt: skip
"""Options for the span engine at scales 1, 2, 4 and 6, with one to three units, at 1080 rows in pairs of pixels."""

Shares = Mapping[Rounding, Mapping[int, Sequence[float]]]
"""Shares of wrong pixels of all pictures, by rounding and fraction bits."""


@dataclass(frozen=True, eq=False)
class Design:
    """A design with its error and its measured cost.

    Attributes:
        config: its options.
        error: mean share of wrong pixels.
        counted: its ECP5 cells by kind, before placement.
        timing: simulation of frames of `WORST_SCENE`: a point of the kind time, see `raycaster.report.points`.
    """

    config: Configuration
    error: float
    counted: Mapping[str, int]
    timing: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The design in a few words."""
        return engine_of(self.config).describe(self.config)

    @property
    def cells(self) -> int:
        """LUT4 count."""
        return self.counted["cells"]

    @property
    def frame_cycles(self) -> int:
        """Cycles to compute a frame, from the hardware's own counter."""
        return self.timing["frame_cycles"]

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
    def required_ms(self) -> float:
        """Milliseconds to compute a frame, at the clock that the design's monitor requires."""
        return self.frame_cycles / required_mhz(self.config) / 1000

    @property
    def work(self) -> float:
        """LUT4 occupied for a frame's time, in LUT4 times seconds."""
        return self.cells * self.frame_ms / 1000

    @property
    def seconds(self) -> Sequence[float]:
        """Seconds per frame that each run of Verilator's model took."""
        return self.timing["seconds"]

    @property
    def simulated_s(self) -> float:
        """Median of `seconds`."""
        return statistics.median(self.seconds)


def seed_designs(fractions: Iterable[int], units: Iterable[int], screen: str = "vga") -> list[Configuration]:
    """List the seed engine's designs: its own arithmetic, F = 0 truncated, and rounding to nearest with each F.

    Each arithmetic has its smallest design, with the fewest units and quotient bits per cycle that meet the row
    budget, and its fastest, with the most of both. They and the default have no culling, so that a design's time does
    not depend on the scene.
    """
    found = _possible(screen, [{"culling": False}])
    for bits, rounding in ((0, "truncate"), *((f, "nearest") for f in fractions)):
        options = {"culling": False, "fraction_bits": bits, "rounding": rounding}
        choices = itertools.product(units, (1, 2, 3))
        of = _possible(screen, ({**options, "units": count, "divider_bits": digits} for count, digits in choices))
        found += of[:1] + of[-1:]
    return list(dict.fromkeys(found))


def exact_designs(units: Iterable[int], screen: str = "vga") -> list[Configuration]:
    """List designs without error: exact-engine designs that meet the row budget, and span-engine designs.

    The span engine has just one for screens other than VGA.
    """
    spans = SPANS if screen == "vga" else [{}]
    exacts = ({"engine": "exact", "units": count} for count in units)
    return _possible(screen, [*exacts, *({"engine": "span", **one} for one in spans)])


def _possible(screen: str, choices: Iterable[Mapping[str, Any]]) -> list[Configuration]:
    found = []
    for choice in choices:
        with suppress(ConfigurationError):
            found.append(configure(screen=screen, **choice))
    return found


def frontier(every: Sequence[Design], *measures: str) -> list[Design]:
    """Return the designs that no other one dominates, ordered by the first of these attributes.

    A design dominates another if it is better by one measure and not worse by any.
    """
    values = {one: tuple(getattr(one, name) for name in measures) for one in every}

    def dominates(theirs: tuple[float, ...], mine: tuple[float, ...]) -> bool:
        return theirs != mine and all(a <= b for a, b in zip(theirs, mine, strict=True))

    best = (one for one, mine in values.items() if not any(dominates(theirs, mine) for theirs in values.values()))
    return sorted(best, key=values.__getitem__)


@cache
def routed_clocks() -> dict[str, float]:
    """Return the MHz that the system clock reached when a design was placed and routed, by configuration name.

    The slowest counts, if a design was routed for several boards.
    """
    found: dict[str, float] = {}
    for figures in (one.figures for one in kept_outcomes(RESULTS / "bitstreams.json")):
        name, mhz = figures["configuration"], figures["clocks"]["clk"][0]
        found[name] = min(mhz, found.get(name, mhz))
    return found


def best_of(designs: Sequence[Design]) -> list[Design]:
    """Return the designs on any frontier, without duplicates: first those without error, by time and cells."""
    rounded, exact = split(designs)
    of_rounded = itertools.chain.from_iterable(frontier(rounded, cost, "error") for cost in COSTS)
    return list(dict.fromkeys([*frontier(exact, "frame_ms", "cells"), *of_rounded]))


def split(designs: Sequence[Design]) -> tuple[list[Design], list[Design]]:
    """Return the designs that round, and those without error."""
    rounded = [one for one in designs if one.config.facts.divides]
    return rounded, [one for one in designs if one not in rounded]


def to_keep(designs: Sequence[Design]) -> list[dict[str, Any]]:
    """Return a row per design with the figures for the manual's table and plot, and the non-default options."""
    return [
        {
            "design": one.title,
            "options": {k: v for k, option in OPTIONS.items() if (v := getattr(one.config, k)) != option.default},
            "luts": one.cells, "frame_cycles": one.frame_cycles, "wrong_share": one.error,
        }
        for one in designs
    ]  # fmt: skip


def of_kept(rows: Sequence[Mapping[str, Any]]) -> list[Design]:
    """Restore the designs from the rows of `to_keep`, without simulation times."""
    return [Design(configure(**row["options"]), row["wrong_share"], {"cells": row["luts"]}, row) for row in rows]


@plots.styled
def work_precision(designs: Sequence[Design], cost: str) -> Figure:
    """Plot error against a cost, a key of `WORDS`: designs that round above, a line per design without error below.

    Hollow marks are at the clock that a monitor requires, filled ones at a routed clock or for costs without a clock;
    bars span the runs of a simulation. Designs on the frontier have labels.
    """
    rounded, exact = split(designs)
    best = frontier(rounded, cost, "error")
    below = 0.16 * len(exact)
    figure, [[upper], [lower]] = plots.new_figure(3.4 + below, 2, 1, sharex=True, height_ratios=(3, below))
    for axes, every in ((upper, rounded), (lower, exact)):
        ups = [one.error for one in every] if axes is upper else range(len(every))
        for one, up in zip(every, ups, strict=True):
            engine = one.config.facts
            face = "white" if cost in CLOCKED and not one.is_routed else engine.colour
            axes.plot(getattr(one, cost), up, engine.marker, mfc=face, mec=engine.colour, ms=5, mew=0.8)
            if cost == "simulated_s":
                axes.hlines(up, min(one.seconds), max(one.seconds), engine.colour)
    upper.set(xscale="log", yscale="log", ylabel=WORDS["error"])
    upper.margins(0.12)
    plots.ticks(upper.yaxis, lambda share: f"{100 * share:g}%")
    plots.ticks(lower.xaxis, "{:,.0f}".format if cost == "cells" else "{:g}".format)
    lower.set(xlabel=WORDS[cost], ylabel="no error", ylim=(len(exact) - 0.4, -0.6))
    names = [f"{one.config.engine} {engine_of(one.config).label(one.config)}" for one in exact]
    lower.set_yticks(range(len(exact)), names, fontsize=plots.LABEL_POINTS)
    line = [getattr(one, cost) for one in best], [one.error for one in best]
    upper.step(*line, where="post", color=best[0].config.facts.colour, linewidth=0.9, alpha=0.7)
    labels = [(x, y, engine_of(one.config).label(one.config)) for x, y, one in zip(*line, best, strict=True)]
    xs, ys = [getattr(one, cost) for one in rounded], [one.error for one in rounded]
    plots.label(upper, labels, xs, ys, expand=(1.15, 1.3), force_text=(0.3, 0.6))
    return figure


def find_designs(configurations: Sequence[Configuration], shares: Shares, sweep: Sweep) -> list[Design]:
    """Simulate designs and count their cells.

    Args:
        configurations: the designs.
        shares: shares whose means are the errors of the designs that round.
        sweep: computes points.
    """
    counted = sweep("cells", [Point("cells", TOP, config) for config in configurations])
    timed = sweep("designs", [_time_point(config) for config in configurations])
    return [
        Design(
            config, float(np.mean(_shares_of(config, shares))),
            counted[Point("cells", TOP, config)], timed[_time_point(config)],
        )
        for config in configurations
    ]  # fmt: skip


def _shares_of(config: Configuration, shares: Shares) -> Sequence[float]:
    return shares[config.rounding][config.fraction_bits] if config.facts.divides else [0.0]


def _time_point(config: Configuration) -> Point:
    return Point("time", WORST_SCENE, config, RUNS)


COLUMNS = (
    "design", "wrong pixels: mean, %", "median, %", "maximum, %", "LUT4", "registers", "multipliers",
    "cycles per frame", "clock, MHz", "clock", "ms per frame", "LUT4 x s", "simulation: median, s", "minimum, s",
    "maximum, s", "pixels unlike the model", "command",
)  # fmt: skip
SHOWN = 0, 1, 3, 4, 6, 7, 8, 9, 10, 11, 12
"""Columns on the page."""


def design_chapter(designs: Sequence[Design], shares: Shares) -> Chapter:
    """Return the chapter."""
    rounded, exact = split(designs)
    data = Data("designs", COLUMNS, [_row(one, shares) for one in [*exact, *rounded]])
    table = Table(data, [COLUMNS[at] for at in SHOWN], [[row[at] for at in SHOWN] for row in data.rows])
    captions = {
        "frame_ms": "Error against time per frame. Filled: at the clock that the design reached when it was placed and "
        "routed. Hollow: at the clock that its monitor requires.",
        "work": "Error against cells times time per frame.",
        "cells": "Error against cells.",
        "simulated_s": f"Error against the time per frame in Verilator, on one core: median of {RUNS} runs, and bars "
        "from minimum to maximum.",
    }
    drawn = [Plot(f"work_{cost}", caption, work_precision(designs, cost), data) for cost, caption in captions.items()]
    wrong = sum(one.timing["wrong"] for one in designs)
    scene = load_scene(WORST_SCENE)
    off = sum(one.frame_cycles != cycles_a_frame(one.config, scene, one.config.most_reflections) for one in designs)
    beaten = [
        any(other.cells <= one.cells and other.required_ms <= one.required_ms for other in exact) for one in rounded
    ]
    said = [
        f"{len(best_of(designs))} of {len(designs)} designs are on a frontier. In simulation, {off} designs took more "
        f"or fewer cycles than predicted, and {wrong} pixels differ from the golden model.",
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
        "wrong pixels against the cost. On the line, the frontier, no other design that rounds is better in one "
        "respect without being worse in the other. The lower panel shows the designs without error, on the same axis. "
        "Labels: fraction bits F and rounding (n nearest, t truncate) for the seed engine, units for the exact engine, "
        "rows of the picture and units for the span engine. The seed and exact engines draw 320x240 pixels; the span "
        "engine draws as many as its label says, and its time is that of the scene."
    )
    routed = ", ".join(one.title for one in designs if one.is_routed) or "no designs"
    tuned = [
        f"Placed and routed, at the slowest clock of all boards measured: {routed}. All "
        "other times are for the clock that the monitor requires, which the designs may miss or exceed.",
        "Tuned, within the row budget: the seed engine has 20 or 32 units and up to 3 quotient bits per cycle, the "
        "exact engine 4 to 16 units; the span engine has 1 to 3. Nothing was chosen for a scene, and all have the same "
        "options of Yosys and Verilator.",
        "Left out: other numbers of units and fraction bits; truncation with F > 0; culling, whose time depends on the "
        "scene; turned cameras, patterns, mirror strengths and lights, which cost cells in every engine; and energy, "
        f"as the tools have no power model of the chip. Each simulation draws one frame of {WORST_SCENE}.",
    ]
    sections = [
        Section("Error against run time", text, said, drawn, [table]),
        Section("What was left out, and what was tuned", sentences=tuned),
    ]
    alarms = [f"In simulations of the designs, {wrong} pixels differ from the golden model."] if wrong else []
    return Chapter(sections, alarms, [f"{verdict}Among the designs without error, {', and '.join(words)}."])


def _row(one: Design, shares: Shares) -> list:
    config, wrong = one.config, _shares_of(one.config, shares)
    return [
        one.title, *(round(100 * float(of(wrong)), 4) for of in (np.mean, np.median, max)),
        *(one.counted[kind] for kind in ("cells", "registers", "multipliers")), one.frame_cycles, one.clock_mhz,
        "routed" if one.is_routed else "required", one.frame_ms, one.work,
        *(of(one.seconds) for of in (statistics.median, min, max)), one.timing["wrong"], _time_point(config).command,
    ]  # fmt: skip
