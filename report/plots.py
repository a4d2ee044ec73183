# SPDX-License-Identifier: MIT
"""Plots of the report, narrow enough for a phone, in colours that colour-blind readers can distinguish."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from adjustText import adjust_text
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from raycaster.configuration import Rounding
from raycaster.engines import ENGINES, EXACT, SEED
from raycaster.golden.errors import DepthErrors
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import count_wrong, diff_picture
from raycaster.golden.seed_engine import SeedModel
from raycaster.report.hardware import Candidate
from raycaster.report.points import PicturePoint, View
from raycaster.screens import SCREENS

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

WIDTH = 4.6
"""Width in inches, a column of a printed page; 9-point text stays legible on a phone, at three quarters of the size."""

STYLE: dict[RcKeyType, Any] = {
    "font.size": 9,
    "axes.titlesize": 9,
    "legend.fontsize": 8,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.axisbelow": True,
    "svg.hashsalt": "raycaster",
    "svg.fonttype": "none",
}
LABEL_POINTS = 7.5

VERMILION, BLUE, ORANGE, GREY = SEED.colour, EXACT.colour, "#E69F00", "#7f7f7f"
"""Colours of Okabe and Ito, like the engines' colours, and a grey."""

COLOURS = {"truncate": VERMILION, "nearest": BLUE}

LEAST_SHARE = 1e-5
"""Lower limit for drawing a picture's share of wrong pixels: below one pixel, so smaller shares are drawn as 0."""

LEAST_MEAN = 1e-4
"""Lower limit for drawing mean shares; smaller ones are drawn as 0."""

FLIPPED = 10
"""Number of cases whose pictures are shown."""


