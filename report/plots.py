# SPDX-License-Identifier: MIT
"""The report's plots, each a PNG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from raycaster.golden import exact, seed_engine
from raycaster.golden.errors import DepthErrors
from raycaster.golden.picture import count_wrong, diff_picture
from raycaster.report.hardware import Candidate
from raycaster.report.points import PicturePoint, View
from raycaster.screens import SCREENS

DPI = 110
COLOURS = {"truncate": "#c0392b", "nearest": "#2471a3"}
FLOOR = 1e-4
"""Per cent: below it a share is drawn as none on logarithmic axes."""

FLIPPED = 5
"""Cases whose pictures are shown."""

Results = Mapping[PicturePoint, Mapping]


def error_by_fraction(results: Results, path: Path) -> None:
    """Wrong pixels of every scene over the fraction bits, and their mean."""
    figure, axes = _subplots(figsize=(9, 5))
    for rounding, colour in COLOURS.items():
        scenes: dict[str, list[tuple[int, float]]] = {}
        for point, result in results.items():
            if point.rounding == rounding:
                share = max(100 * result["wrong_share"], FLOOR)
                scenes.setdefault(point.view.name, []).append((point.fraction_bits, share))
        for curve in scenes.values():
            axes.plot(*zip(*sorted(curve), strict=True), color=colour, alpha=0.25, linewidth=1)
        fractions = sorted({fraction for curve in scenes.values() for fraction, _ in curve})
        means = [np.mean([share for curve in scenes.values() for at, share in curve if at == f]) for f in fractions]
        axes.plot(fractions, means, color=colour, linewidth=2.5, marker="o", label=f"{rounding}, mean")
    axes.set(xlabel="fraction bits F", ylabel="wrong pixels, %", yscale="log", xticks=fractions)
    axes.set_title("Error over fraction bits, a line a scene")
    axes.grid(alpha=0.3, which="both")
    axes.legend()
    _save(figure, path)


def culling(shares: Mapping[str, Mapping[str, float]], path: Path) -> None:
    """By engine and scene, the share of a frame's cycles that is left with culling: a bar each."""
    scenes = sorted({name for of_engine in shares.values() for name in of_engine}, reverse=True)
    figure, axes = _subplots(figsize=(9, 1.5 + 0.4 * len(scenes)))
    height = 0.8 / len(shares)
    for place, (engine, of_engine) in enumerate(shares.items()):
        offsets = np.arange(len(scenes)) + 0.4 - (place + 0.5) * height
        bars = axes.barh(offsets, [100 * of_engine[name] for name in scenes], height, label=engine)
        axes.bar_label(bars, fmt="%.0f", padding=3, fontsize=8)
    axes.axvline(100, color="black", linewidth=1)
    axes.set(xlabel="cycles of a frame with culling, % of those without", xlim=(0, 115))
    axes.set_yticks(np.arange(len(scenes)), scenes)
    axes.set_title("What culling leaves")
    axes.legend()
    _save(figure, path)


def work_precision(
    candidates: Sequence[Candidate], best: Sequence[Candidate], of_seed: Sequence[Candidate], path: Path
) -> None:
    """Error over the time of a frame, cells in colour; the frontiers of all designs and of the seed engine's."""
    figure, axes = _subplots(figsize=(11, 6.5))
    shapes = {"seed": "o", "exact": "s"}
    norm = Normalize(min(one.cells for one in candidates), max(one.cells for one in candidates))
    for engine, shape in shapes.items():
        of_engine = [one for one in candidates if one.config.engine == engine]
        if of_engine:
            times, errors, cells = np.array([(one.frame_ms, _per_cent(one), one.cells) for one in of_engine]).T
            dots = axes.scatter(
                times,
                errors,
                c=cells,
                cmap="viridis",
                norm=norm,
                marker=shape,
                s=30,
                alpha=0.7,
                label=f"{engine} engine",
            )
    figure.colorbar(dots, label="LUT4 of an ECP5, foretold")
    for frontier, colour, label in (
        (of_seed, "#c0392b", "seed engine's frontier"),
        (best, "#1e8449", "frontier of all"),
    ):
        places = [(one.frame_ms, _per_cent(one)) for one in frontier]
        axes.scatter(
            *zip(*places, strict=True), facecolors="none", edgecolors=colour, s=100, linewidths=1.4, label=label
        )
        steps = sorted({time: min(error for at, error in places if at == time) for time, _ in places}.items())
        lowest = np.minimum.accumulate([error for _, error in steps])
        axes.step([time for time, _ in steps], lowest, where="post", color=colour, linewidth=1.2)
        for place, ((time, error), low) in enumerate(zip(steps, lowest, strict=True)):
            if error == low and (place == 0 or low < lowest[place - 1] or frontier is best):
                one = min((o for o in frontier if (o.frame_ms, _per_cent(o)) == (time, error)), key=lambda o: o.cells)
                axes.annotate(
                    _short(one), (time, error), textcoords="offset points", xytext=(5, 7), fontsize=7, rotation=25
                )
    axes.set(xlabel="time to render a frame at 50 MHz, ms", ylabel="wrong pixels, mean over scenes, %", yscale="log")
    axes.set_title(f"Work and precision; {FLOOR:g} % stands for none")
    axes.grid(alpha=0.3, which="both")
    # Room for the words at the uppermost dots.
    axes.margins(y=0.12)
    axes.legend()
    _save(figure, path)


