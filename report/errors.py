# SPDX-License-Identifier: MIT
"""Chapter on errors: number, size and position of wrong pixels, and trends with fraction bits and reflections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from raycaster.configuration import Rounding
from raycaster.report import plots
from raycaster.report.extent import Extent
from raycaster.report.page import Plot, Section, Table, write_csv
from raycaster.report.points import GRID, SEED, PicturePoint, View, command
from raycaster.report.statistics import Slope, Spread, slope
from raycaster.report.sweep import Sweep

ROUNDINGS: tuple[Rounding, ...] = ("truncate", "nearest")
REFLECTIONS = 1
"""Number of reflections in the pictures by which designs are compared."""

FEW = 1e-3
"""Share of wrong pixels that counts as few: one in a thousand."""

EARLY = 4
"""Fraction bits up to which wrong pixels come mostly from rounding, not from ties that no number of bits resolves."""

Results = Mapping[PicturePoint, Mapping[str, Any]]
COLUMNS = (
    "scene", "F", "rounding", "reflections", "pixels", "wrong", "wrong share", "PSNR dB", "SSIM",
    "coordinates over bound",
)  # fmt: skip


@dataclass(frozen=True)
class Pictures:
    """Every picture of random worlds and packaged scenes."""

    worlds: Sequence[View]
    scenes: Sequence[View]
    results: Results

    def of(
        self, views: Sequence[View], fraction: int, rounding: Rounding, reflections: int = REFLECTIONS
    ) -> list[Mapping]:
        """Return the results for one arithmetic, one per view."""
        return [self.results[PicturePoint(view, fraction, rounding, reflections)] for view in views]

    def shares(self, fraction: int, rounding: Rounding) -> list[float]:
        """Return the shares of wrong pixels for all worlds and scenes."""
        return [one["wrong_share"] for one in self.of([*self.worlds, *self.scenes], fraction, rounding)]

    @property
    def exceeded(self) -> int:
        """Number of hit-point coordinates over their bound."""
        return sum(depth["exceeded"] for one in self.results.values() for depth in one["depths"])


def find_pictures(what: Extent, scenes: Sequence[View], sweep: Sweep) -> Pictures:
    """Draw every picture that the seed engine can show, with every arithmetic."""
    worlds = [View.of(f"{SEED}{number}") for number in range(what.worlds)]
    shown = [scene for scene in scenes if not scene.scene.camera.turned]
    fewest, most = what.fractions[0], max(what.reflections)
    points = [
        PicturePoint(view, f, rounding, reflections)
        for rounding in ROUNDINGS
        for f in what.fractions
        for views, several in (
            (worlds, {REFLECTIONS, most} if f == fewest else {REFLECTIONS}),
            (shown, what.reflections),
        )
        for view in views
        for reflections in several
    ]
    # Group the pictures of a scene, because they share the exact one, which is cached.
    points.sort(key=lambda point: (point.view.source, point.reflections))
    return Pictures(worlds, shown, sweep("pictures", points))


def mean_errors(what: Extent, pictures: Pictures) -> dict[tuple[int, Rounding], float]:
    """Return the mean share of wrong pixels, by fraction bits and rounding."""
    return {(f, r): float(np.mean(pictures.shares(f, r))) for f in what.fractions for r in ROUNDINGS}


def error_sections(what: Extent, pictures: Pictures, directory: Path) -> tuple[list[Section], list[str]]:
    """Write the plots and tables of the chapter, and return its sections and two summary sentences."""
    by = {r: {f: pictures.shares(f, r) for f in what.fractions} for r in ROUNDINGS}
    points = [[*_row(point, result), command(point)] for point, result in pictures.results.items()]
    write_csv((*COLUMNS, "command"), points, directory / "pictures.csv")
    distribution, first = _distribution(what, pictures, by, directory)
    trends, second = _trends(what, pictures, by, directory)
    return [distribution, trends, _places(what, pictures, directory)], [first, second]


def _row(point: PicturePoint, result: Mapping[str, Any]) -> list:
    row = [point.view.name, point.fraction_bits, point.rounding, point.reflections, result["pixels"]]
    row += [result[name] for name in ("wrong", "wrong_share", "psnr", "ssim")]
    return [*row, sum(depth["exceeded"] for depth in result["depths"])]


def _distribution(what: Extent, pictures: Pictures, by: Mapping, directory: Path) -> tuple[Section, str]:
    every = [*pictures.worlds, *pictures.scenes]
    plots.save(plots.shares(by), directory / "shares.svg")
    columns = (
        "F", "rounding", "wrong pixels, worlds: median, %", "mean, %", "maximum, %", "scenes: minimum, %",
        "median, %", "maximum, %", "PSNR dB, median", "SSIM, median", "SSIM, minimum",
        "pictures without wrong pixels, %",
    )  # fmt: skip
    rows, psnr, ssim = [], {}, {}
    for rounding in ROUNDINGS:
        psnr[rounding], ssim[rounding] = {}, {}
        for f in what.fractions:
            found = pictures.of(every, f, rounding)
            psnr[rounding][f] = [one["psnr"] for one in found if one["psnr"] is not None]
            ssim[rounding][f] = [one["ssim"] for one in found]
            worlds = Spread.of([one["wrong_share"] for one in pictures.of(pictures.worlds, f, rounding)])
            scenes = Spread.of([one["wrong_share"] for one in pictures.of(pictures.scenes, f, rounding)])
            ratios = psnr[rounding][f]
            rows.append(
                [
                    f, rounding, _share(worlds.median), _share(worlds.mean), _share(worlds.most), _share(scenes.least),
                    _share(scenes.median), _share(scenes.most), round(float(np.median(ratios)), 1) if ratios else None,
                    round(float(np.median(ssim[rounding][f])), 5), round(min(ssim[rounding][f]), 4),
                    _share(sum(not one["wrong"] for one in found) / len(found)),
                ]
            )  # fmt: skip
    plots.save(plots.likeness(psnr, ssim), directory / "likeness.svg")
    write_csv(columns, rows, directory / "distribution.csv")
    write_csv(
        ("scene", "F", "rounding", "wrong share", "PSNR dB", "SSIM"),
        [
            [view.source, f, r, one["wrong_share"], one["psnr"], one["ssim"]]
            for r in ROUNDINGS
            for f in what.fractions
            for view, one in zip(every, pictures.of(every, f, r), strict=True)
        ],
        directory / "shares.csv",
    )
    fewest, most = what.fractions[0], what.fractions[-1]
    at_first, at_last = (Spread.of(by["nearest"][f]) for f in (fewest, most))
    first = (
        f"With F = {fewest}, rounding to nearest, the share of wrong pixels is {_percent(at_first.median)} in the "
        f"median picture, {_percent(at_first.mean)} on average and {_percent(at_first.most)} in the worst of "
        f"{len(every)} pictures; with F = {most}, it is {_percent(at_last.median)}, {_percent(at_last.mean)} and "
        f"{_percent(at_last.most)}."
    )
    text = (
        f"The seed engine's pictures are compared with exact arithmetic, with {REFLECTIONS} reflection, for "
        f"{len(pictures.worlds)} random worlds (seeds 0 to {len(pictures.worlds) - 1}, {pictures.worlds[0].scene.rows} "
        f"rows; six styles, in which ties, edges and slits are common) and the {len(pictures.scenes)} packaged scenes "
        "whose camera is not turned. The exact and beam engines have no wrong pixels."
    )
    return Section(
        "Distribution of errors", text, _enough(what, by),
        [
            Plot("shares", "Share of wrong pixels per picture, by fraction bits and rounding. Boxes span the "
                 "quartiles, lines are medians, dots are means, whiskers reach from minimum to maximum."),
            Plot("likeness", "PSNR of the pictures with wrong pixels, and SSIM of all pictures: medians, and bands "
                 "from minimum to maximum.", "shares"),
        ],
        [Table("distribution", columns, rows)],
    ), first  # fmt: skip


def _share(value: float) -> float:
    """Convert a share to per cent, as in the columns."""
    return round(100 * value, 4)


def _percent(value: float) -> str:
    return f"{100 * value:.3g}%"


def _enough(what: Extent, by: Mapping) -> list[str]:
    said = []
    for rounding in ROUNDINGS:
        medians = {f: float(np.median(by[rounding][f])) for f in what.fractions}
        good = [f for f in medians if all(medians[more] <= FEW for more in medians if more >= f)]
        least = f"from F = {good[0]}" if good else f"for no F up to {max(medians)}"
        said.append(f"The median picture has at most {FEW:.1%} wrong pixels {least} (rounding: {rounding}).")
    return said


def _trends(what: Extent, pictures: Pictures, by: Mapping, directory: Path) -> tuple[Section, str]:
    """Show that errors fall with fraction bits and grow with reflections."""
    every = [*pictures.worlds, *pictures.scenes]
    means = {r: {f: float(np.mean(values)) for f, values in of.items()} for r, of in by.items()}
    hits = {r: {f: _sums(pictures.of(every, f, r), (0,)) for f in what.fractions} for r in ROUNDINGS}
    mean_hits = {r: {f: float(total.sum() / count.sum()) for f, (total, count) in of.items()} for r, of in hits.items()}
    plots.save(plots.falling(means, mean_hits), directory / "falling.svg")
    write_csv(
        ("rounding", "F", "mean share of wrong pixels", "mean error of a primary hit point, world units"),
        [[r, f, means[r][f], mean_hits[r][f]] for r in ROUNDINGS for f in what.fractions],
        directory / "falling.csv",
    )
    said = []
    falls: dict[str, Slope] = {}
    for r in ROUNDINGS:
        totals, counts = (np.hstack([hits[r][f][part] for f in what.fractions]) for part in (0, 1))
        falls[r] = slope(what.fractions, totals, counts, binary=True)
        early = [f for f in what.fractions if f <= EARLY]
        pixels = slope(early, np.array([by[r][f] for f in early]).T, binary=True)
        said.append(
            f"Each fraction bit multiplies a hit point's mean error by 2 to the power of {falls[r]}, and, up to "
            f"F = {early[-1]}, the share of wrong pixels by 2 to the power of {pixels} (rounding: {r})."
        )
    fewest, most = what.fractions[0], max(what.reflections)
    depth_rows, grows = {}, {}
    for r in ROUNDINGS:
        found = pictures.of(every, fewest, r, most)
        depths = range(most + 1)
        depth_rows[r] = [_depth_row(found, depth) for depth in depths]
        grows[r] = slope(list(depths), *_sums(found, depths))
        said.append(
            f"Each reflection increases a hit point's mean error by {grows[r]} world units at F = {fewest} "
            f"(rounding: {r})."
        )
    plots.save(plots.hit_errors(depth_rows), directory / "hit_errors.svg")
    kinds = list(depth_rows["truncate"][0])
    depth_table = [[r, depth, *row.values()] for r in ROUNDINGS for depth, row in enumerate(depth_rows[r])]
    write_csv(("rounding", "reflections so far", *kinds), depth_table, directory / "hit_errors.csv")
    of_scenes = {
        r: {m: [one["wrong_share"] for one in pictures.of(pictures.scenes, fewest, r, m)] for m in what.reflections}
        for r in ROUNDINGS
    }
    plots.save(plots.by_reflections(of_scenes), directory / "by_reflections.svg")
    write_csv(
        ("scene", "rounding", "reflections", "wrong share", "command"),
        [
            [view.name, r, m, share, command(PicturePoint(view, fewest, r, m))]
            for r in ROUNDINGS for m in what.reflections
            for view, share in zip(pictures.scenes, of_scenes[r][m], strict=True)
        ],
        directory / "by_reflections.csv",
    )  # fmt: skip
    summary = (
        f"A hit point's mean error halves with each fraction bit (2 to the power of {falls['nearest']}) and grows by "
        f"{grows['nearest'].slope:.2g} world units with each reflection at F = {fewest} (nearest). In "
        f"{len(pictures.results):,} pictures, {pictures.exceeded} coordinates exceed their derived bound."
    )
    text = (
        "A hit point's coordinate u is off by at most d'[u] = d[u] + |D[u] / e| d[a] + q, where d is the error of the "
        "ray's origin, D is the ray's slope, a is the axis of the plane, e is the slope along a, and q is one unit in "
        "the last place (truncated) or half a unit (nearest). The bound holds for rays that hit the same rectangle as "
        "the exact ray; other rays are counted as flips. Intervals come from a bootstrap over pictures."
    )
    return Section(
        "Error against fraction bits and reflections", text, said,
        [
            Plot("hit_errors", f"Errors of hit points by reflections so far, with F = {fewest}, over all pictures, and "
                 "the greatest bound of any ray."),
            Plot("falling", "Means over all pictures, by fraction bits."),
            Plot("by_reflections", f"Wrong pixels of the packaged scenes by reflections, with F = {fewest}; one dot "
                 "per scene."),
        ],
        [Table("hit_errors", ("rounding", "reflections so far", *kinds), depth_table)],
    ), summary  # fmt: skip


def _sums(found: Sequence[Mapping], depths: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the sum of the rays' errors and the number of rays, both (pictures, depths)."""
    counts = np.array([[one["depths"][depth]["rays"] for depth in depths] for one in found])
    return np.array([[one["depths"][depth]["mean"] for depth in depths] for one in found]) * counts, counts


