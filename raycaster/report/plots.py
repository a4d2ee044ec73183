# SPDX-License-Identifier: MIT
"""Plots of the report, narrow enough for a phone, in colours that colour-blind readers can distinguish."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
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
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from raycaster.configuration import Rounding
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import count_wrong, diff_picture
from raycaster.golden.seed_engine import SeedModel
from raycaster.report.points import Point, name_of
from raycaster.rtl.engines import EXACT, SEED
from raycaster.screens import SCREENS

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

WIDTH = 4.6
"""Width in inches, a column of a printed page; 9-point text stays legible on a phone, at three quarters of the size."""

STYLE: dict[RcKeyType, Any] = {
    "font.size": 9, "axes.titlesize": 9, "legend.fontsize": 8, "axes.grid": True, "grid.alpha": 0.3,
    "axes.axisbelow": True, "svg.hashsalt": "raycaster", "svg.fonttype": "none",
}  # fmt: skip
styled = mpl.rc_context(STYLE)
"""Decorator of functions that draw, so that they draw in the report's style."""

LABEL_POINTS = 7.5

VERMILION, BLUE, ORANGE, GREY = SEED.facts.colour, EXACT.facts.colour, "#E69F00", "#7f7f7f"
"""Colours of Okabe and Ito, like the engines' colours, and a grey."""

COLOURS = {"truncate": VERMILION, "nearest": BLUE}

LEAST_SHARE = 1e-5
"""Lower limit for drawing a picture's share of wrong pixels: below one pixel, so smaller shares are drawn as 0."""


def new_figure(height: float, rows: int = 1, columns: int = 1, **options) -> tuple[Figure, np.ndarray]:
    """Create an empty figure of a height in inches, and its axes (rows, columns)."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    FigureCanvasAgg(figure)  # provides the sizes of texts
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


@styled
def save(figure: Figure, path: Path, **metadata: str) -> None:
    """Write a reproducible SVG, without a date; metadata such as Title is as for matplotlib's `savefig`."""
    figure.savefig(path, metadata={"Date": None, **metadata})


def _legend(figure: Figure, columns: int = 2, **options) -> None:
    figure.legend(loc="outside upper center", ncols=columns, **options)


def _percent(axes: Axes, none: float) -> None:
    """Make the y axis logarithmic, in per cent, with 0 as the label of shares up to `none`."""
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda share, _: "0" if share <= none else f"{100 * share:g}%"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(bottom=none / 2)


def ticks(axis: Axis, form: Callable[[float], str] = "{:,.0f}".format) -> None:
    """Label a logarithmic axis at 1, 2, 5, 10 and so on."""
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: form(value)))
    axis.set_minor_formatter(NullFormatter())


def label(
    axes: Axes, labels: Iterable[tuple[float, float, str]], xs: Sequence[float], ys: Sequence[float], **options
) -> None:
    """Write labels next to marks, away from each other and from all marks; the axes must have their final limits."""
    axes.get_figure(root=True).draw_without_rendering()  # pyright: ignore[reportOptionalMemberAccess]
    texts = [axes.text(*label, fontsize=LABEL_POINTS, zorder=4) for label in labels]
    adjust_text(texts, x=xs, y=ys, ax=axes, arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.5}, **options)


# Errors ---------------------------------------------------------------------------------------------------------------


@styled
def shares(by: Mapping[Rounding, Mapping[int, Sequence[float]]]) -> Figure:
    """Plot the distribution of the share of wrong pixels, by rounding and fraction bits."""
    figure, [[axes]] = new_figure(3.6)
    for side, (rounding, of) in zip((-0.2, 0.2), by.items(), strict=True):
        colour = COLOURS[rounding]
        axes.boxplot(
            [[max(share, LEAST_SHARE) for share in values] for values in of.values()],
            positions=[place + side for place in range(len(of))], widths=0.32, whis=(0, 100), showmeans=True,
            patch_artist=True, boxprops={"facecolor": colour, "alpha": 0.35, "edgecolor": colour},
            medianprops={"color": "black"}, whiskerprops={"color": colour}, capprops={"color": colour},
            meanprops={"marker": "o", "markersize": 3.5, "markerfacecolor": colour, "markeredgecolor": colour},
            label=rounding,
        )  # fmt: skip
    axes.set_xticks(range(len(of)), list(of))
    axes.set(xlabel="fraction bits F", ylabel="wrong pixels per picture")
    _percent(axes, LEAST_SHARE)
    _legend(figure)
    return figure


@styled
def by_depth(by: Mapping[str, Mapping[str, Sequence[float]]], lines: Mapping[str, Mapping[str, str]]) -> Figure:
    """Plot errors of hit points by reflections so far: a panel per rounding, with lines in these styles."""
    figure, [panels] = new_figure(3.4, 1, len(by), sharey=True)
    for axes, (name, of) in zip(panels, by.items(), strict=True):
        for kind, style in lines.items():
            label = kind if axes is panels[0] else None
            axes.plot([max(value, 1e-3) for value in of[kind]], markersize=4, label=label, **style)
        axes.set(title=name, yscale="log", xticks=range(len(of[kind])), xlabel="reflections so far")
    panels[0].set_ylabel("hit point error, world units")
    _legend(figure)
    return figure


# Pictures -------------------------------------------------------------------------------------------------------------


@styled
def wrong_by_scene(points: Sequence[Point]) -> Figure:
    """Show the wrong pixels of each point, a picture of the seed engine, three in a row."""
    shown = []
    for point in points:
        models = SeedModel(point.config.fraction_bits, point.config.rounding), ExactModel()
        drawn, right = (one.render(point.scene, SCREENS["vga", 240], point.config.most_reflections) for one in models)
        share = count_wrong(drawn, right) / right[..., 0].size
        name = fill(name_of(point.what).replace("_", " "), 20)  # no wider than the picture
        shown.append((f"{name}: {share:.2%}", diff_picture(drawn, right)))
    rows = -(-len(shown) // 3)
    figure, panels = new_figure(1.45 * rows, rows, 3)
    for axes in panels.flat:
        axes.axis("off")
    for axes, (title, picture) in zip(panels.flat, shown, strict=False):
        axes.imshow(picture)
        axes.set_title(title, fontsize=LABEL_POINTS)
    return figure


# Stability ------------------------------------------------------------------------------------------------------------


@styled
def stiffness(cases: Mapping[str, tuple[float, float, float]], labelled: Sequence[str]) -> Figure:
    """Plot worst error and greatest bound against condition number, for each case."""
    figure, [[axes]] = new_figure(3.8)
    conditions, errors, bounds = np.array(list(cases.values())).T
    axes.vlines(conditions, errors, bounds, color=GREY, linewidth=0.5, alpha=0.6)
    axes.scatter(conditions, bounds, marker="_", color=GREY, s=30, label="greatest bound")
    axes.scatter(conditions, errors, marker="o", color=BLUE, s=14, label="worst error", zorder=3)
    axes.set(xscale="log", yscale="log", xlabel="relative condition number", ylabel="world units")
    axes.margins(0.2, 0.1)
    _legend(figure)
    labels = [(*cases[name][:2], name) for name in labelled]
    label(axes, labels, conditions, errors, expand=(1.3, 1.8), force_text=(0.6, 1.2))
    return figure
