# SPDX-License-Identifier: MIT
"""Leaf tests of `cell_finder`: MyHDL and converted Verilog match the expected values on the same vectors."""

from fractions import Fraction
from math import gcd

from exact_vectors import by_reflections, by_turn, exact_config, slope_inputs, two_complement
from vectors import LAST, ports

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.world import OTHER_AXES
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Eye, Slope, Steps
from raycaster.rtl.common.records import Signs, surface_of
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.cell_finder import cell_finder


@by_turn
@by_reflections
def test_cell_finder(reflections, turn, tmp_path, random):
    """Cells of points, computed with fractions: cells of every size, and points on cell borders."""
    config = exact_config(reflections=reflections, turn=turn, patterns=True)
    leaf = Leaf(cell_finder, lambda: ports(
        "clk odd_u odd_v", steps=Steps(), eye=Eye(eye_bits(config)), signs=Signs(),
        slope=Slope(exact_slope_bits(config)), found_surface=surface_of(config),
        found_distance=unsigned(eye_bits(config) - 1), found_slope=unsigned(exact_slope_bits(config))
    ), tmp_path)  # fmt: skip
    stimulus, expected, borders = [], [], 0
    far, steepest = LAST * (reflections + 1), (1 << exact_slope_bits(config)) - 1
    while len(expected) < 300:
        axis, size = int(random.integers(3)), int(random.integers(8))
        n = int(random.choice([1, 8, far, random.integers(1, far + 1)]))
        e = int(random.choice([1, 2, min(n, steepest), steepest, random.integers(1, steepest + 1)]))
        eye, slope = random.integers(WORLD_SIZE, size=3), random.integers(-steepest, steepest + 1, 3)
        for q in OTHER_AXES[axis]:
            # A whole coordinate, at a cell border or elsewhere, and slopes that hit it or miss it by the least amount.
            place = int(random.choice([8 * random.integers(64), random.integers(WORLD_SIZE)]))
            times = int(random.integers(-4, 5))
            slope[q] = times * (e // gcd(n, e)) + int(random.choice([-1, 0, 0, 1]))
            eye[q] = place - times * (n // gcd(n, e))
        point = [int(eye[q]) + Fraction(int(slope[q]) * n, e) for q in OTHER_AXES[axis]]
        if not all(0 <= place <= LAST for place in point) or abs(slope).max() > steepest:
            continue
        if eye.min() < -LAST * reflections or eye.max() > far:
            continue
        cells = [place / (8 << size) for place in point]
        borders += any(cell.denominator == 1 for cell in cells)
        held = {"found_surface_axis": axis, "found_surface_cell": size, "found_distance": n, "found_slope": e}
        held |= {**two_complement(eye, eye_bits(config), "eye"), **slope_inputs(slope)}
        for cycle in range(7):
            stimulus.append({**held, "steps_load_divider": int(cycle == 0), "steps_store_quotient": int(cycle == 3)})
        expected.append((len(stimulus) - 1, [int(cell) % 2 for cell in cells]))
    outputs = leaf.run_both(stimulus, settled=6)
    for cycle, odd in expected:
        assert [outputs[cycle]["odd_u"], outputs[cycle]["odd_v"]] == odd, stimulus[cycle]
    assert borders > 30
