# SPDX-License-Identifier: MIT
"""Leaf tests of `intersection_finder`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from unit_vectors import any_config
from vectors import AXES, config_id, ports

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden import seed_engine
from raycaster.golden.engines import model_of
from raycaster.golden.random_world import EXTREMES, random_camera, random_looks, random_rectangles, random_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unconnected, unsigned
from raycaster.rtl.common.interfaces import Slope, Steps
from raycaster.rtl.common.records import Origin, Ray, rect_of
from raycaster.rtl.common.widths import position_bits
from raycaster.rtl.seed.intersection_finder import intersection_finder
from raycaster.verif.expected import sorted_rect, trace_cycles

SLOPES = (0, 1, 2, 99, 100, 160, 190, 255, 256, 510, 511)


# Only the divider's number of steps matters here, so not every F needs every number of bits per cycle.
finders = pytest.mark.parametrize(
    "config",
    [
        any_config(fraction_bits=bits, rounding=rounding, divider_bits=divider_bits)
        for bits, divider_bits in ((0, 1), (0, 3), (1, 2), (4, 3), (8, 2))
        for rounding in ("truncate", "nearest")
    ]
    + [any_config(fraction_bits=bits, materials=bits > 0, patterns=True) for bits in (0, 3)],
    ids=config_id,
)


def finder_leaf(config: Configuration, directory) -> Leaf:
    return Leaf(intersection_finder, lambda: ports(
        "clk hit towards", steps=Steps(), rect=rect_of(config), offered=rect_of(config), ray=Ray(config),
        slope=Slope(), depth=unsigned(position_bits(config)), point=Origin(config),
        odd_u=bit() if config.patterns else unconnected(1), odd_v=bit() if config.patterns else unconnected(1),
        config=config
    ), directory)  # fmt: skip


def ray_inputs(origin, slope) -> dict[str, int]:
    inputs = {f"ray_{axis}": int(value) for axis, value in zip(AXES, origin, strict=True)}
    inputs |= {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
    return inputs | {f"ray_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}


def finder_stimulus(config: Configuration, rays) -> tuple[list[dict[str, int]], list[tuple[int, int, int]]]:
    """Make one pass per ray over its table; return the cycles, and (cycle, ray, rectangle) of each result."""
    stimulus, results = [], []
    for number, (origin, slope, table) in enumerate(rays):
        visible = [int(index) for index in np.flatnonzero(table.visible)]
        for cycle in trace_cycles(config, visible, 0)[1:]:
            inputs = ray_inputs(origin, slope)
            for name in ("find_intersection", "load_divider", "store_quotient"):
                inputs[f"steps_{name}"] = cycle.steps[f"steps_{name}"]
            if cycle.current is not None:
                inputs |= sorted_rect(table, cycle.current, "rect", config)
            if cycle.offered is not None:
                inputs |= sorted_rect(table, cycle.offered, "offered", config)
            if cycle.steps["steps_write_z_buf"]:
                results.append((len(stimulus), number, cycle.offered))
            stimulus.append(inputs)
    return stimulus, results


def traced_rays(config: Configuration, random: np.random.Generator, count: int) -> list:
    """Return rays as the engine meets them: first whole origins, then fractional origins on the mirrors hit."""
    rays = []
    while len(rays) < count:
        table = random_rectangles(random, count=8, closed=True)
        camera, slopes = random_camera(random, table), random_slopes(random, 2)
        trace = model_of(config).trace(table, camera, (0, 0, 0), slopes, 2, keep=True)
        for bounce in trace.bounces:
            for ray in np.flatnonzero(bounce.alive):
                golden = [(bool(bounce.hits[i, ray]), bounce.depths[i, ray], bounce.points[i, ray]) for i in range(8)]
                rays.append((bounce.origins[ray], bounce.slopes[ray], table, golden))
    return rays[:count]


def meet(config: Configuration, origin, slope, axis: int, plane: int) -> tuple[np.ndarray, bool]:
    """Compute where a ray meets a plane on this axis, and whether it does."""
    point, valid = np.zeros(3, dtype=int), True
    point[axis] = plane << config.fraction_bits
    for other in OTHER_AXES[axis]:
        point[other], exists = seed_engine.intersect(
            origin[other], slope[other], point[axis], origin[axis], slope[axis], config.fraction_bits, config.rounding
        )
        valid = valid and bool(exists)
    return point, valid


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
        point, _ = meet(config, origin, slope, axis, low[axis])
        for other in OTHER_AXES[axis]:
            # Bounds at all distances, mostly small ones, so that an error in any bit shows.
            away = random.choice([-1, 1]) * int(random.integers(1 << int(random.integers(9))))
            near = int(np.clip((point[other] >> fraction_bits) + away, 0, limit))
            if random.random() < 0.7:
                low[other], high[other] = random.choice([(near, limit), (0, near), (near, near)])
    table = Rectangles(corners, np.zeros((4, 3), dtype=np.uint8), np.ones(4, dtype=bool))
    golden = []
    for low, high, axis in zip(table.low, table.high, table.axes, strict=True):
        point, valid = meet(config, origin, slope, axis, low[axis])
        inside = np.all((low << fraction_bits <= point) & (point <= high << fraction_bits))
        golden.append((valid and bool(inside), abs(point[0] - origin[0]), point))
    return origin, slope, table, golden


@pytest.mark.slow_sets(
    "seed-vga240-u32-r4-m1-f0n", "seed-vga240-u32-r4-m1-f0t-d3", "seed-vga240-u32-r4-m1-f1", "seed-vga240-u32-r4-m1-f4"
)
@finders
def test_intersection_finder(config, tmp_path, random):
    rays = [
        (origin, slope, random_looks(random, table), golden)
        for origin, slope, table, golden in traced_rays(config, random, 15)
        + [aimed_ray(config, random) for _ in range(180)]
    ]
    stimulus, results = finder_stimulus(config, [ray[:3] for ray in rays])
    outputs = finder_leaf(config, tmp_path).run_both(stimulus, settled=config.divider_steps + 5)
    seen = set()
    for cycle, ray, index in results:
        origin, slope, table, golden = rays[ray]
        hit, depth, point = golden[index]
        output = outputs[cycle]
        case = f"origin {origin}, slope {slope}, corners {table.corners[index].tolist()}: {output}"
        assert output["hit"] == hit, case
        if hit:
            assert output["depth"] == depth, case
            assert [output[f"point_{axis}"] for axis in AXES] == list(point), case
            if config.patterns:
                cell = int(table.cells[index]) << config.fraction_bits
                odd = [int(point[axis]) // cell % 2 for axis in OTHER_AXES[table.axes[index]]]
                assert [output["odd_u"], output["odd_v"]] == odd, case
        seen.add((int(table.axes[index]), hit))
    assert len(seen) == 6, "each axis must be hit and missed"
