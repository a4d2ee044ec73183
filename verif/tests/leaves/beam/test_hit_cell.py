# SPDX-License-Identifier: MIT
"""`hit_cell`: cells of coordinates (E + T) +- D n / e within the world, many at an edge of a cell of their size."""

from fractions import Fraction

import numpy as np
from beam_vectors import beam_config
from vectors import LAST, any_place, designs

from raycaster.hdl.signals import Signed
from raycaster.rtl.beam.hit_cell import hit_cell
from raycaster.rtl.beam.latencies import CELL_LATENCY
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits, shift_bits, steepest_slope


@designs(beam_config(screen="tiny", patterns=True, turn=True, reflections=2))
def test_hit_cell(config, leaf_of, random):
    widths = {"shift": Signed(shift_bits(config)), "slope": Signed(exact_slope_bits(config) + 1)}
    leaf = leaf_of(hit_cell, config, **widths, eye=9, cell_size=3)
    far, steepest = (1 << shift_bits(config) - 1) - 1, steepest_slope(config)
    leaf.case({})
    while leaf.cycle < leaf.some(8000):
        turn, eye, back = int(random.integers(-far, far + 1)), any_place(random), int(random.integers(2))
        cell = int(random.integers(8))
        size = 8 << min(cell, 5)
        goal = size * int(random.integers(512 // size)) + int(random.choice([-1, 0, 0, 1]))
        e = int(random.choice([1, steepest, *random.integers(1, [128, steepest + 1])]))
        way = (goal - eye - turn) * (-1 if back else 1) * e + int(random.integers(-1, 2))
        slope = int(random.choice([1, way, random.integers(1, steepest + 1)])) * (1 if way > 0 else -1) or 1
        slope = int(np.clip(slope, -steepest, steepest))
        n = min(abs(way // slope), (1 << eye_bits(config) - 1) - 1)
        place = eye + turn + Fraction((-1 if back else 1) * slope * n, e)
        if not 0 <= place <= LAST or not n:
            continue
        terms = {"numerator": n, "denominator": e, "cell_size": cell}
        leaf.stimulus[-1] |= {"shift": turn, "eye": eye, "back": back, **terms}
        leaf.expected[leaf.cycle - 1 + CELL_LATENCY - 1] = {"odd": int(place // (8 << cell)) % 2}
        leaf.case({"slope": slope})
    leaf.stimulus += [{}] * CELL_LATENCY
    leaf.check(settled=min(leaf.expected))
