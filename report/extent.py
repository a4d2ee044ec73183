# SPDX-License-Identifier: MIT
"""Extent of the report: everything, or a sweep of less than three minutes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from raycaster.configuration import LOOKS, MOST_REFLECTIONS, Configuration, configure
from raycaster.engines import ENGINES
from raycaster.golden.catalogue import Case, catalogue

CASE_REFLECTIONS = 2
"""Number of reflections in the catalogue's cases."""


@dataclass(frozen=True)
class Extent:
    """Extent of a sweep."""

    fractions: Sequence[int]
    reflections: Sequence[int]
    """Numbers of reflections for the packaged scenes' pictures; random worlds use 1 and the greatest of these."""

    worlds: int
    """Number of random worlds."""

    design_fractions: Sequence[int]
    units: Sequence[int]
    """Numbers of units for designs of the seed engine."""

    exact_units: Sequence[int]
    cases: Sequence[Case]
    case_fractions: Sequence[int]
    case_screen: str
    probed_cases: Sequence[Case]
    probed: Sequence[Configuration]
    """Designs whose hit points are checked in simulation."""

    shown: Sequence[Configuration]
    """Designs that are simulated with every case that they can draw."""

    screen: str
    """Screen of the designs."""

    frontier: int
    """Maximum number of designs per frontier that are simulated and counted, from its start."""

    culled: Sequence[str]
    """Engines with which each scene is simulated with and without culling."""

    left_scenes: int
    """Maximum number of packaged scenes for which a design is reduced step by step."""

    left_engine: str = "exact"


def extent(quick: bool) -> Extent:
    """Return the full extent, or a quick one of less than three minutes."""
    cases = catalogue(LOOKS)
    plain = [case for case in cases if not case.scene.lacks(())]
    every = range(9)
    if quick:
        probed = configure(screen="tiny", units=16, reflections=CASE_REFLECTIONS, divider_bits=3, allow_underrun=True)
        return Extent(
            fractions=(0, 2, 4), reflections=(0, 1, 2), worlds=24,
            design_fractions=(0,), units=(16,), exact_units=(4, 16),
            cases=cases, case_fractions=(0,), case_screen="tiny", probed_cases=plain[::12], probed=[probed], shown=[],
            screen="tiny", frontier=1, culled=(), left_scenes=0,
        )  # fmt: skip
    probed_designs = [
        configure(reflections=CASE_REFLECTIONS, fraction_bits=f, rounding=r, divider_bits=3)
        for f, r in ((0, "truncate"), (4, "nearest"))
    ]
    shown = [
        configure(engine=engine, reflections=CASE_REFLECTIONS, turn=True, materials=True, patterns=True, **more)
        for engine, more in (("exact", {"light": True}), ("beam", {"scale": 1}))
    ]
    return Extent(
        fractions=every, reflections=range(MOST_REFLECTIONS + 1), worlds=200,
        design_fractions=every, units=(20, 32), exact_units=(4, 5, 8, 10, 16, 20, 32),
        cases=cases, case_fractions=(0, 2, 4, 8), case_screen="vga", probed_cases=plain, probed=probed_designs,
        shown=shown, screen="vga", frontier=100, left_scenes=100,
        culled=[name for name, engine in ENGINES.items() if engine.line_buffered],
    )  # fmt: skip
