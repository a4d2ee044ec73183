# SPDX-License-Identifier: MIT
"""`hit_cells`: points on planes of all axes, many exactly at a cell's edge; without a hit, outputs are don't care."""

from fractions import Fraction
from math import gcd

import numpy as np
from beam_vectors import beam_config, beam_rays, image_of, seen_from
from vectors import LAST, any_place, by_axis, designs, named

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.world import OTHER_AXES
from raycaster.rtl.beam.hit_cells import hit_cells
from raycaster.rtl.beam.latencies import CELL_LATENCY, CELL_SLOPE_AT
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.records import Point, Sight
from raycaster.rtl.common.widths import exact_slope_bits, steepest_slope


def to_edge(random: np.random.Generator, config: Configuration, axis: int, plane: int, eye, turned, slope):
    """Return a slope with which the ray meets a plane at a cell's edge, or as close to it as the fraction allows.

    The dividend is then a cell's edge times the divisor, plus -1, 0 or 1: (edge - E) e + more = D n.
    """
    found, steepest = np.array(slope), steepest_slope(config)
    n, sign = abs(int(plane - eye[axis])), 1 if plane > eye[axis] else -1
    u = int(random.choice(OTHER_AXES[axis]))
    way, more = 8 * int(random.integers(64)) - int(eye[u]), int(random.integers(-1, 2))
    if n == 0 or gcd(way, n) > 1:
        return found
    # The least divisor plus any multiple of the distance; without a turn, the slope along x is fixed.
    least = -more * pow(way, -1, n) % n
    most = min(steepest, (steepest * n - 1) // max(abs(way), 1))
    if most < least or (not config.turn and 0 in (axis, u)):
        return found
    e = least + n * int(random.integers((most - least) // n + 1))
    if e > 0:
        # Undo the mirrors, which have reversed the components that differ.
        found[axis] = sign * e * (-1 if turned[axis] != slope[axis] else 1)
        found[u] = (way * e + more) // n * (-1 if turned[u] != slope[u] else 1)
    return found


@designs(
    beam_config(screen="tiny", patterns=True, reflections=0),
    beam_config(patterns=True, rows=180),
    beam_config(screen="tiny", patterns=True, turn=True, reflections=2),
    beam_config(screen="tiny", patterns=True, reflections=4),
    slow=["beam-tiny48-s2-u1-r12-m0", "beam-vga180"],
)
def test_hit_cells(config, leaf_of, random):
    slopes = {"slope": lambda: Vector(exact_slope_bits(config) + 1)}
    leaf = leaf_of(hit_cells, config, **slopes, camera=Point, sight=lambda: Sight(config))
    leaf.stimulus, cycle = [{} for _ in range(leaf.some(4000))], 0
    for table, chosen, camera, ray, mirrors in beam_rays(random, config, leaf.some(1200)):
        for index in 8 * list(chosen):
            axis, plane, slope = int(table.axes[index]), any_place(random), ray
            eye, turned = seen_from(camera, slope, mirrors)
            u, v = OTHER_AXES[axis]
            if random.random() < 0.5:
                slope = to_edge(random, config, axis, plane, eye, turned, slope)
                eye, turned = seen_from(camera, slope, mirrors)
            elif turned[u] and random.random() < 0.5:
                t = Fraction(8 * int(random.integers(64)) - int(eye[u]), int(turned[u]))
                plane = int(eye[axis] + int(turned[axis]) * t) if turned[axis] else plane
            n, e = (plane - int(eye[axis])) * int(np.sign(turned[axis])), abs(int(turned[axis]))
            if n <= 0 or not 0 <= plane < WORLD_SIZE:
                continue
            point = [Fraction(int(eye[c]) * e + int(turned[c]) * n, e) for c in (u, v)]
            if not all(0 <= coordinate <= LAST for coordinate in point) or cycle + CELL_LATENCY >= leaf.cycle:
                continue
            cell, number = int(random.integers(6)), int(random.integers(config.rectangles))
            fields = {"valid": 1, "numerator": n, "denominator": e, "axis": axis, "cell": cell}
            leaf.stimulus[cycle] |= named("nearest", fields) | {"winner_valid": 1, "winner_index": number}
            leaf.stimulus[cycle + 1] |= named("image", image_of(camera, slope, mirrors)) | by_axis("camera_", camera)
            leaf.stimulus[cycle + CELL_SLOPE_AT] |= by_axis("slope_", slope)
            odd_u, odd_v = (int(coordinate // (8 << cell)) % 2 for coordinate in point)
            sight = {"valid": 1, "odd_u": odd_u, "odd_v": odd_v, "index": number}
            leaf.expected[cycle + CELL_LATENCY] = named("sight", sight)
            cycle += 1
    assert len(leaf.expected) > leaf.some(400)
    leaf.check(settled=1 + CELL_LATENCY)