def _depth_row(found: Sequence[Mapping], depth: int) -> dict[str, float]:
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


def _places(what: Extent, pictures: Pictures, directory: Path) -> Section:
    fewest = what.fractions[0]
    blocks = {}
    for r in ROUNDINGS:
        found = pictures.of(pictures.worlds, fewest, r)
        blocks[r] = np.sum([one["where"] for one in found], axis=0).reshape(GRID) * np.prod(GRID)
        blocks[r] = blocks[r] / sum(one["pixels"] for one in found)
    plots.save(plots.heat(blocks), directory / "heat.svg")
    write_csv(
        ("rounding", "row of blocks", "column of blocks", "wrong share"),
        [[r, *place, float(share)] for r in ROUNDINGS for place, share in np.ndenumerate(blocks[r])],
        directory / "heat.csv",
    )  # fmt: skip
    plots.save(plots.wrong_by_scene(pictures.scenes, "truncate"), directory / "wrong_by_scene.svg")
    shares = [[view.name, PicturePoint(view, 0, "truncate", view.scene.reflections)] for view in pictures.scenes]
    write_csv(
        ("scene", "command"), [[name, command(point)] for name, point in shares], directory / "wrong_by_scene.csv"
    )
    return Section(
        "Positions of wrong pixels",
        plots=[
            Plot("heat", f"Share of wrong pixels in each block of the picture, over {len(pictures.worlds)} random "
                 f"worlds, with F = {fewest}."),
            Plot("wrong_by_scene", "Packaged scenes whose camera is not turned: wrong pixels in pink on the dimmed "
                 "exact picture, with F = 0, truncated, and the scene's own reflections."),
        ],
    )  # fmt: skip
