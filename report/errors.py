# SPDX-License-Identifier: MIT
"""Chapter on errors: number, size and position of wrong pixels, and trends with fraction bits and reflections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from raycaster.configuration import Rounding
from raycaster.report import plots
from raycaster.report.extent import Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import SEED, Point, name_of, picture, scene_of
from raycaster.report.statistics import Spread, slope
from raycaster.report.sweep import Sweep

ROUNDINGS: tuple[Rounding, ...] = ("truncate", "nearest")
REFLECTIONS = 1
"""Number of reflections in the pictures by which designs are compared."""

FEW, EARLY = 1e-3, 4
"""Share of wrong pixels that counts as few; fraction bits up to which most come from rounding, not from ties."""

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
    fewest, most = what.fractions[0], max(what.reflections)
    points = []
    for r in ROUNDINGS:
        for f in what.fractions:
            of_worlds, of_scenes = ({REFLECTIONS, most}, what.reflections) if f == fewest else ([REFLECTIONS],) * 2
            for sources, several in ((worlds, of_worlds), (shown, of_scenes)):
                points += [picture(source, f, r, reflections) for source in sources for reflections in several]
    # Group the pictures of a scene, because they share the exact one, which is cached.
    points.sort(key=lambda point: (point.what, point.config.reflections))
    return Pictures(what, worlds, shown, sweep("pictures", points))


def error_chapter(pictures: Pictures) -> Chapter:
    """Return the chapter."""
    columns = (
        "scene", "F", "rounding", "reflections", "pixels", "wrong", "wrong share", "PSNR dB", "SSIM",
        "coordinates over bound", "command",
    )  # fmt: skip
    rows = [
        [name_of(one.what), one.config.fraction_bits, one.config.rounding, one.config.reflections,
         *(of[name] for name in ("pixels", "wrong", "wrong_share", "psnr", "ssim")),
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
        "median, %", "maximum, %", "PSNR dB, median", "SSIM, median", "SSIM, minimum",
        "pictures without wrong pixels, %",
    )  # fmt: skip
    rows, said = [], []
    for r in ROUNDINGS:
        for f in fractions:
            found = pictures.of(worlds + pictures.scenes, f, r)
            some, all_scenes = (Spread.of(_shares(pictures.of(of, f, r))) for of in (worlds, pictures.scenes))
            shares = some.median, some.mean, some.most, all_scenes.least, all_scenes.median, all_scenes.most
            ssim, psnr = [one["ssim"] for one in found], [one["psnr"] for one in found if one["psnr"] is not None]
            right = np.mean([not one["wrong"] for one in found])
            likeness = [float(np.median(psnr)) if psnr else None, float(np.median(ssim)), min(ssim)]
            rows.append([f, r, *(100 * share for share in shares), *likeness, 100 * float(right)])
        medians = {f: float(np.median(by[r][f])) for f in fractions}
        good = [f for f in medians if all(medians[more] <= FEW for more in medians if more >= f)]
        least = f"from F = {good[0]}" if good else f"for no F up to {max(medians)}"
        said.append(f"The median picture has at most {FEW:.1%} wrong pixels {least} (rounding: {r}).")
    low, high = (Spread.of(by["nearest"][f]) for f in (fractions[0], fractions[-1]))
    summary = (
        f"With F = {fractions[0]}, rounding to nearest, the share of wrong pixels is {low.median:.3%} in the median "
        f"picture, {low.mean:.3%} on average and {low.most:.3%} in the worst picture; with "
        f"F = {fractions[-1]}, it is {high.median:.3%}, {high.mean:.3%} and {high.most:.3%}."
    )
    text = (
        f"The seed engine's pictures are compared with exact arithmetic, with {REFLECTIONS} reflection, for "
        f"{len(worlds)} random worlds (seeds 0 to {len(worlds) - 1}, {scene_of(worlds[0]).rows} "
        f"rows; six styles, in which ties, edges and slits are common) and the {len(pictures.scenes)} packaged scenes "
        "whose camera is not turned. The exact and beam engines have no wrong pixels."
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
    return Section("Distribution of errors", text, said, drawn, tables), summary


def _trends(pictures: Pictures) -> tuple[Section, str]:
    """Show that errors fall with fraction bits and grow with reflections."""
    what, by = pictures.what, pictures.all_shares
    fractions, fewest, most = what.fractions, what.fractions[0], max(what.reflections)
    every, early, depths = pictures.worlds + pictures.scenes, [f for f in fractions if f <= EARLY], range(most + 1)
    said, falls, grows, rows = [], {}, {}, {}
    for r in ROUNDINGS:
        sums = [_sums(pictures.of(every, f, r), (0,)) for f in fractions]
        falls[r] = slope(fractions, *(np.hstack(part) for part in zip(*sums, strict=True)), binary=True)
        pixels = slope(early, np.array([by[r][f] for f in early]).T, binary=True)
        found = pictures.of(every, fewest, r, most)
        rows[r] = [_depth_row(found, depth) for depth in depths]
        grows[r] = slope(list(depths), *_sums(found, depths))
        said += [
            f"Each fraction bit multiplies a hit point's mean error by 2 to the power of {falls[r]}, and, up to "
            f"F = {early[-1]}, the share of wrong pixels by 2 to the power of {pixels} (rounding: {r}).",
            f"Each reflection increases a hit point's mean error by {grows[r]} world units at F = {fewest} "
            f"(rounding: {r}).",
        ]
    lines = {r: {kind: [row[kind] for row in rows[r]] for kind in KINDS} for r in ROUNDINGS}
    by_depth = [[r, depth, *row.values()] for r in ROUNDINGS for depth, row in enumerate(rows[r])]
    data = Data("hit_errors", ("rounding", "reflections so far", *rows["truncate"][0]), by_depth)
    summary = (
        f"A hit point's mean error halves with each fraction bit (2 to the power of {falls['nearest']}) and grows by "
        f"{grows['nearest'].slope:.2g} world units with each reflection at F = {fewest} (nearest). In "
        f"{len(pictures.results):,} pictures, {pictures.exceeded} coordinates exceed their derived bound."
    )
    text = (
        "The forward error of a hit point is its distance from the exact one. Its coordinate u is off by at most "
        "d'[u] = d[u] + |D[u] / e| d[a] + q, where d is the error of the ray's origin, D is the ray's slope, a is the "
        "axis of the plane, e is the slope along a, and q is one unit in the last place (truncated) or half a unit "
        "(nearest). The bound holds for rays that hit the same rectangle as the exact ray; other rays are counted as "
        "flips. Intervals come from a bootstrap over pictures."
    )
    caption = (
        f"Forward errors of hit points by reflections so far, with F = {fewest}, and the greatest bound of any ray."
    )
    figure = plots.by_depth(lines, KINDS)
    title, plot = "Error against fraction bits and reflections", Plot("hit_errors", caption, figure, data)
    return Section(title, text, said, [plot], [Table.of(data)]), summary


def _sums(found: Found, depths: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the sum of the rays' errors and the number of rays, both (pictures, depths)."""
    means, counts = (
        np.array([[one["depths"][depth][name] for depth in depths] for one in found]) for name in ("mean", "rays")
    )
    return means * counts, counts


def _depth_row(found: Found, depth: int) -> dict[str, float]:
    of = [one["depths"][depth] for one in found if one["depths"][depth]["rays"]]
    totals, counts = _sums(found, [depth])
    return {
        "mean": float(totals.sum() / max(counts.sum(), 1)),
        "worst, median picture": float(np.median([one["worst"] for one in of])) if of else 0.0,
        "worst": max((one["worst"] for one in of), default=0.0),
        "greatest bound": max((one["bound"] for one in of), default=0.0),
        "greatest error / bound": max((one["tightest"] for one in of), default=0.0),
        "rays": int(counts.sum()),
        "flips": sum(one["depths"][depth]["flips"] for one in found),
    }
