# SPDX-License-Identifier: MIT
"""Chapter on arithmetics: the engines' and other projects', by the same measures, and at shared edges and corners."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from raycaster.configuration import configure
from raycaster.golden.measures import ARITHMETICS, NOISE, ROUNDING_MODELS
from raycaster.golden.rivals import SINGLE, RivalModel
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.shadows import dim
from raycaster.golden.world import Rectangles
from raycaster.report import plots
from raycaster.report.errors import REFLECTIONS
from raycaster.report.extent import CASE_REFLECTIONS, Extent
from raycaster.report.fixed_unit import fixed_unit
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import AIMED_RAYS, CASE, SEED, SUITE_SEED, Point, Sweep, exact_trace, name_of, scene_of

TITLES = {
    "exact": "exact, beam", "seed-0": "seed, F = 0", "seed-4": "seed, F = 4", "seed-8": "seed, F = 8",
    "q18.14": "Q18.14", "float20": "20-bit float", "single": "single", "single-epsilon": "single, epsilon",
}  # fmt: skip

EPSILONS = 0.0, 1e-5, 1e-3, 0.1, 1.0
"""World units next to the hit point in which a shadow ray hits nothing."""

SUITE_TABLES, RULE_SLACK = 20, 1e-6
"""Tables of each kind with shared edges, for over a million rays; excess of the rule that float64 may cause."""


Results = Mapping[Point, Mapping[str, Any]]


def case_measures(what: Extent) -> list[Point]:
    """Return the points that measure the catalogue's cases."""
    return [_measured(f"{CASE}{case.name}", CASE_REFLECTIONS, what.case_screen) for case in what.cases]


def arithmetic_chapter(what: Extent, scenes: Sequence[str], sweep: Sweep) -> Chapter:
    """Return the chapter."""
    groups = {
        "random worlds": [_measured(f"{SEED}{number}", REFLECTIONS, "vga") for number in range(what.worlds)],
        "packaged scenes": [_measured(source, REFLECTIONS, "vga") for source in scenes],
        "stiff cases": case_measures(what),
    }
    found = sweep("measures", [point for points in groups.values() for point in points])
    rule, ratio = _rule({point: found[point] for point in groups["stiff cases"]})
    leaks, leaking = _watertight(what, sweep)
    alarms = [f"{leaking} rays leak in exact arithmetic."] if leaking else []
    if ratio > 1 + RULE_SLACK:
        alarms.append(f"A forward error is {ratio:.6f} times the product of condition number and backward error.")
    return Chapter([_compared(groups, found, _units(sweep)), rule, leaks, *_shadows(what, scenes)], alarms)


def _measured(source: str, reflections: int, screen: str) -> Point:
    return Point("measures", source, configure(reflections=reflections, screen=screen, allow_underrun=True))


def _units(sweep: Sweep) -> dict[str, tuple[Mapping[str, int], str]]:
    """Return the cells of a unit of each arithmetic that has one, and the command that counts them."""
    points = {"exact": Point("cells", "rect_tester", configure(engine="exact"))}
    for name, model in ROUNDING_MODELS.items():
        if isinstance(model, SeedModel):
            quotients = {"fraction_bits": model.fraction_bits, "rounding": model.rounding, "divider_bits": 1}
            points[name] = Point("cells", "intersection_helper", configure(**quotients, allow_underrun=True))
    points["q18.14"] = Point("cells", fixed_unit.__name__, configure())
    found = sweep("cells of arithmetic", list(points.values()))
    return {name: (found[point], point.command) for name, point in points.items()}


