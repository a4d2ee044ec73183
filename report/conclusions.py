# SPDX-License-Identifier: MIT
"""What the numbers say, in sentences that are made anew from them on every run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from raycaster.configuration import Configuration
from raycaster.report.hardware import Candidate
from raycaster.report.points import PicturePoint

ENOUGH = 1e-3
"""Share of wrong pixels that is held to be enough: one in a thousand."""

BITES = 10
"""Times as many wrong pixels that make a difference between roundings worth a sentence."""

Results = Mapping[PicturePoint, Mapping]


def enough_fraction(results: Results) -> list[str]:
    """Of each scene the least F from which on few enough pixels are wrong, for both roundings."""
    said = []
    for scene in dict.fromkeys(point.view.name for point in results):
        parts = []
        for rounding in ("truncate", "nearest"):
            shares = {
                point.fraction_bits: result["wrong_share"]
                for point, result in results.items()
                if (point.view.name, point.rounding) == (scene, rounding)
            }
            good = [f for f in sorted(shares) if all(shares[more] <= ENOUGH for more in shares if more >= f)]
            least = f"F = {good[0]}" if good else f"no F up to {max(shares)}"
            parts.append(f"{least} when {_done(rounding)}")
        said.append(f"{scene}: at most {ENOUGH:.1%} of the pixels are wrong from {', from '.join(parts)}.")
    return said


def _done(rounding: str) -> str:
    return "truncated" if rounding == "truncate" else "rounded to nearest"


def what_a_bit_costs(units: Mapping[Configuration, int]) -> list[str]:
    """What one more fraction bit costs: cells by a straight line through what was counted, cycles by definition."""
    said = []
    for divider_bits in sorted({config.divider_bits for config in units}):
        for rounding in ("truncate", "nearest"):
            line = sorted(
                (config.fraction_bits, cells)
                for config, cells in units.items()
                if (config.divider_bits, config.rounding) == (divider_bits, rounding)
            )
            if len(line) > 1:
                slope, at_zero = np.polyfit(*zip(*line, strict=True), 1)
                said.append(
                    f"With {divider_bits} quotient bits a cycle, {_done(rounding)}, a ray unit takes about "
                    f"{at_zero:.0f} LUT4 and {slope:.0f} more for each fraction bit."
                )
    said.append(
        "Each fraction bit is one more bit of every quotient: a cycle more for each rectangle and ray at one bit a "
        "cycle, a half or a third of one on average at two or three."
    )
    return said


def where_roundings_differ(results: Results, fraction_bits: int) -> list[str]:
    """Scenes in which one rounding is much worse than the other."""
    said = []
    shares = {(p.view.name, p.rounding): r["wrong"] for p, r in results.items() if p.fraction_bits == fraction_bits}
    scenes = dict.fromkeys(scene for scene, _ in shares)
    for worse, better in (("truncate", "nearest"), ("nearest", "truncate")):
        found = [
            f"{scene} ({shares[scene, worse]:,} against {shares[scene, better]:,})"
            for scene in scenes
            if shares[scene, worse] >= BITES * max(shares[scene, better], 1)
        ]
        if found:
            said.append(
                f"At F = {fraction_bits}, {BITES} times as many pixels or more are wrong when {_done(worse)} as when "
                f"{_done(better)} in: {', '.join(found)}."
            )
    return said or [f"At F = {fraction_bits} neither rounding is {BITES} times worse than the other in any scene."]


def of_the_frontier(whose: str, best: Sequence[Candidate]) -> list[str]:
    """The ends of a frontier, and its middle."""
    by_error = sorted(best, key=lambda one: (one.error, one.cells))
    by_cells = sorted(best, key=lambda one: (one.cells, one.error))
    good = [one for one in by_cells if one.error <= ENOUGH]
    said = [
        f"On the frontier of {whose} the smallest design, {describe(by_cells[0])}, takes {by_cells[0].cells:,} LUT4 "
        f"and leaves {by_cells[0].error:.2%} of the pixels wrong; the most exact, {describe(by_error[0])}, takes "
        f"{by_error[0].cells:,} and leaves {by_error[0].error:.4%}.",
    ]
    if good:
        said.append(
            f"Of {whose}, the smallest that leaves at most {ENOUGH:.1%} is {describe(good[0])}, with "
            f"{good[0].cells:,} LUT4 and {good[0].error:.4%}."
        )
    return said


def describe(one: Candidate) -> str:
    """A design in words."""
    config = one.config
    if config.engine == "exact":
        return f"the exact engine with {config.units} units"
    return (
        f"F = {config.fraction_bits} {_done(config.rounding)}, {config.units} units, {config.divider_bits} quotient "
        "bits a cycle"
    )


def of_the_catalogue(worst: Iterable[tuple[str, str, int, float, int]]) -> list[str]:
    """From case, arithmetic, coordinates over their bound, greatest part of a bound, and flips of each."""
    rows = list(worst)
    over = sum(exceeded for _, _, exceeded, _, _ in rows)
    case, arithmetic, _, part, _ = max(rows, key=lambda row: row[3])
    said = [
        f"In {len({row[0] for row in rows})} cases {over} coordinates of hit points are off by more than their bound; "
        f"the closest to it is {case} ({arithmetic}), at {part:.2%} of it.",
    ]
    for arithmetic in dict.fromkeys(row[1] for row in rows):
        case, _, _, _, flips = max((row for row in rows if row[1] == arithmetic), key=lambda row: row[4])
        said.append(f"Most rays flip in {case} for {arithmetic}: {flips:,}.")
    return said