def new_figure(height: float, rows: int = 1, columns: int = 1, **options) -> tuple[Figure, np.ndarray]:
    """Create an empty figure of a height in inches, and its axes (rows, columns)."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        FigureCanvasAgg(figure)  # provides the sizes of texts
        return figure, figure.subplots(rows, columns, squeeze=False, **options)


def save(figure: Figure, path: Path) -> None:
    """Write a reproducible SVG, without a date."""
    with mpl.rc_context(STYLE):
        figure.savefig(path, metadata={"Date": None})


def crowded(figure: Figure) -> Iterator[str]:
    """Report labels of a figure that overlap each other or are cut off at its edge."""
    figure.draw_without_rendering()
    assert isinstance(figure.canvas, FigureCanvasAgg), "a figure of new_figure"
    renderer = figure.canvas.get_renderer()
    boxes = [
        (text.get_text(), Text.get_window_extent(text, renderer))
        for axes in figure.axes
        for text in axes.texts
        if text.get_visible() and text.get_text()
    ]
    for text, box in boxes:
        if box.x0 < 0 or box.y0 < 0 or box.x1 > figure.bbox.x1 or box.y1 > figure.bbox.y1:
            yield f"{text} is cut off"
    for (one, box), (other, its) in combinations(boxes, 2):
        if box.overlaps(its):
            yield f"{one} touches {other}"


def _percent(axes: Axes, none: float) -> None:
    """Make the y axis logarithmic, in per cent, with 0 as the label of shares up to `none`."""
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda share, _: "0" if share <= none else f"{100 * share:g}%"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(bottom=none / 2)


def _plain(axis: Axis) -> None:
    """Label the ticks of a logarithmic axis with plain numbers."""
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axis.set_minor_formatter(NullFormatter())


# Designs --------------------------------------------------------------------------------------------------------------


def _dots(axes: Axes, every: Sequence[Candidate], across: str, up: str) -> None:
    """Draw a mark per design: filled if simulated and counted, small if it has culling."""
    for name, engine in ENGINES.items():
        for found in (False, True):
            dots = [one for one in every if one.config.engine == name and one.is_found == found]
            if not dots:
                continue
            xs, ys = ([_value(one, name) for one in dots] for name in (across, up))
            axes.scatter(
                xs, ys, marker=engine.marker, s=[10 if one.config.culling else 22 for one in dots], linewidths=0.8,
                zorder=3, facecolors=engine.colour if found else "none", edgecolors=engine.colour,
                alpha=1 if found else 0.45, label=name if found else f"{name}, estimated",
            )  # fmt: skip


def _value(one: Candidate, name: str) -> float:
    value = getattr(one, name)
    return max(value, LEAST_MEAN) if name == "error" else value


def _label(axes: Axes, labelled: Sequence[Candidate], across: str, up: str, every: Sequence[Candidate]) -> None:
    texts = [
        axes.text(
            _value(one, across), _value(one, up), one.config.facts.label(one.config), fontsize=LABEL_POINTS, zorder=4
        )
        for one in labelled
    ]
    adjust_text(
        texts, x=[_value(one, across) for one in every], y=[_value(one, up) for one in every], ax=axes,
        expand=(1.15, 1.3), force_text=(0.3, 0.6), arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.5},
    )  # fmt: skip


WORDS = {
    "pixel_ns": "time per pixel, ns",
    "cells": "cells, ECP5 LUT4",
    "error": "mean share of wrong pixels",
}


def designs(
    every: Sequence[Candidate], across: str, up: str, frontiers: Sequence[Sequence[Candidate]],
    labelled: Sequence[Candidate],
) -> Figure:  # fmt: skip
    """Plot all designs by two of `pixel_ns`, `cells` and `error`.

    Args:
        every: all designs.
        across: attribute along x.
        up: attribute along y.
        frontiers: designs for each line, ordered along x.
        labelled: designs with a label.
    """
    figure, [[axes]] = new_figure(4.2)
    with mpl.rc_context(STYLE):
        axes.set(xscale="log", yscale="log", xlabel=WORDS[across], ylabel=WORDS[up])
        _dots(axes, every, across, up)
        for frontier in frontiers:
            xs, ys = ([_value(one, name) for one in frontier] for name in (across, up))
            axes.step(xs, ys, where="post", color=frontier[0].config.facts.colour, linewidth=0.9, alpha=0.7)
        if up == "error":
            _percent(axes, LEAST_MEAN)
        else:
            _plain(axes.yaxis)
        _plain(axes.xaxis)
        axes.margins(0.12)
        figure.legend(loc="outside upper center", ncols=3, handletextpad=0.2, columnspacing=1)
        figure.draw_without_rendering()
        _label(axes, labelled, across, up, every)
    return figure


# Errors ---------------------------------------------------------------------------------------------------------------


def shares(by: Mapping[str, Mapping[int, Sequence[float]]]) -> Figure:
    """Plot the distribution of the share of wrong pixels, by rounding and fraction bits."""
    figure, [[axes]] = new_figure(3.6)
    with mpl.rc_context(STYLE):
        for side, (rounding, of) in zip((-0.2, 0.2), by.items(), strict=False):
            colour = COLOURS[rounding]
            axes.boxplot(
                [[max(share, LEAST_SHARE) for share in values] for values in of.values()],
                positions=[place + side for place in range(len(of))], widths=0.32, whis=(0, 100), showmeans=True,
                patch_artist=True, boxprops={"facecolor": colour, "alpha": 0.35, "edgecolor": colour},
                medianprops={"color": "black"}, whiskerprops={"color": colour}, capprops={"color": colour},
                meanprops={"marker": "o", "markersize": 3.5, "markerfacecolor": colour, "markeredgecolor": colour},
                label=rounding,
            )  # fmt: skip
        fractions = list(next(iter(by.values())))
        axes.set_xticks(range(len(fractions)), fractions)
        axes.set(xlabel="fraction bits F", ylabel="wrong pixels per picture")
        _percent(axes, LEAST_SHARE)
        figure.legend(loc="outside upper center", ncols=2)
    return figure


def likeness(
    psnr: Mapping[str, Mapping[int, Sequence[float]]], ssim: Mapping[str, Mapping[int, Sequence[float]]]
) -> Figure:
    """Plot median and range of PSNR, for pictures with wrong pixels, and of SSIM, by rounding and fraction bits."""
    figure, [[upper], [lower]] = new_figure(4.4, 2, 1, sharex=True)
    with mpl.rc_context(STYLE):
        for axes, of in ((upper, psnr), (lower, ssim)):
            for rounding, colour in COLOURS.items():
                found = {f: values for f, values in of[rounding].items() if len(values)}
                low, middle, high = (
                    [part(values) for values in found.values()] for part in (np.min, np.median, np.max)
                )
                axes.fill_between(list(found), low, high, color=colour, alpha=0.15, linewidth=0)
                axes.plot(list(found), middle, marker="o", markersize=4, color=colour, label=rounding)
        upper.set(ylabel="PSNR, dB")
        lower.set(ylabel="SSIM", xlabel="fraction bits F", xticks=list(of["truncate"]))
        handles, labels = upper.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def hit_errors(by: Mapping[str, Sequence[Mapping[str, float]]]) -> Figure:
    """Plot errors of hit points and their greatest bound, by rounding and reflections so far."""
    figure, [panels] = new_figure(3.4, 1, len(by), sharey=True)
    kinds = {
        "greatest bound": (GREY, "--", "_"), "worst": (VERMILION, "-", "v"),
        "worst, median picture": (ORANGE, "-", "s"), "mean": (BLUE, "-", "o"),
    }  # fmt: skip
    with mpl.rc_context(STYLE):
        for axes, (rounding, rows) in zip(panels, by.items(), strict=True):
            for kind, (colour, line, marker) in kinds.items():
                axes.plot([row[kind] for row in rows], line, color=colour, marker=marker, markersize=4, label=kind)
            axes.set(title=rounding, yscale="log", xlabel="reflections so far", xticks=range(len(rows)))
        panels[0].set_ylabel("hit point error, world units")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def falling(by: Mapping[str, Mapping[int, float]], hits: Mapping[str, Mapping[int, float]]) -> Figure:
    """Plot the mean share of wrong pixels and the mean error of primary hit points, by rounding and fraction bits."""
    figure, [panels] = new_figure(3.0, 1, 2)
    with mpl.rc_context(STYLE):
        for axes, of, label in zip(panels, (by, hits), (WORDS["error"], "mean hit error, world units"), strict=True):
            for rounding, colour in COLOURS.items():
                axes.plot(*zip(*of[rounding].items(), strict=True), "o-", markersize=4, color=colour, label=rounding)
            axes.set(yscale="log", xlabel="F", xticks=list(of["truncate"]))
            axes.set_title(label)
        for axes, form in zip(
            panels, (lambda share, _: f"{100 * share:g}%", lambda value, _: f"{value:g}"), strict=True
        ):
            axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axes.yaxis.set_major_formatter(FuncFormatter(form))
            axes.yaxis.set_minor_formatter(NullFormatter())
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def by_reflections(by: Mapping[str, Mapping[int, Sequence[float]]]) -> Figure:
    """Plot each packaged scene's share of wrong pixels and the mean of all, by rounding and reflections."""
    figure, [[axes]] = new_figure(3.0)
    with mpl.rc_context(STYLE):
        for side, (rounding, of) in zip((-0.06, 0.06), by.items(), strict=False):
            for place, values in of.items():
                drawn = [max(value, LEAST_SHARE) for value in values]
                axes.plot([place + side] * len(drawn), drawn, "o", color=COLOURS[rounding], markersize=3, alpha=0.5)
            means = [np.mean(values) for values in of.values()]
            axes.plot(list(of), means, color=COLOURS[rounding], label=f"{rounding}, mean")
        axes.set(xlabel="reflections", ylabel="wrong pixels per scene", xticks=list(of))
        _percent(axes, LEAST_SHARE)
        figure.legend(loc="outside upper center", ncols=2)
    return figure


