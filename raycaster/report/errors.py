# SPDX-License-Identifier: MIT
"""Chapter on errors: number, size and position of wrong pixels, and trends with fraction bits and reflections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from raycaster.configuration import MOST_REFLECTIONS, Rounding
from raycaster.report import plots
from raycaster.report.extent import Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import SEED, Point, Sweep, name_of, picture, scene_of

ROUNDINGS: tuple[Rounding, ...] = ("truncate", "nearest")
REFLECTIONS, DEEPEST = 1, MOST_REFLECTIONS
"""Number of reflections in the pictures by which designs are compared, and in those that show the error by depth."""

KINDS = {
    "greatest bound": {"color": plots.GREY, "linestyle": "--", "marker": "_"},
    "worst": {"color": plots.VERMILION, "marker": "v"},
    "worst, median picture": {"color": plots.ORANGE, "marker": "s"},
    "mean": {"color": plots.BLUE, "marker": "o"},
}
"""Errors by depth of reflection that are plotted, and their lines."""

Found = Sequence[Mapping[str, Any]]


@dataclass(frozen=True)
class Pictures:
    """Every picture of random worlds and packaged scenes, by their sources."""

    what: Extent
    worlds: list[str]
    scenes: list[str]
    results: Mapping[Point, Mapping[str, Any]]

    def of(self, sources: Sequence[str], f: int, r: Rounding, reflections: int = REFLECTIONS) -> Found:
        """Return the results for F and a rounding, one per source."""
        return [self.results[picture(source, f, r, reflections)] for source in sources]

    @property
    def all_shares(self) -> Mapping[Rounding, Mapping[int, list[float]]]:
        """Shares of wrong pixels of all worlds and scenes, by rounding and fraction bits."""
        return {
            r: {f: _shares(self.of(self.worlds + self.scenes, f, r)) for f in self.what.fractions} for r in ROUNDINGS
        }

    @property
    def exceeded(self) -> int:
        """Number of hit-point coordinates over their bound."""
        return sum(depth["exceeded"] for one in self.results.values() for depth in one["depths"])


def find_pictures(what: Extent, scenes: Sequence[str], sweep: Sweep) -> Pictures:
    """Draw every picture that the seed engine can show, with every arithmetic."""
    worlds = [f"{SEED}{number}" for number in range(what.worlds)]
    shown = [scene for scene in scenes if not scene_of(scene).camera.turned]
    points = [
        picture(source, f, r, reflections)
        for r in ROUNDINGS for f in what.fractions for source in worlds + shown
        for reflections in ((REFLECTIONS, DEEPEST) if f == what.fractions[0] else (REFLECTIONS,))
    ]  # fmt: skip
    # Group the pictures of a scene, because they share the exact one, which is cached.
    points.sort(key=lambda point: (point.what, point.config.most_reflections))
    return Pictures(what, worlds, shown, sweep("pictures", points))


def error_chapter(pictures: Pictures) -> Chapter:
    """Return the chapter."""
    columns = (
        "scene", "F", "rounding", "reflections", "pixels", "wrong", "wrong share", "coordinates over bound", "command",
    )  # fmt: skip
    rows = [
        [name_of(one.what), one.config.fraction_bits, one.config.rounding, one.config.most_reflections,
         *(of[name] for name in ("pixels", "wrong", "wrong_share")),
         sum(depth["exceeded"] for depth in of["depths"]), one.command]
        for one, of in pictures.results.items()
    ]  # fmt: skip
    distribution, first = _distribution(pictures, Data("pictures", columns, rows))
    trends, second = _trends(pictures)
    alarms = [f"{pictures.exceeded} coordinates exceed their bound."] if pictures.exceeded else []
    return Chapter([distribution, trends], alarms, [first, second])


def _shares(found: Found) -> list[float]:
    return [one["wrong_share"] for one in found]


def _distribution(pictures: Pictures, every: Data) -> tuple[Section, str]:
    fractions, worlds, by = pictures.what.fractions, pictures.worlds, pictures.all_shares
    columns = (
        "F", "rounding", "wrong pixels, worlds: median, %", "mean, %", "maximum, %", "scenes: minimum, %",
        "median, %", "maximum, %", "pictures without wrong pixels, %",
    )  # fmt: skip
    rows = []
    for r in ROUNDINGS:
        for f in fractions:
            some, all_scenes = (_shares(pictures.of(of, f, r)) for of in (worlds, pictures.scenes))
            shares = [of(some) for of in (np.median, np.mean, max)] + [of(all_scenes) for of in (min, np.median, max)]
            right = np.mean([not share for share in by[r][f]])
            rows.append([f, r, *(100 * float(share) for share in [*shares, right])])
    low, high = (
        [f"{of(by['nearest'][f]):.3%}" for of in (np.median, np.mean, max)] for f in (fractions[0], fractions[-1])
    )
    summary = (
        f"With F = {fractions[0]}, rounding to nearest, the share of wrong pixels is {low[0]} in the median "
        f"picture, {low[1]} on average and {low[2]} in the worst picture; with "
        f"F = {fractions[-1]}, it is {high[0]}, {high[1]} and {high[2]}."
    )
    text = (
        f"The seed engine's pictures are compared with exact arithmetic, with {REFLECTIONS} reflection, for "
        f"{len(worlds)} random worlds (seeds 0 to {len(worlds) - 1}, {scene_of(worlds[0]).rows} "
        f"rows; six styles, in which ties, edges and slits are common) and the {len(pictures.scenes)} packaged scenes "
        "whose camera is not turned. The exact and span engines have no wrong pixels."
    )
    shown = [picture(source, 0, "truncate", scene_of(source).reflections) for source in pictures.scenes]
    drawn = [
        Plot("shares", "Share of wrong pixels per picture, by fraction bits and rounding. Boxes span the quartiles, "
             "lines are medians, dots are means, whiskers reach from minimum to maximum.", plots.shares(by), every),
        Plot("wrong_by_scene", "Wrong pixels in pink on the dimmed exact picture, with F = 0, truncated, and the "
             "scene's own reflections.", plots.wrong_by_scene(shown),
             Data("wrong_by_scene", ("scene", "command"), [[name_of(one.what), one.command] for one in shown])),
    ]  # fmt: skip
    tables = [Table.of(Data("distribution", columns, rows))]
    return Section("Distribution of errors", text, plots=drawn, tables=tables), summary


def _trends(pictures: Pictures) -> tuple[Section, str]:
    """Show that errors fall with fraction bits and grow with reflections."""
    what = pictures.what
    fewest, most, depths = what.fractions[0], DEEPEST, range(DEEPEST + 1)
    every, said, rows = pictures.worlds + pictures.scenes, [], {}
    for r in ROUNDINGS:
        ends = [_depth_row(pictures.of(every, f, r), 0)["mean"] for f in (fewest, what.fractions[-1])]
        falls = np.log2(ends[0] / ends[1]) / (what.fractions[-1] - fewest)
        rows[r] = [_depth_row(pictures.of(every, fewest, r, most), depth) for depth in depths]
        grows = (rows[r][most]["mean"] - rows[r][0]["mean"]) / most
        said.append(
            f"A hit point's mean error is divided by 2 to the power of {falls:.3g} per fraction bit, from F = {fewest} "
            f"to {what.fractions[-1]}, and grows by {grows:.2g} world units per reflection at F = {fewest} "
            f"(rounding: {r})."
        )
    lines = {r: {kind: [row[kind] for row in rows[r]] for kind in KINDS} for r in ROUNDINGS}
    by_depth = [[r, depth, *row.values()] for r in ROUNDINGS for depth, row in enumerate(rows[r])]
    data = Data("hit_errors", ("rounding", "reflections so far", *rows["truncate"][0]), by_depth)
    summary = (
        f"In {len(pictures.results):,} pictures of the seed engine, {pictures.exceeded} coordinates of hit points "
        "exceed their derived bound."
    )
    text = (
        "The forward error of a hit point is its distance from the exact one. Its coordinate u is off by at most "
        "d'[u] = d[u] + |D[u] / e| d[a] + q, where d is the error of the ray's origin, D is the ray's slope, a is the "
        "axis of the plane, e is the slope along a, and q is one unit in the last place (truncated) or half a unit "
        "(nearest). The bound holds for rays that hit the same rectangle as the exact ray; other rays are counted as "
        "flips."
    )
    caption = (
        f"Forward errors of hit points by reflections so far, with F = {fewest}, and the greatest bound of any ray."
    )
    figure = plots.by_depth(lines, KINDS)
    title, plot = "Error against fraction bits and reflections", Plot("hit_errors", caption, figure, data)
    return Section(title, text, said, [plot], [Table.of(data)]), summary


def _depth_row(found: Found, depth: int) -> dict[str, float]:
    """Summarise the errors of hit points at a depth; the mean is over all rays."""
    every = [one["depths"][depth] for one in found]
    of, rays = [one for one in every if one["rays"]], sum(one["rays"] for one in every)
    return {
        "mean": sum(one["mean"] * one["rays"] for one in of) / max(rays, 1),
        "worst, median picture": float(np.median([one["worst"] for one in of])) if of else 0.0,
        "worst": max((one["worst"] for one in of), default=0.0),
        "greatest bound": max((one["bound"] for one in of), default=0.0),
        "greatest error / bound": max((one["tightest"] for one in of), default=0.0),
        "rays": rays,
        "flips": sum(one["flips"] for one in every),
    }
