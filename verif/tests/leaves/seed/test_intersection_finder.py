# SPDX-License-Identifier: MIT
"""`intersection_finder`: rays as the engine meets them, and rays that meet planes at or near a rectangle's bounds."""

from fractions import Fraction

import numpy as np
from definition import seed_hit
from engine_vectors import rects_shown, usable_of
from vectors import by_axis, designs, slope_inputs, unit_config

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden import seed_engine
from raycaster.golden.engines import model_of
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.signals import bit, unconnected
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.records import Origin, Ray
from raycaster.rtl.common.widths import position_bits
from raycaster.rtl.seed.intersection_finder import intersection_finder
from raycaster.verif.expected import trace_cycles
from raycaster.verif.random_world import EXTREMES, random_camera, random_looks, random_rectangles, random_slopes

SLOPES = (0, 1, 2, 99, 100, 160, 190, 255, 256, 510, 511)


def traced_rays(config: Configuration, random: np.random.Generator, count: int) -> list:
    """Return rays as the engine meets them: first whole origins, then fractional origins on the mirrors hit."""
    rays = []
    while len(rays) < count:
        table = random_rectangles(random, count=8, closed=True)
        camera, slopes = random_camera(random, table), random_slopes(random, 2)
        trace = model_of(config).trace(table, camera, (0, 0, 0), slopes, 2, keep=True)
        for bounce in trace.bounces:
            for ray in np.flatnonzero(bounce.alive):
                rays.append((bounce.origins[ray], bounce.slopes[ray], table))
    return rays[:count]


def aimed_ray(config: Configuration, random: np.random.Generator) -> tuple:
    """Return a random ray, and rectangles whose bounds are at or near the point where the ray meets their plane."""
    fraction_bits, limit = config.fraction_bits, WORLD_SIZE - 1
    origin = np.where(
        random.random(3) < 0.4,
        random.choice(EXTREMES, 3) << fraction_bits,
        random.integers(WORLD_SIZE << fraction_bits, size=3),
    )
    slope = random.choice(SLOPES, 3) * random.choice([-1, 1], 3)
    corners = np.zeros((4, 2, 3), dtype=int)
    for low, high in corners:
        axis = int(random.integers(3))
        high[:] = limit
        low[axis] = high[axis] = random.choice([*EXTREMES, random.integers(limit), origin[axis] >> fraction_bits])
        for other in OTHER_AXES[axis]:
            met, _ = seed_engine.intersect(
                origin[other], slope[other], low[axis] << fraction_bits, origin[axis], slope[axis], fraction_bits,
                config.rounding,
            )  # fmt: skip
            # Bounds at all distances, mostly small ones, so that an error in any bit shows.
            away = random.choice([-1, 1]) * int(random.integers(1 << int(random.integers(9))))
            near = int(np.clip((int(met) >> fraction_bits) + away, 0, limit))
            if random.random() < 0.7:
                low[other], high[other] = random.choice([(near, limit), (0, near), (near, near)])
    return origin, slope, Rectangles(corners, np.zeros((4, 3), dtype=np.uint8), np.ones(4, dtype=bool))


# Only the divider's number of steps matters here, so not every F needs every number of bits per cycle.
@designs(
    *(
        unit_config(fraction_bits=bits, rounding=rounding, divider_bits=divider_bits)
        for bits, divider_bits in ((0, 1), (0, 3), (1, 2), (4, 3), (8, 2))
        for rounding in ("truncate", "nearest")
    ),
    *(unit_config(fraction_bits=bits, materials=bits > 0, patterns=True) for bits in (0, 3)),
    slow=[f"seed-vga240-u32-r4-m1-{name}" for name in ("f0n", "f0t-d3", "f1", "f4")],
)
def test_intersection_finder(config, leaf_of, random):
    odd = dict.fromkeys(("odd_u", "odd_v"), bit if config.patterns else lambda: unconnected(1))
    ports = {"ray": lambda: Ray(config), "point": lambda: Origin(config), "depth": position_bits(config)}
    leaf = leaf_of(intersection_finder, config, **ports, **odd, slope=Slope)
    hit, one = seed_hit(config.fraction_bits, config.rounding), 1 << config.fraction_bits
    seen = set()
    for origin, slope, plain in traced_rays(config, random, 15) + [aimed_ray(config, random) for _ in range(180)]:
        table, start = random_looks(random, plain), [Fraction(int(place), one) for place in origin]
        for cycle in trace_cycles(config, usable_of(table), 0)[1:]:
            inputs = by_axis("ray_", origin) | slope_inputs(slope, "ray") | rects_shown(random, config, cycle, table)
            leaf.case(inputs | {name: value for name, value in cycle.steps.items() if name in leaf.given})
            if cycle.steps["steps_write_z_buf"]:
                found = hit(table, cycle.offered, start, slope.tolist(), None)
                wanted = {"hit": found is not None}
                if found is not None:
                    depth, point = found
                    wanted |= {"depth": depth * one} | by_axis("point_", (place * one for place in point))
                    if config.patterns:
                        u, v = OTHER_AXES[table.axes[cycle.offered]]
                        cell = int(table.cells[cycle.offered])
                        wanted |= {"odd_u": point[u] // cell % 2, "odd_v": point[v] // cell % 2}
                leaf.expect(wanted)
                seen.add((int(table.axes[cycle.offered]), found is not None))
    leaf.check(settled=config.divider_steps + 5)
    assert len(seen) == 6, "each axis must be hit and missed"