def heat(by: Mapping[str, np.ndarray]) -> Figure:
    """Plot the share of wrong pixels in each block of the picture over all worlds, by rounding."""
    figure, panels = new_figure(2.9 * len(by), len(by), 1)
    most = max(float(shares.max()) for shares in by.values())
    with mpl.rc_context(STYLE):
        for [axes], (rounding, blocks) in zip(panels, by.items(), strict=True):
            image = axes.imshow(
                100 * blocks, cmap="cividis", vmin=0, vmax=100 * most, extent=(0, 320, 240, 0), interpolation="nearest"
            )
            axes.set(title=rounding, xticks=(0, 160, 320), yticks=(0, 120, 240))
            axes.grid(visible=False)
        figure.colorbar(image, ax=panels, label="wrong pixels, %", shrink=0.7)
    return figure


def pictures(rows: Sequence[Sequence[tuple[str, np.ndarray]]], height: float) -> Figure:
    """Show rows of pictures with titles."""
    figure, panels = new_figure(height * len(rows), len(rows), len(rows[0]))
    with mpl.rc_context(STYLE):
        for axes in panels.flat:
            axes.axis("off")
        for line, row in zip(panels, rows, strict=True):
            for axes, (title, picture) in zip(line, row, strict=False):
                axes.imshow(picture)
                axes.set_title(title, fontsize=LABEL_POINTS)
    return figure


