# SPDX-License-Identifier: MIT
"""Leaf tests of `hit_cells`: MyHDL and converted Verilog match the expected values on the same vectors."""

from fractions import Fraction
from math import gcd

import numpy as np
import pytest
from beam_vectors import beam_config, beam_rays, direction_ports, image_of, seen_from
from vectors import AXES, LAST, any_place, config_id, ports

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.engines.beam import CELL_LATENCY, CELL_SLOPE_AT
from raycaster.golden.world import OTHER_AXES
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.hit_cells import hit_cells
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.records import Point, Sight, candidate_of, turn_of, winner_of
from raycaster.rtl.common.widths import exact_slope_bits, index_bits, steepest_slope


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


@pytest.mark.slow_sets("beam-tiny48-s2-u1-r12-m0", "beam-vga180")
@pytest.mark.parametrize(
    "config",
    [
        beam_config(screen="tiny", patterns=True, reflections=0),
        beam_config(patterns=True, rows=180),
        beam_config(screen="tiny", patterns=True, turn=True, reflections=2),
        beam_config(screen="tiny", patterns=True, reflections=4),
    ],
    ids=config_id,
)
def test_hit_cells(config, tmp_path, random):
    """Points on planes of all axes, many exactly at a cell's edge; without a hit the outputs are don't care."""
    slope_bits, latency = exact_slope_bits(config), CELL_LATENCY
    leaf = Leaf(hit_cells, lambda: ports(
        "clk", turn=turn_of(config), nearest=candidate_of(config), winner=winner_of(config),
        slope=Direction(slope_bits + 1), camera=Point(), sight=Sight(index_bits(config)), config=config
    ), tmp_path)  # fmt: skip
    stimulus, expected = [{} for _ in range(4000)], {}
    cycle = 0
    for table, chosen, camera, ray, mirrors in beam_rays(random, config, 1200):
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
            if not all(0 <= coordinate <= LAST for coordinate in point) or cycle + latency >= len(stimulus):
                continue
            cell, number = int(random.integers(6)), int(random.integers(config.rectangles))
            parities = [int(coordinate // (8 << cell)) % 2 for coordinate in point]
            fields = {"valid": 1, "numerator": n, "denominator": e, "axis": axis, "cell": cell}
            stimulus[cycle] |= {f"nearest_{name}": value for name, value in fields.items()}
            stimulus[cycle] |= {"winner_valid": 1, "winner_index": number}
            image = image_of(config, camera, slope, mirrors)
            stimulus[cycle + 1] |= {f"turn_{name}": value for name, value in image.items()}
            stimulus[cycle + 1] |= {f"camera_{name}": int(value) for name, value in zip(AXES, camera, strict=True)}
            stimulus[cycle + CELL_SLOPE_AT] |= direction_ports("slope", config, slope)
            expected[cycle + latency] = *parities, number
            cycle += 1
    assert len(expected) > 400
    outputs = leaf.run_both(stimulus, settled=1 + latency)
    for cycle, values in expected.items():
        output = outputs[cycle]
        assert output["sight_valid"]
        assert tuple(output[f"sight_{name}"] for name in ("odd_u", "odd_v", "index")) == values, cycle
