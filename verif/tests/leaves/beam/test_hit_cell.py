# SPDX-License-Identifier: MIT
"""Leaf tests of `hit_cell`: MyHDL and converted Verilog match the expected values on the same vectors."""

from fractions import Fraction

import numpy as np
from beam_vectors import beam_config
from vectors import LAST, any_place, check, designs, leaf_of

from raycaster.engines.beam import CELL_LATENCY
from raycaster.hdl.signals import Signed
from raycaster.rtl.beam.hit_cell import hit_cell
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits, shift_bits, steepest_slope


@designs(beam_config(screen="tiny", patterns=True, turn=True, reflections=2))
def test_hit_cell(config, tmp_path, random):
    """Cells of coordinates (E + T) +- D n / e within the world, many of them at an edge of a cell of their size."""
    slope_bits, numerator_bits, shift_width = exact_slope_bits(config), eye_bits(config) - 1, shift_bits(config)
    widths = {"shift": Signed(shift_width), "eye": 9, "slope": Signed(slope_bits + 1), "cell_size": 3}
    leaf = leaf_of(hit_cell, tmp_path, **widths, numerator=numerator_bits, denominator=slope_bits)
    far, steepest = (1 << shift_width - 1) - 1, steepest_slope(config)
    stimulus, expected = [{}], {}
    while len(stimulus) < 8000:
        turn, eye, back = int(random.integers(-far, far + 1)), any_place(random), int(random.integers(2))
        cell = int(random.integers(8))
        size = 8 << min(cell, 5)
        goal = size * int(random.integers(512 // size)) + int(random.choice([-1, 0, 0, 1]))
        e = int(random.choice([1, steepest, *random.integers(1, [128, steepest + 1])]))
        way = (goal - eye - turn) * (-1 if back else 1) * e + int(random.integers(-1, 2))
        slope = int(random.choice([1, way, random.integers(1, steepest + 1)])) * (1 if way > 0 else -1) or 1
        slope = int(np.clip(slope, -steepest, steepest))
        n = min(abs(way // slope), (1 << numerator_bits) - 1)
        place = eye + turn + Fraction((-1 if back else 1) * slope * n, e)
        if not 0 <= place <= LAST or not n:
            continue
        stimulus[-1] |= {"shift": turn, "eye": eye, "back": back, "numerator": n, "denominator": e, "cell_size": cell}
        expected[len(stimulus) - 1 + CELL_LATENCY - 1] = {"odd": int(place // (8 << cell)) % 2}
        stimulus.append({"slope": slope})
    check(leaf, [*stimulus, *[{}] * CELL_LATENCY], expected, settled=min(expected))
