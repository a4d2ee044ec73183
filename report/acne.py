# SPDX-License-Identifier: MIT
"""The report's chapter on shadows: the same scenes with shadow rays in single precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from raycaster.golden.colour import hit_colours
from raycaster.golden.model import Trace
from raycaster.golden.shadows import dim
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.report import plots
from raycaster.report.extent import Extent
from raycaster.report.page import Plot, Section, Table, write_csv
from raycaster.report.points import CASE, View, exact_trace
from raycaster.scene import Light

EPSILONS = 0.0, 1e-5, 1e-3, 0.1, 1.0
"""World units next to the hit point in which a shadow ray hits nothing."""

COLUMNS = "scene", "epsilon", "lit points", "wrongly dark", "wrongly lit", "wrong"


@dataclass(frozen=True)
class Shadows:
    """The points that primary rays hit in a scene with a light, and their shadows.

    Args:
        view: the scene.
        light: its light.
    """

    view: View
    light: Light

    @cached_property
    def _traced(self) -> tuple[np.ndarray, Trace]:
        return exact_trace(self.view.scene, "vga", 0)  # pyright: ignore[reportArgumentType]

    @cached_property
    def rectangles(self) -> Rectangles:
        """The scene's table."""
        return Rectangles.of_scene(self.view.scene)

    @property
    def exact(self) -> Trace:
        """Hits and shadows over the rationals."""
        return self._traced[1]

    @property
    def lit(self) -> np.ndarray:
        """bool (rays,): the light reaches the hit point."""
        return self.exact.shadings[0].lit

    def lit_in_floats(self, epsilon: float) -> np.ndarray:
        """Decide in single precision which points the light reaches, as a ray tracer in floats does.

        The winner and the side on which the light is are exact, so that only the shadow ray differs.

        Args:
            epsilon: distance from the point, in world units, within which nothing is hit.

        Returns:
            bool (rays,).
        """
        position, slopes = self.view.scene.camera.position, self._traced[0].reshape(-1, 3)
        [winner], rays = self.exact.winners, np.arange(len(slopes))
        low, high, axes = self.rectangles.low.astype(np.float32), self.rectangles.high, self.rectangles.axes
        eye, slope = np.array(position, np.float32), slopes.astype(np.float32)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (low[winner, axes[winner]] - eye[axes[winner]]) / slope[rays, axes[winner]]
            point = eye + slope * t[:, None]
            way = np.array(self.light.position, np.float32) - point
            start = np.float32(epsilon) / np.sqrt((way * way).sum(axis=1))
            dark = np.zeros(len(rays), dtype=bool)
            for index in np.flatnonzero(self.rectangles.visible):
                axis = axes[index]
                s = (low[index, axis] - point[:, axis]) / way[:, axis]
                hit = (start < s) & (s < 1)
                for u in OTHER_AXES[axis]:
                    place = point[:, u] + way[:, u] * s
                    hit &= (low[index, u] <= place) & (place <= high[index, u])
                dark |= hit
        return self.exact.shadings[0].facing & ~dark

    def wrong(self, epsilon: float) -> tuple[int, int]:
        """Count the points that are dark, and those that are lit, in single precision alone."""
        lit = self.lit_in_floats(epsilon)
        return int((self.lit & ~lit).sum()), int((lit & ~self.lit).sum())

    def picture(self, lit: np.ndarray) -> np.ndarray:
        """Draw the scene with primary rays alone, lit at these points: uint8 (rows, columns, 3)."""
        exact, background = self.exact, self.view.scene.background
        [winner], [points], [denominators] = exact.winners, exact.points, exact.denominators
        colours = hit_colours(self.rectangles, background, winner, points, denominators)
        dim(colours, (winner >= 0) & ~lit, self.light)
        return colours.reshape(self._traced[0].shape)


def shadow_sections(what: Extent, scenes: Sequence[View], directory: Path) -> list[Section]:
    """Return the section on shadows in single precision; none if no scene has a light."""
    found = [Shadows(view, light) for view in scenes if (light := view.scene.light)]
    if not found:
        return []
    stiff = [Shadows(View.of(f"{CASE}{case.name}"), case.scene.light) for case in what.cases if case.scene.light]
    groups = {one.view.name: [one] for one in found} | {f"{len(stiff)} stiff cases": stiff}
    counts = {
        (name, epsilon): np.sum([one.wrong(epsilon) for one in group], axis=0)
        for name, group in groups.items()
        for epsilon in EPSILONS
    }
    rows = [
        [name, f"{epsilon:g}", sum(int(one.lit.sum()) for one in groups[name]), int(dark), int(lit), int(dark + lit)]
        for (name, epsilon), (dark, lit) in counts.items()
    ]
    write_csv(COLUMNS, rows, directory / "shadows.csv")
    totals = {epsilon: sum(row[-1] for row in rows if row[1] == f"{epsilon:g}") for epsilon in EPSILONS}
    none, most = EPSILONS[0], EPSILONS[-1]
    worst = max(found, key=lambda one: one.wrong(none)[0])
    shown = [("exact", worst.picture(worst.lit))]
    for epsilon in (none, most):
        title = f"floats, epsilon {epsilon:g}: {sum(worst.wrong(epsilon)):,} wrong"
        shown.append((title, worst.picture(worst.lit_in_floats(epsilon))))
    plots.save(plots.pictures([shown], 1.9), directory / "shadows.svg")
    text = (
        "A ray tracer in floats rounds the hit point to either side of its rectangle, whose own shadow may then fall "
        "on it: shadow acne. The usual remedy is an epsilon, a distance from the point within which a shadow ray hits "
        "nothing. One that is too small leaves the acne, and one that is too large removes true shadows. "
        "Cross-multiplication rounds nothing and needs no epsilon. Here the shadow rays of primary rays are computed "
        "in single precision, at 320x240; everything else is exact."
    )
    said = [
        f"Without an epsilon {totals[none]:,} points are in the wrong light; in {worst.view.name} "
        f"{worst.wrong(none)[0]:,} of {int(worst.lit.sum()):,} lit points are dark.",
        "Points in the wrong light by epsilon, in world units: "
        + "; ".join(f"{totals[epsilon]:,} with {epsilon:g}" for epsilon in EPSILONS[1:])
        + ". The exact engine has none.",
    ]
    plot = Plot("shadows", f"The primary rays of {worst.view.name}: exact, and with shadow rays in single precision.")
    return [Section("Shadows without an epsilon", text, said, [plot], [Table("shadows", COLUMNS, rows)])]