def _compared(
    groups: Mapping[str, Sequence[Point]], found: Results, units: Mapping[str, tuple[Mapping[str, int], str]]
) -> Section:
    keys = "wrong", "flipped", "near", "far", "never", "backward", "backward_mean", "forward", "of_bound", "by_rule"
    rows = [
        [name_of(point.what), arithmetic, one["pixels"], *(of[key] for key in keys), point.command]
        for point, one in found.items() for arithmetic, of in one["arithmetics"].items()
    ]  # fmt: skip
    # Pictures that every arithmetic can draw.
    common = {group: [found[p] for p in points if not p.scene.camera.turned] for group, points in groups.items()}
    every = [one for of in common.values() for one in of]
    pixels, exact = sum(one["pixels"] for one in every), dict.fromkeys(keys, 0)
    flips = {"any": "flipped", "> 0.01 px": "near", "> 1 px": "far", "none": "never"}
    shares, off = ({key: {} for key in keys} for keys in (common, flips))
    table, means = [], {}
    for name, title in TITLES.items():
        for group, ones in common.items():
            wrong = [one["arithmetics"].get(name, exact)["wrong"] / one["pixels"] for one in ones]
            shares[group][name] = float(np.mean(wrong))
        of = [one["arithmetics"].get(name, exact) for one in every]
        for label, key in flips.items():
            off[label][name] = sum(one[key] for one in of) / pixels
        sizes = [whole["pixels"] - one["never"] for whole, one in zip(every, of, strict=True)]
        means[name] = float(np.average([one["backward_mean"] for one in of], weights=sizes))
        percent = [100 * values[name] for values in (*shares.values(), *off.values())]
        most = [max(one[key] for one in of) for key in ("backward", "forward", "of_bound")]
        cells, command = units.get(name, (dict.fromkeys(("cells", "registers", "multipliers")), None))
        table.append([title, *percent, means[name], *most, *cells.values(), command])
    columns = (
        "arithmetic", *(f"wrong in {group}, %" for group in common), "flipped rays, %",
        *(f"{label}, %" for label in list(flips)[1:]), "backward error: mean, px", "greatest, px",
        "forward error: greatest, units", "error / bound", "LUT4 of a unit", "registers", "multipliers", "command",
    )  # fmt: skip
    cells = {name: of["cells"] for name, (of, _) in units.items()}
    figure = plots.by_arithmetic(
        TITLES, [("wrong pixels", shares), ("flipped rays", off), ("LUT4 of a unit", {"counted": cells})]
    )
    caption = (
        "Wrong pixels; flipped rays, which meet something else, by their backward error; and cells of a unit. Marks at "
        "the left end are 0; units of floats were not counted."
    )
    plot = Plot("arithmetics", caption, figure, Data("arithmetics", columns, table))
    measured = Data("measures", ("scene", "arithmetic", "pixels", *keys, "command"), rows)
    text = (
        "The number of wrong pixels is discontinuous: an error of any size flips a pixel or does not. The backward "
        "error of a ray is the least move of its slope, in pixels, for which it meets what was drawn, mirror by "
        "mirror: 0 for a right ray, and none if no slope does. It is computed from exact polygons on the screen, and "
        "is conservative: never too small. Golden models with other projects' number formats draw the same pictures, "
        "without lights: Q18.14 fixed point, truncated (HomebrewGPU); a float with a sign, 6 bits of exponent and 13 "
        "stored bits of significand, truncated (Racing the Beam); and IEEE single precision, with and without an "
        "epsilon of 0.001 world units. They compute t = n / e and O + D t; the projects' hardware also normalises "
        "slopes and divides by reciprocals or tables, which adds errors. A float's hit point is off by at most "
        "|w| (2 u + u^2) for the way w from the origin, with the unit roundoff u, and twice u times the greater "
        f"operand of the sum. Figures are over the {len(every)} pictures whose camera is not turned; measures.csv has "
        "all. A unit computes a + b (c - d) / e, with one quotient bit per cycle; the exact engine's tests a whole "
        "rectangle, and replaces two. No other cells and no float unit were counted."
    )
    noisy = max(off["none"], key=lambda name: off["none"][name])
    said = [
        f"The mean backward error of all rays is {means['seed-0']:.2g} pixels for the seed engine with F = 0, "
        f"{means['q18.14']:.2g} for Q18.14 and {means['float20']:.2g} for the 20-bit float.",
        f"Most rays without any right slope are in {TITLES[noisy]}: {off['none'][noisy]:.3%}, mostly reflections in "
        "which a mirror hits itself. Errors of over a pixel that more digits do not reduce are in corners, where an "
        "exact ray reflects off all walls, and a rounded one off some.",
    ]
    return Section("Other arithmetic", text, said, [plot], [Table.of(plot.data, hidden=3)], [measured])


