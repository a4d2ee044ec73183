# SPDX-License-Identifier: MIT
"""Leaf tests of the seed engine's blocks."""

from fractions import Fraction

import numpy as np
import pytest
from arithmetic_vectors import SLOPE_CORNERS, VECTORS, arithmetic, position_corners
from definition import seed_hit
from engine_vectors import rects_shown, usable_of
from vectors import by, by_axis, designs, slope_inputs, unit_config

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden import seed_engine
from raycaster.golden.engines import model_of
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.signals import Signed, bit, unconnected
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    CELL_BITS,
    MIRROR_BITS,
    RGB_BITS,
    SLOPE_BITS,
    position_bits,
    product_bits,
)
from raycaster.rtl.seed.cell_parity import cell_parity
from raycaster.rtl.seed.divider import divider
from raycaster.rtl.seed.intersection_finder import intersection_finder
from raycaster.rtl.seed.intersection_helper import intersection_helper
from raycaster.rtl.seed.ray_mem import Origin, Ray, ray_mem
from raycaster.rtl.seed.z_buffer import z_buffer
from raycaster.verif.expected import trace_cycles
from raycaster.verif.random_world import EXTREMES, random_camera, random_looks, random_rectangles, random_slopes


@by(fraction_bits=[0, 1, 8])
def test_cell_parity(fraction_bits, leaf_of):
    """All coordinates at the borders of cells and next to them."""
    config = unit_config(fraction_bits=fraction_bits, patterns=True)
    leaf = leaf_of(cell_parity, config, value=Signed(position_bits(config) + 2), size=CELL_BITS)
    one = 1 << fraction_bits
    values = {border * one + beside for border in range(0, WORLD_SIZE, 8) for beside in (-1, 0, 1, one // 2, 7 * one)}
    for value in sorted(value for value in values if value >= 0):
        for size in range(8):
            leaf.case({"value": value, "size": size}, {"odd": value // (one * (8 << size)) % 2})
    leaf.check()


def dividends_and_divisors(config: Configuration, random: np.random.Generator) -> list[tuple[int, int]]:
    """Return corner cases and random operands; quotients sensitive to rounding or overflow are common."""
    limit = 1 << position_bits(config)
    operands = [(n * d, e) for n in position_corners(config) for d in SLOPE_CORNERS for e in SLOPE_CORNERS if n < limit]
    chosen = [operands[index] for index in random.permutation(len(operands))[: VECTORS // 2]]
    for _ in range(VECTORS):
        divisor = int(random.integers(1, 1 << SLOPE_BITS))
        quotient = int(random.choice([0, 1, limit - 2, limit - 1, limit, random.integers(limit)]))
        remainder = int(random.choice([0, divisor // 2, (divisor + 1) // 2, divisor - 1]))
        chosen.append((min(quotient * divisor + remainder, (1 << product_bits(config)) - 1), divisor))
    return chosen


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_divider(config, leaf_of, random):
    """Divisions back to back: each load comes with the store of the previous division."""
    widths = {"dividend": product_bits(config), "divisor": SLOPE_BITS, "quotient": position_bits(config)}
    leaf, steps = leaf_of(divider, config, **widths), config.divider_steps
    for dividend, divisor in dividends_and_divisors(config, random):
        load = {"load_divider": 1, "store_quotient": bool(leaf.stimulus), "dividend": dividend, "divisor": divisor}
        leaf.stimulus += [load, *[dict.fromkeys(load, 0)] * (steps - 1)]
        quotient, overflow = seed_engine.divide(dividend, divisor, config.fraction_bits, config.rounding)
        leaf.expected[leaf.cycle + 1] = {"overflow": overflow, "quotient": None if overflow else quotient}
    leaf.stimulus += [{"load_divider": 0, "store_quotient": 1}, {"store_quotient": 0}]
    leaf.check(settled=steps + 1)


POWERS = tuple(1 << place for place in range(SLOPE_BITS))


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_intersection_helper(config, leaf_of, random):
    """Corner cases, random operands, products with every bit visible, and powers of two."""
    width = position_bits(config)
    widths = dict.fromkeys(("a", "c", "d", "quotient", "distance"), width) | dict.fromkeys("be", SLOPE_BITS)
    leaf = leaf_of(intersection_helper, config, **widths, value=Signed(width + 2))
    corners = position_corners(config)

    def position() -> int:
        return int(random.choice(corners) if random.random() < 0.4 else random.integers(1 << width))

    def slope() -> int:
        corner = random.choice([*SLOPE_CORNERS, *POWERS])
        magnitude = corner if random.random() < 0.4 else random.integers(1 << SLOPE_BITS)
        return int(magnitude * random.choice([-1, 1]))

    operands = [(position(), slope(), position(), position(), slope()) for _ in range(VECTORS)]
    for number in range(VECTORS):
        # Products with every bit visible in the quotient, and distances with a single bit set.
        c, b, e = position(), int(random.choice([1, 2, 3, 5])), int(random.choice(POWERS))
        distance = int(random.choice([1 << random.integers(width), random.integers(1, 100)]))
        if number % 2:
            b = e = int(random.integers(1 << SLOPE_BITS)) | 1
            distance = int(random.integers(1 << width)) | 1
        d = c - distance if c >= distance else min(c + distance, (1 << width) - 1)
        operands.append((position(), b * int(random.choice([-1, 1])), c, d, e * int(random.choice([-1, 1]))))
    steps, valid_seen = config.divider_steps, 0
    idle = dict.fromkeys(("steps_find_intersection", "steps_load_divider", "steps_store_quotient"), 0)
    leaf.stimulus = [dict(idle) for _ in range((len(operands) + 2) * steps + 6)]
    for number, (a, b, c, d, e) in enumerate(operands):
        start = number * steps
        leaf.stimulus[start] |= {"steps_find_intersection": 1, "b": abs(b), "b_negative": b < 0}
        leaf.stimulus[start] |= {"c": c, "d": d, "e": abs(e), "e_negative": e < 0}
        leaf.stimulus[start + 2]["steps_load_divider"] = 1
        stored = start + 3 + steps
        leaf.stimulus[stored - 1]["steps_store_quotient"] = 1
        leaf.stimulus[stored]["a"] = a
        value, valid = seed_engine.intersect(a, b, c, d, e, config.fraction_bits, config.rounding)
        leaf.expected[start + 1]["towards"] = (c - d) * e > 0
        leaf.expected[stored]["valid"] = valid
        if valid:
            valid_seen += 1
            leaf.expected[stored] |= {"quotient": abs(int(value) - a), "distance": abs(c - d)}
            leaf.expected[stored + 1]["value"] = value
    outputs = leaf.check(settled=steps + 4)
    assert outputs[1]["towards"] == leaf.expected[1]["towards"]
    assert valid_seen > VECTORS // 10


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
    """Rays as the engine meets them, and rays that meet planes at or near a rectangle's bounds."""
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


@pytest.mark.parametrize(
    "config", [unit_config(fraction_bits=bits) for bits in (0, 3, 8)], ids=lambda config: f"F{config.fraction_bits}"
)
def test_ray_mem(config, leaf_of, random):
    """The hit point, and the ray's signs with one reversed; kept until the next step."""
    rays = dict.fromkeys(("ray", "reflected"), lambda: Ray(config))
    leaf = leaf_of(ray_mem, config, **rays, found_axis=AXIS_BITS, found_point=lambda: Origin(config))
    values = [*EXTREMES, (1 << position_bits(config)) - 1]
    reflected = None
    for number in range(300):
        store, found = int(number == 0 or random.random() < 0.7), number % 3
        point = [int(random.choice(values)) for _ in range(3)]
        signs = [int(random.integers(2)) for _ in range(3)]
        ray = by_axis("ray_d", signs) | by_axis("ray_", [int(random.choice(values)) for _ in range(3)])
        leaf.case({"steps_store_ray": store, "found_axis": found, **by_axis("found_point_", point), **ray}, reflected)
        if store:
            turned = [sign ^ (axis == found) for axis, sign in enumerate(signs)]
            reflected = by_axis("reflected_", point) | by_axis("reflected_d", turned)
    leaf.check(settled=1)


@designs(
    unit_config(),
    unit_config(fraction_bits=8),
    unit_config(materials=True),
    unit_config(fraction_bits=3, patterns=True),
)
def test_z_buffer(config, leaf_of, random):
    """The nearest hit since the last reset, of equal ones the first."""
    points = dict.fromkeys(("point", "found_point"), lambda: Origin(config))
    mirror = MIRROR_BITS if config.materials else lambda: unconnected(MIRROR_BITS)
    found = {"found_axis": AXIS_BITS, "found_mirror": mirror}
    leaf = leaf_of(z_buffer, config, **points, **found, colour=RGB_BITS, depth=position_bits(config))
    limit = (1 << position_bits(config)) - 1
    leaf.case({"steps_reset_z_buf": 1})
    kept, nearest = {}, None
    for number in range(1500):
        # Few depths, so that many tie; the first hit makes all registers known.
        depth = int(random.choice([0, 1, 255, 256, limit - 1, limit, random.integers(limit)]))
        write, reset = number == 0 or random.random() < 0.7, number > 0 and random.random() < 0.15
        hit, axis = number == 0 or random.random() < 0.7, int(random.integers(3))
        colour, mirror = int(random.integers(1 << RGB_BITS)), int(random.integers(5)) if config.materials else 0
        point = [int(random.integers(limit + 1)) for _ in range(3)]
        offered = {"offered_axis": axis, "offered_mirror": mirror, "colour": colour, **by_axis("point_", point)}
        steps = {"steps_reset_z_buf": reset, "steps_write_z_buf": write}
        leaf.case({**steps, **offered, "hit": hit, "depth": depth}, {"found": nearest is not None})
        leaf.expect(kept, when=nearest is not None)
        if reset:
            nearest = None
        elif write and hit and (nearest is None or depth < nearest):
            nearest, kept = depth, {"found_axis": axis, "found_colour": colour} | by_axis("found_point_", point)
            kept |= {"found_mirror": mirror} if config.materials else {}
    leaf.check(settled=2, spare=True)
