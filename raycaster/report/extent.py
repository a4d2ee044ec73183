# SPDX-License-Identifier: MIT
"""Extent of the report: everything, or a sweep of two minutes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from raycaster.configuration import FEATURES, Configuration
from raycaster.report.designs import exact_designs, seed_designs
from raycaster.verif.catalogue import Case, catalogue

CASE_REFLECTIONS = 2
"""Number of reflections in the catalogue's cases."""


@dataclass(frozen=True)
class Extent:
    """Extent of a sweep."""

    fractions: Sequence[int]
    worlds: int
    """Number of random worlds."""

    designs: Sequence[Configuration]
    """Designs that are simulated and counted."""

    cases: Sequence[Case]
    case_fractions: Sequence[int]
    case_screen: str


def extent(quick: bool) -> Extent:
    """Return the full extent, or a quick one of two minutes."""
    cases = catalogue(FEATURES)
    if quick:
        return Extent(
            fractions=(0, 2, 4), worlds=24,
            designs=[*seed_designs((), (16,), "tiny")[1:2], *exact_designs((4,), "tiny")], cases=cases,
            case_fractions=(0,), case_screen="tiny",
        )  # fmt: skip
    return Extent(
        fractions=range(9), worlds=200,
        designs=[*seed_designs((0, 4, 8), (20, 32)), *exact_designs((4, 5, 8, 10, 16))], cases=cases,
        case_fractions=(0, 4), case_screen="vga",
    )  # fmt: skip