def _rule(found: Results) -> tuple[Section, float]:
    """Return the section on forward error, condition and backward error, and the greatest ratio."""
    rows = [
        [name_of(point.what), TITLES[name], *of["relative"], of["by_rule"], point.command]
        for point, one in found.items() for name, of in one["arithmetics"].items() if of["relative"]
    ]  # fmt: skip
    greatest = max(row[5] for row in rows)
    columns = "case", "arithmetic", "relative forward error", "condition", "relative backward error", "greatest ratio"
    shown = {
        TITLES[name]: [(row[3] * row[4], row[2]) for row in rows if row[1] == TITLES[name] and row[2] > NOISE]
        for name in ("seed-0", "q18.14", "float20", "single")
    }
    text = (
        "The relative forward error of a primary ray's hit point is its distance from the exact one, relative to the "
        "exact one's distance from the camera; its relative backward error is the least relative change of the slope "
        "that leads to the computed point. Forward error <= condition number x backward error, with the condition at "
        "the computed point; by the law of sines this holds exactly, not only for small errors. Points that are off "
        "their plane are moved onto it, along their ray."
    )
    said = [f"The greatest ratio of the two sides is {greatest:.6f}, over all hits with the right rectangle."]
    caption = "The primary ray with the greatest relative forward error, for each stiff case. The line is the rule."
    plot = Plot("rule", caption, plots.rule(shown), Data("rule", (*columns, "command"), rows))
    return Section("Forward error, condition and backward error", text, said, [plot]), greatest


