# SPDX-License-Identifier: MIT
"""How much the report sweeps: everything, or what takes less than three minutes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from raycaster.configuration import LOOKS, MOST_REFLECTIONS, Configuration, configure
from raycaster.engines import ENGINES
from raycaster.golden.catalogue import Case, catalogue

CASE_REFLECTIONS = 2
"""That the catalogue is looked at with."""


@dataclass(frozen=True)
class Extent:
    """How much is swept."""

    fractions: Sequence[int]
    reflections: Sequence[int]
    """Of the packaged scenes' pictures; random worlds have one and the most of these."""

    worlds: int
    """Random ones."""

    design_fractions: Sequence[int]
    units: Sequence[int]
    """Of the seed engine."""

    exact_units: Sequence[int]
    cases: Sequence[Case]
    case_fractions: Sequence[int]
    case_screen: str
    probed_cases: Sequence[Case]
    probed: Sequence[Configuration]
    """Whose hit points are looked at in simulation."""

    shown: Sequence[Configuration]
    """That draw all cases which they can draw in simulation."""

    screen: str
    """Of the designs."""

    frontier: int
    """Designs of the frontiers that are simulated and counted, at most: the first of each."""

    culled: Sequence[str]
    """Engines of which each scene is simulated with culling and without."""

    left_scenes: int
    """Packaged scenes for which designs are made smaller step by step, at most."""

    left_engine: str = "exact"


def extent(quick: bool) -> Extent:
    """Everything, or what takes less than three minutes."""
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
        for engine, more in (("exact", {}), ("beam", {"scale": 1}))
    ]
    return Extent(
        fractions=every, reflections=range(MOST_REFLECTIONS + 1), worlds=200,
        design_fractions=every, units=(20, 32), exact_units=(4, 5, 8, 10, 16, 20, 32),
        cases=cases, case_fractions=(0, 2, 4, 8), case_screen="vga", probed_cases=plain, probed=probed_designs,
        shown=shown, screen="vga", frontier=100, left_scenes=100,
        culled=[name for name, engine in ENGINES.items() if engine.line_buffered],
    )  # fmt: skip
