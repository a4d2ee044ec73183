# SPDX-License-Identifier: MIT
"""Errors of the seed engine's golden model, and their bounds, compared with fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from raycaster.golden.catalogue import catalogue
from raycaster.golden.errors import compare
from raycaster.golden.exact import ExactModel
from raycaster.golden.random_world import random_camera, random_rectangles, random_slopes
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.report import errors as report_errors
from raycaster.report.points import CASE, picture
from raycaster.screens import SCREENS

SLOPES = primary_slopes(SCREENS["tiny", 48]).reshape(-1, 3)


def fraction_errors(table, camera, slope, reflections, fraction_bits, rounding):
    """Yield a ray's errors and bounds, as fractions, for each depth at which it hits what the exact ray hits."""
    arguments = table, camera, (0, 0, 0), slope[None, :], reflections
    perfect, rounded = (model.trace(*arguments) for model in (ExactModel(), SeedModel(fraction_bits, rounding)))
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
        found = compare(table, camera, slope[None, :], reflections, fraction_bits, rounding)
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


def test_the_known_case():
    """Truncation turns misses at y = 511.01 into hits."""
    result = picture("case:camera_beside_edge_of_world", 0, "truncate", 2).compute()
    assert (result["wrong"], result["pixels"]) == (23_760, 76_800)
    assert result["depths"][0]["flips"] == 23_760


def test_the_mean_error_is_over_rays():
    """A picture of nine rays counts nine times as much as one of a single ray; one without rays does not count."""
    pictures = [
        {"depths": [{"rays": rays, "mean": mean, "worst": mean, "bound": 2.0, "tightest": mean / 2, "flips": 1}]}
        for rays, mean in ((9, 1.0), (1, 0.0), (0, 0.0))
    ]
    row = report_errors._depth_row(pictures, 0)
    assert row["mean"] == pytest.approx(0.9)
    assert (row["rays"], row["flips"], row["worst, median picture"], row["greatest error / bound"]) == (10, 3, 0.5, 0.5)