def _watertight(what: Extent, sweep: Sweep) -> tuple[Section, int]:
    """Return the section on shared edges, and the number of leaks in exact arithmetic."""
    tables = min(SUITE_TABLES, max(1, what.worlds // 10))
    points = {name: Point("leaks", f"{name}+{tables}", configure()) for name in ARITHMETICS}
    found = sweep("shared edges", list(points.values()))
    rows = [
        [TITLES[name], kind, rays, leaks, point.command]
        for name, point in points.items() for kind, (rays, leaks) in found[point].items()
    ]  # fmt: skip
    data = Data("leaks", ("arithmetic", "rays at", "rays", "leaks", "command"), rows)
    by: dict[str, dict[str, float]] = {kind.partition(",")[0]: {} for _, kind, *_ in rows}
    for name, point in points.items():
        for kind, of in by.items():
            of_kind = [pair for tables, pair in found[point].items() if tables.partition(",")[0] == kind]
            of[name] = sum(leaks for _, leaks in of_kind) / sum(rays for rays, _ in of_kind)
    sums = {name: np.sum(list(found[point].values()), axis=0).tolist() for name, point in points.items()}
    table = Data("leaks_by_arithmetic", ("arithmetic", "rays", "leaks"), [[TITLES[n], *of] for n, of in sums.items()])
    text = (
        "Rectangles are watertight if no ray passes between two that share an edge or a corner. Rays are aimed "
        "exactly at shared edges and corners of tiled walls, stairs, closed rooms, and closed rooms seen in one of "
        f"their walls, with slopes of 9 bits and those of turned cameras (seed {SUITE_SEED}, {tables} tables of each "
        f"kind, up to {AIMED_RAYS:,} rays each; no turned cameras for the seed engine). A leak is a ray that sees the "
        "background or a farther rectangle. Exact arithmetic has none, by count and by proof: a closed rectangle "
        "contains its edges, cross-multiplied comparisons of integers are exact, and the manual's proofs of "
        "`rect_tester` and `ray_tester` show that the hardware makes them."
    )
    said = [
        f"In exact arithmetic, {sums['exact'][1]:,} of {sums['exact'][0]:,} rays leak.",
        "Where a wall and a step meet in an outward edge, a truncated t is short of both, so Q18.14 and the 20-bit "
        f"float leak {by['stairs']['q18.14']:.2%} of the rays at stairs. Rounding to nearest leaks in closed rooms "
        f"too: {by['room']['single']:.3%} in single precision. The seed engine's rounding never moves a primary ray's "
        "point across a bound, which is an integer: its leaks come from depths that round to the same number, and "
        "from reflected rays, which start at rounded points.",
    ]
    plot = Plot("leaks", "Share of leaking rays by kind of table; marks at the left end are 0.",
                plots.by_arithmetic(TITLES, [("share of leaking rays", by)]), data)  # fmt: skip
    return Section("Shared edges and corners", text, said, [plot], [Table.of(table)]), sums["exact"][1]


def _shadows(what: Extent, sources: Sequence[str]) -> list[Section]:
    """Return the section on shadow rays in single precision; none if no scene has a light."""
    groups = {name_of(source): [scene] for source in sources if (scene := scene_of(source)).light}
    if not groups:
        return []
    stiff = [case.scene for case in what.cases if case.scene.light]
    rows, worst = [], (-1, "", [])
    for name, scenes in (groups | {f"{len(stiff)} stiff cases": stiff}).items():
        counts = np.zeros((len(EPSILONS), 3), dtype=int)
        for scene, light in ((one, one.light) for one in scenes if one.light):
            slopes, exact = exact_trace(scene, "vga", 0)
            _, plain = exact_trace(scene.model_copy(update={"light": None}), "vga", 0)
            lit, shown = exact.shadings[0].lit, [("exact", exact.colours.reshape(slopes.shape))]
            for place, epsilon in enumerate(EPSILONS):
                arguments = Rectangles.of_scene(scene), scene.camera.position, slopes.reshape(-1, 3)
                with np.errstate(divide="ignore"):  # a point at the light
                    found = RivalModel(SINGLE, epsilon).lit(*arguments, light.position, exact)
                counts[place] += lit.sum(), (lit & ~found).sum(), (found & ~lit).sum()
                colours = plain.colours.copy()
                dim(colours, (exact.winners[0] >= 0) & ~found, light)
                shown.append((f"epsilon {epsilon:g}: {(lit != found).sum():,} wrong", colours.reshape(slopes.shape)))
            worst = max(worst, (int(counts[0, 1]) if name in groups else -1, name, shown), key=lambda one: one[0])
        for epsilon, of in zip(EPSILONS, counts.tolist(), strict=True):
            rows.append([name, f"{epsilon:g}", *of, of[1] + of[2]])
    totals = {epsilon: sum(row[-1] for row in rows if row[1] == f"{epsilon:g}") for epsilon in EPSILONS}
    text = (
        "A ray tracer in floats rounds the hit point to either side of its rectangle, whose own shadow may then fall "
        "on it: shadow acne. The usual remedy is an epsilon, a distance from the point within which a shadow ray hits "
        "nothing: too small, it leaves the acne; too large, it removes true shadows. Cross-multiplication rounds "
        "nothing and needs none. Here the hit points and shadow rays of primary rays are computed in single precision, "
        "at 320x240; everything else is exact."
    )
    said = [
        "Points in the wrong light by epsilon, in world units: "
        + "; ".join(f"{total:,} with {epsilon:g}" for epsilon, total in totals.items())
        + f". Without one, {worst[0]:,} lit points of {worst[1]} are dark. The exact engine has none."
    ]
    data = Data("shadows", ("scene", "epsilon", "lit points", "wrongly dark", "wrongly lit", "wrong"), rows)
    caption = f"The primary rays of {worst[1]}: exact, and with shadow rays in single precision."
    plot = Plot("shadows", caption, plots.pictures([[worst[2][place] for place in (0, 1, -1)]], 1.9), data)
    return [Section("Shadows without an epsilon", text, said, [plot], [Table.of(data)])]