def wrong_by_scene(scenes: Sequence[View], rounding: Rounding) -> Figure:
    """Show the seed engine's wrong pixels without fraction bits, for each scene."""
    columns, shown = 3, []
    for scene in scenes:
        screen = SCREENS["vga", 240]
        perfect, picture = (model.render(scene.scene, screen) for model in (ExactModel(), SeedModel(rounding=rounding)))
        share = count_wrong(picture, perfect) / perfect[..., 0].size
        shown.append((f"{scene.name}: {share:.2%}", diff_picture(picture, perfect)))
    return pictures([shown[at : at + columns] for at in range(0, len(shown), columns)], 1.35)


# Stability ------------------------------------------------------------------------------------------------------------


def flips(points: Sequence[PicturePoint]) -> Figure:
    """Show each point's picture, the exact picture and their difference."""
    rows = []
    for point in points:
        screen = SCREENS["vga", 240]
        picture, perfect = (
            model.render(point.scene, screen, point.reflections)
            for model in (SeedModel(point.fraction_bits, point.rounding), ExactModel())
        )
        rows.append(
            [
                (f"{_two_lines(point.view.name)}\nF = {point.fraction_bits}, {point.rounding}", picture),
                ("exact", perfect),
                (f"{count_wrong(picture, perfect):,} wrong", diff_picture(picture, perfect)),
            ]
        )
    return pictures(rows, 1.45)


def _two_lines(name: str) -> str:
    """Break a case's name into lines no wider than its picture."""
    return fill(name.replace("_", " "), 18)


def stiffness(cases: Mapping[str, tuple[float, float, float]], labelled: Sequence[str]) -> Figure:
    """Plot worst error and greatest bound against condition number, for each case."""
    figure, [[axes]] = new_figure(3.8)
    with mpl.rc_context(STYLE):
        conditions, errors, bounds = np.array(list(cases.values())).T
        axes.vlines(conditions, errors, bounds, color=GREY, linewidth=0.5, alpha=0.6)
        axes.scatter(conditions, bounds, marker="_", color=GREY, s=30, label="greatest bound")
        axes.scatter(conditions, errors, marker="o", color=BLUE, s=14, label="worst error", zorder=3)
        axes.set(
            xscale="log", yscale="log", xlabel="condition number, world units per pixel",
            ylabel="world units",
        )  # fmt: skip
        axes.margins(0.2, 0.1)
        figure.legend(loc="outside upper center", ncols=2)
        figure.draw_without_rendering()
        texts = [axes.text(*cases[name][:2], name, fontsize=LABEL_POINTS, zorder=4) for name in labelled]
        adjust_text(
            texts, x=conditions, y=errors, ax=axes, expand=(1.3, 1.8), force_text=(0.6, 1.2),
            arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.5},
        )  # fmt: skip
    return figure


