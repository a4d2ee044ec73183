# SPDX-License-Identifier: MIT
"""`cell_finder`: cells of points, computed with fractions: cells of every size, and points on cell borders."""

from fractions import Fraction
from math import gcd

from vectors import LAST, by_axis, by_reflections, by_turn, exact_config, slope_inputs

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.world import OTHER_AXES
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.exact.cell_finder import cell_finder


@by_turn
@by_reflections
def test_cell_finder(reflections, turn, leaf_of, random):
    config = exact_config(reflections=reflections, turn=turn, patterns=True)
    leaf, borders = leaf_of(cell_finder, config), 0
    far, steepest = LAST * (reflections + 1), (1 << exact_slope_bits(config)) - 1
    while len(leaf.expected) < 300:
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
        held |= by_axis("eye_", eye) | slope_inputs(slope)
        for cycle in range(7):
            leaf.case({**held, "steps_load_divider": cycle == 0, "steps_store_quotient": cycle == 3})
        leaf.expect({"odd_u": int(cells[0]) % 2, "odd_v": int(cells[1]) % 2})
    leaf.check(settled=6)
    assert borders > 30
