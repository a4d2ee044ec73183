# SPDX-License-Identifier: MIT
"""Errors of the seed engine's golden model, and their bounds, compared with fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.report.depth_errors import condition, depth_errors
from raycaster.report.points import CASE, picture
from raycaster.screens import SCREENS
from raycaster.verif.catalogue import catalogue
from raycaster.verif.random_world import random_camera, random_rectangles, random_slopes

SLOPES = primary_slopes(SCREENS["tiny", 48]).reshape(-1, 3)


def traced(table, camera, slopes, reflections, fraction_bits=0, rounding="truncate"):
    """Return the exact trace and the seed engine's."""
    models = ExactModel(), SeedModel(fraction_bits, rounding)
    return [model.trace(table, camera, (0, 0, 0), slopes, reflections) for model in models]


def fraction_errors(table, camera, slope, reflections, fraction_bits, rounding):
    """Yield a ray's errors and bounds, as fractions, for each depth at which it hits what the exact ray hits."""
    perfect, rounded = traced(table, camera, slope[None, :], reflections, fraction_bits, rounding)
    last_place = Fraction(1 if rounding == "truncate" else Fraction(1, 2), 1 << fraction_bits)
    bound = [Fraction(0)] * 3
    for depth in range(reflections + 1):
        winner = int(rounded.winners[depth][0])
        if winner < 0 or winner != perfect.winners[depth][0]:
            return
        axis = int(table.axes[winner])
        steepness = [abs(Fraction(int(slope[u]), int(slope[axis]))) for u in range(3)]
        bound = [0 if u == axis else bound[u] + steepness[u] * bound[axis] + last_place for u in range(3)]
        error = [
            abs(
                Fraction(int(rounded.points[depth][0, u]), 1 << fraction_bits)
                - Fraction(int(perfect.points[depth][0, u]), int(perfect.denominators[depth][0]))
            )
            for u in range(3)
        ]
        yield depth, error, bound


# Some bounds exceed machine words at six reflections, all do at seven.
@pytest.mark.parametrize(
    ("fraction_bits", "rounding", "reflections"),
    [*product((0, 3, 8), ("truncate", "nearest"), [2]), (8, "nearest", 7)],
)
def test_errors_and_bounds_are_those_of_fractions(fraction_bits, rounding, reflections, random):
    deep, compared = reflections > 2, 0
    for _ in range(20 if deep else 60):
        table = random_rectangles(random, **{"closed": True} if deep else {})
        camera, [slope] = random_camera(random, table), random_slopes(random, 1)
        perfect, drawn = traced(table, camera, slope[None, :], reflections, fraction_bits, rounding)
        found = depth_errors(table, slope[None, :], perfect, drawn.winners, drawn.points, fraction_bits, rounding)
        for depth, error, bound in fraction_errors(table, camera, slope, reflections, fraction_bits, rounding):
            assert found[depth].worst == pytest.approx(float(max(error)), rel=1e-9 if deep else 1e-12)
            assert found[depth].bound == pytest.approx(float(max(bound)), rel=1e-9 if deep else 1e-12)
            assert all(e <= b for e, b in zip(error, bound, strict=True))
            assert found[depth].exceeded == 0
            compared += depth > 4 or not deep
    assert compared > (5 if deep else 40)


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
def test_no_case_exceeds_its_bound(rounding):
    cases = catalogue()
    assert len(cases) >= 50 and all(case.strain for case in cases)
    hit = 0
    for case in cases:
        result = picture(f"{CASE}{case.name}", 0, rounding, 2, "tiny").compute()
        assert [depth["exceeded"] for depth in result["depths"]] == [0, 0, 0], case.name
        hit += result["depths"][2]["rays"] > 0
    assert hit > 20


def test_the_condition_of_rays_by_hand():
    """A slope of (2, 1, 2) has length 3; on planes across x, y and z its condition numbers are 3/2, 3 and 3/2."""
    planes = [((100, 0, 0), (100, 511, 511)), ((0, 100, 0), (511, 100, 511)), ((0, 0, 100), (511, 511, 100))]
    slopes = np.array([[2, 1, 2], [-2, -1, -2]])
    tables = [
        Rectangles(np.array(corners), np.zeros((len(corners), 3), np.uint8), np.ones(len(corners), bool))
        for corners in (*([plane] for plane in planes), planes[:2])
    ]
    found = [condition(slopes, traced(table, (0, 0, 0), slopes, 0)[0]) for table in tables[:3]]
    assert found == [1.5, 3, 1.5]
    # Reflected in the first plane, the ray meets the second one at y = 100, x = 0.
    assert condition(slopes, traced(tables[3], (0, 0, 0), slopes, 1)[0]) == 3
    assert condition(slopes[1:], traced(tables[0], (0, 0, 0), slopes[1:], 0)[0]) is None
