# SPDX-License-Identifier: MIT
"""The report's chapter on shadows: the same scenes with shadow rays in single precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from raycaster.golden.colour import hit_colours
from raycaster.golden.model import Trace
from raycaster.golden.shadows import dim
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.report import plots
from raycaster.report.extent import Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import exact_trace, name_of, scene_of
from raycaster.scene import Light, Scene

EPSILONS = 0.0, 1e-5, 1e-3, 0.1, 1.0
"""World units next to the hit point in which a shadow ray hits nothing."""

COLUMNS = "scene", "epsilon", "lit points", "wrongly dark", "wrongly lit", "wrong"


@dataclass(frozen=True, eq=False)
class Shadows:
    """The points that primary rays hit in a scene with a light, and their shadows.

    Attributes:
        scene: the scene.
        light: its light.
        slopes: slopes of the primary rays, (rows, columns, 3).
        exact: hits and shadows over the rationals.
    """

    scene: Scene
    light: Light
    slopes: np.ndarray
    exact: Trace

    @property
    def lit(self) -> np.ndarray:
        """bool (rays,): the light reaches the hit point."""
        return self.exact.shadings[0].lit

    @cache  # noqa: B019 - shadows live as long as the report
    def lit_in_floats(self, epsilon: float) -> np.ndarray:
        """Decide in single precision which points the light reaches, as a ray tracer in floats does.

        The winner and the side on which the light is are exact, so that only the shadow ray differs.

        Args:
            epsilon: distance from the point, in world units, within which nothing is hit.

        Returns:
            bool (rays,).
        """
        rectangles = Rectangles.of_scene(self.scene)
        low, high, axes = rectangles.low.astype(np.float32), rectangles.high, rectangles.axes
        [winner], slope = self.exact.winners, self.slopes.reshape(-1, 3).astype(np.float32)
        eye, rays = np.array(self.scene.camera.position, np.float32), np.arange(len(slope))
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (low[winner, axes[winner]] - eye[axes[winner]]) / slope[rays, axes[winner]]
            point = eye + slope * t[:, None]
            way = np.array(self.light.position, np.float32) - point
            start = np.float32(epsilon) / np.sqrt((way * way).sum(axis=1))
            dark = np.zeros(len(rays), dtype=bool)
            for index in np.flatnonzero(rectangles.visible):
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
        [winner], [points], [denominators] = self.exact.winners, self.exact.points, self.exact.denominators
        rectangles = Rectangles.of_scene(self.scene)
        colours = hit_colours(rectangles, self.scene.background, winner, points, denominators)
        dim(colours, (winner >= 0) & ~lit, self.light)
        return colours.reshape(self.slopes.shape)


def _shadows(scenes: Sequence[Scene]) -> list[Shadows]:
    """Trace the scenes that have a light."""
    return [Shadows(scene, scene.light, *exact_trace(scene, "vga", 0)) for scene in scenes if scene.light]


def shadow_chapter(what: Extent, sources: Sequence[str]) -> Chapter:
    """Return the chapter on shadows in single precision; it is empty if no scene has a light."""
    lit = [source for source in sources if scene_of(source).light]
    if not lit:
        return Chapter()
    groups = {name_of(source): _shadows([scene_of(source)]) for source in lit}
    worst_name, [worst] = max(groups.items(), key=lambda group: group[1][0].wrong(EPSILONS[0])[0])
    stiff = _shadows([case.scene for case in what.cases])
    groups[f"{len(stiff)} stiff cases"] = stiff
    rows = []
    for name, group in groups.items():
        for epsilon in EPSILONS:
            dark, light = (sum(counts) for counts in zip((0, 0), *(one.wrong(epsilon) for one in group), strict=True))
            rows.append([name, f"{epsilon:g}", sum(int(one.lit.sum()) for one in group), dark, light, dark + light])
    totals = {epsilon: sum(row[-1] for row in rows if row[1] == f"{epsilon:g}") for epsilon in EPSILONS}
    none, most = EPSILONS[0], EPSILONS[-1]
    shown = [("exact", worst.picture(worst.lit))]
    for epsilon in (none, most):
        title = f"floats, epsilon {epsilon:g}: {sum(worst.wrong(epsilon)):,} wrong"
        shown.append((title, worst.picture(worst.lit_in_floats(epsilon))))
    text = (
        "A ray tracer in floats rounds the hit point to either side of its rectangle, whose own shadow may then fall "
        "on it: shadow acne. The usual remedy is an epsilon, a distance from the point within which a shadow ray hits "
        "nothing. One that is too small leaves the acne, and one that is too large removes true shadows. "
        "Cross-multiplication rounds nothing and needs no epsilon. Here the shadow rays of primary rays are computed "
        "in single precision, at 320x240; everything else is exact."
    )
    said = [
        f"Without an epsilon {totals[none]:,} points are in the wrong light; in {worst_name} "
        f"{worst.wrong(none)[0]:,} of {int(worst.lit.sum()):,} lit points are dark.",
        "Points in the wrong light by epsilon, in world units: "
        + "; ".join(f"{totals[epsilon]:,} with {epsilon:g}" for epsilon in EPSILONS[1:])
        + ". The exact engine has none.",
    ]
    data = Data("shadows", COLUMNS, rows)
    caption = f"The primary rays of {worst_name}: exact, and with shadow rays in single precision."
    plot = Plot("shadows", caption, plots.pictures([shown], 1.9), data)
    return Chapter([Section("Shadows without an epsilon", text, said, [plot], [Table.of(data)])])