def _per_cent(one: Candidate) -> float:
    return max(100 * one.error, FLOOR)


def _short(one: Candidate) -> str:
    config = one.config
    if config.engine == "exact":
        return f"{config.units} units"
    return f"F{config.fraction_bits} {config.rounding}, {config.divider_bits} bit, {config.units} units"


def growth(cases: Mapping[str, tuple[DepthErrors, ...]], path: Path) -> None:
    """The worst error and its bound from bounce to bounce, a panel a case."""
    columns = 3
    rows = -(-len(cases) // columns)
    figure, panels = _subplots(rows, columns, figsize=(12, 3.2 * rows), squeeze=False, sharex=True)
    for panel, (name, depths) in zip(panels.flat, cases.items(), strict=False):
        place = range(len(depths))
        panel.plot(place, [max(one.bound, 1e-3) for one in depths], "--", color="#7f8c8d", label="bound")
        panel.plot(place, [max(one.worst, 1e-3) for one in depths], "o-", color="#c0392b", label="worst")
        panel.plot(place, [max(one.mean, 1e-3) for one in depths], "o-", color="#2471a3", label="mean")
        panel.set(title=name, yscale="log")
        panel.grid(alpha=0.3)
    for panel in panels.flat[len(cases) :]:
        panel.set_visible(False)
    for panel in panels[-1]:
        panel.set_xlabel("bounces")
    panels[0][0].set_ylabel("world units")
    panels[0][0].legend()
    _save(figure, path)


def picture_of_the_day(view: View, path: Path) -> None:
    """A scene at F = 0, 2, 4 and exact, and where the first three are wrong."""
    screen = SCREENS["vga", 240]
    perfect = exact.render(view.scene, screen)
    figure, panels = _subplots(2, 4, figsize=(16, 7))
    for column, fraction_bits in enumerate((0, 2, 4)):
        picture = seed_engine.render(view.scene, screen, fraction_bits)
        panels[0][column].imshow(picture)
        panels[0][column].set_title(f"F = {fraction_bits}")
        panels[1][column].imshow(diff_picture(picture, perfect))
        panels[1][column].set_title(f"{count_wrong(picture, perfect):,} wrong pixels of {perfect[..., 0].size:,}")
    panels[0][3].imshow(perfect)
    panels[0][3].set_title("exact")
    for panel in panels.flat:
        panel.axis("off")
    figure.suptitle(f"{view.name}, truncated")
    _save(figure, path)


def flips(points: Sequence[PicturePoint], path: Path) -> None:
    """Of each point the picture, the exact one, and where they differ."""
    figure, panels = _subplots(3, len(points), figsize=(3.2 * len(points), 7.6), squeeze=False)
    for column, point in zip(panels.T, points, strict=True):
        screen = SCREENS["vga", 240]
        picture = seed_engine.render(
            point.scene, screen, point.fraction_bits, rounding=point.rounding, reflections=point.reflections
        )
        perfect = exact.render(point.scene, screen, reflections=point.reflections)
        for axes, shown in zip(column, (picture, perfect, diff_picture(picture, perfect)), strict=True):
            axes.imshow(shown)
            axes.axis("off")
        column[0].set_title(f"{point.view.name}\nF = {point.fraction_bits}, {point.rounding}", fontsize=9)
        column[1].set_title("exact", fontsize=9)
        column[2].set_title(f"{count_wrong(picture, perfect):,} wrong pixels", fontsize=9)
    _save(figure, path)


def catalogue_verdict(
    names: Sequence[str], tightest: Mapping[str, Sequence[float]], flips: Mapping[str, Sequence[float]], path: Path
) -> None:
    """Of every case the part of its bound that is reached, and the rays that flip."""
    figure, (left, right) = _subplots(1, 2, figsize=(13, 0.2 * len(names) + 1.5), sharey=True)
    rows = np.arange(len(names))
    for offset, (label, values) in zip((-0.2, 0.2), tightest.items(), strict=False):
        left.barh(rows + offset, values, 0.4, label=label, color=COLOURS[label.split()[-1]])
        right.barh(rows + offset, flips[label], 0.4, label=label, color=COLOURS[label.split()[-1]])
    left.axvline(1, color="black", linewidth=1)
    left.set(yticks=rows, yticklabels=names, xlabel="worst error as a part of its bound", ylim=(len(names) - 0.5, -0.5))
    left.tick_params(axis="y", labelsize=7)
    right.set(xlabel="rays that hit something else than the exact ray, %", xscale="symlog")
    figure.legend(loc="outside upper center", ncols=2, fontsize=9, handles=left.get_legend_handles_labels()[0])
    for axes in (left, right):
        axes.grid(alpha=0.3, axis="x")
    _save(figure, path)


def _subplots(rows: int = 1, columns: int = 1, *, figsize: tuple[float, float], **options):
    figure = Figure(figsize=figsize, layout="constrained")
    return figure, figure.subplots(rows, columns, **options)


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=DPI)
