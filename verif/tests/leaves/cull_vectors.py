# SPDX-License-Identifier: MIT
"""Scenes for leaf tests of culling."""

from collections.abc import Sequence

import numpy as np
from vectors import AXES, any_config, any_place, designs

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.verif.random_world import random_camera, random_rectangles


def culling_config(**options) -> Configuration:
    """Make a design that culls."""
    return any_config(culling=True, **options)


def hit_mask(config: Configuration, table: Rectangles, camera, row: int, offset: int) -> int:
    """Return a mask of the rectangles that the group's primary rays hit in the golden model."""
    slopes = primary_slopes(config.screen_geometry)[row, offset * config.units : (offset + 1) * config.units]
    traced = model_of(config).trace(table, camera, (0, 0, 0), slopes, 0, keep=True)
    return sum(int(hit) << index for index, hit in enumerate(traced.bounces[0].hits.any(axis=1)))


def scenes(random: np.random.Generator, config: Configuration):
    """Yield a camera and a table; all rectangles are enabled and have a plane."""
    while True:
        table = random_rectangles(random, config.rectangles, closed=None if config.rectangles >= 7 else False)
        camera = np.asarray(random_camera(random, table))
        if random.random() < 0.3:
            camera = np.array([any_place(random) for _ in AXES])
        corners = table.corners.copy()
        corners[~table.visible, 1, 0] = corners[~table.visible, 0, 0]
        yield camera, Rectangles(corners, table.colours, np.ones(len(table), dtype=bool))


def with_edges_on_rays(
    random: np.random.Generator, config: Configuration, table: Rectangles, camera, places: Sequence[tuple[int, int]]
) -> Rectangles:
    """Move an edge of many rectangles to, or next to, where an end ray of one of the groups meets their plane.

    places: groups, each as a row and the group's number in the row.
    """
    slopes = primary_slopes(config.screen_geometry)
    corners = table.corners.copy()
    for index in range(len(table)):
        axis = int(table.axes[index])
        row, offset = places[int(random.integers(len(places)))]
        first = [int(d) for d in slopes[row, offset * config.units]]
        end = [first[0], first[1] + int(random.choice([0, config.units - 1, config.units])), first[2]]
        if random.random() < 0.6 and end[axis]:
            u, v = (int(other) for other in random.permutation(OTHER_AXES[axis]))
            met = camera[u] + end[u] * (corners[index, 0, axis] - camera[axis]) // end[axis]
            if random.random() < 0.7:
                # Let this edge alone decide.
                corners[index, :, v] = 0, WORLD_SIZE - 1
            corners[index, random.integers(2), u] = np.clip(met + random.integers(-2, 3), 0, WORLD_SIZE - 1)
    return Rectangles(corners, table.colours, table.enabled)


culling_designs = designs(
    culling_config(),
    culling_config(units=20, rectangles=4, fraction_bits=4, rounding="nearest", rows=200),
    culling_config(units=1, rectangles=3),
    culling_config(units=320, rectangles=2),
    culling_config(screen="tiny", units=16, rectangles=32, divider_bits=3),
    culling_config(engine="exact"),
    culling_config(engine="exact", units=64, rectangles=1),
    culling_config(engine="exact", screen="tiny", units=2, rectangles=9),
)