def growth(cases: Mapping[str, tuple[DepthErrors, ...]]) -> Figure:
    """Plot errors and their bound by number of bounces, one panel per case."""
    columns = 2
    rows = -(-len(cases) // columns)
    figure, panels = new_figure(1.7 * rows + 0.5, rows, columns, sharex=True)
    lines = {"bound": (GREY, "--"), "worst": (VERMILION, "o-"), "mean": (BLUE, "o-")}
    with mpl.rc_context(STYLE):
        for panel, (name, depths) in zip(panels.flat, cases.items(), strict=False):
            for kind, (colour, style) in lines.items():
                values = [max(getattr(one, kind), 1e-3) for one in depths]
                panel.plot(values, style, color=colour, markersize=3, label=kind)
            panel.set(title=name, yscale="log", xticks=range(0, len(depths), 2))
        for panel in panels.flat[len(cases) :]:
            panel.set_visible(False)
        for panel in panels[-1]:
            panel.set_xlabel("bounces")
        for panel in panels[:, 0]:
            panel.set_ylabel("world units")
        handles, labels = panels[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


# Omissions ------------------------------------------------------------------------------------------------------------


def waterfall(title: str, steps: Sequence[tuple[str, int]]) -> Figure:
    """Plot the cells of a design and the change by each step; omit steps without a change."""
    changed = [(what, before, after) for (_, before), (what, after) in pairwise(steps) if after != before]
    figure, [[axes]] = new_figure(0.9 + 0.24 * (len(changed) + 2))
    (first, whole), (_, left) = steps[0], steps[-1]
    with mpl.rc_context(STYLE):
        names = [first, *(f"- {what}" for what, _, _ in changed), "this scene alone"]
        rows = np.arange(len(names))
        axes.barh(rows[[0, -1]], [whole, left], 0.7, color=BLUE)
        for row, (_, before, after) in zip(rows[1:], changed, strict=False):
            axes.barh(row, before - after, 0.7, left=after, color=ORANGE if after < before else VERMILION)
        ends = [whole, *(max(before, after) for _, before, after in changed), left]
        words = [
            f"{whole:,}",
            *(f"{after - before:+,}" for _, before, after in changed),
            f"{left:,} ({left / whole:.0%})",
        ]
        for row, end, word in zip(rows, ends, words, strict=True):
            axes.text(end, row, f" {word}", va="center", fontsize=LABEL_POINTS)
        axes.set_yticks(rows, names)
        axes.invert_yaxis()
        axes.set(xlabel="LUT4", title=title, xlim=(0, 1.25 * max(ends)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.grid(visible=False, axis="y")
    return figure


def culling(by: Mapping[str, Mapping[str, float]]) -> Figure:
    """Plot the cycles per frame with culling, relative to those without: one bar per engine and scene it can draw."""
    scenes = sorted({name for of_engine in by.values() for name in of_engine}, reverse=True)
    figure, [[axes]] = new_figure(1.0 + 0.34 * len(scenes))
    height = 0.8 / len(by)
    with mpl.rc_context(STYLE):
        for place, (engine, of_engine) in enumerate(by.items()):
            offsets = [scenes.index(name) + 0.4 - (place + 0.5) * height for name in of_engine]
            bars = axes.barh(offsets, [100 * share for share in of_engine.values()], height, label=engine,
                             color=ENGINES[engine].colour)  # fmt: skip
            axes.bar_label(bars, fmt="%.0f", padding=3, fontsize=LABEL_POINTS)
        axes.axvline(100, color="black", linewidth=1)
        axes.set(xlabel="cycles per frame with culling, % of those without", xlim=(0, 118))
        axes.set_yticks(np.arange(len(scenes)), scenes)
        figure.legend(loc="outside upper center", ncols=2)
    return figure
