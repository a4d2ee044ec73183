# SPDX-License-Identifier: MIT
"""The one home of what distinguishes the engines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from raycaster.screens import BEAM_SCREENS, SCREENS, Screen


@dataclass(frozen=True)
class Engine:
    """What computes the rays.

    Attributes:
        name: as users choose it.
        code: what the register `engine` reads.
        screens: those that it can fill, by name and rows.
        slot_cycles: from one rectangle to the next; 0: all at once; None: as long as a division takes.
        result_latency: cycles from the end of a pass's last slot to the first cycle of the next pass.
        pattern_latency: cycles that a pass takes more where rectangles have patterns.
        rect_latency: cycles from `fetch` to the rectangle.
        turns: whether its camera turns; the seed's depth is measured along x.
        margin: how far outside a rectangle's bounds a primary ray may pass that hits it, in world units: a rounded
            coordinate is off by less than one.
        line_buffered: whether units fill a line buffer ahead of the monitor, group after group.
    """

    name: str
    code: int
    screens: Mapping[tuple[str, int], Screen]
    slot_cycles: int | None
    result_latency: int
    pattern_latency: int
    rect_latency: int
    margin: int
    turns: bool
    line_buffered: bool

    @property
    def divides(self) -> bool:
        """Whether it forms quotients, which have a fraction and are rounded."""
        return self.slot_cycles is None


# Slope and plane latched, product, divider loaded, hit point, depth compared, ray stored.
SEED = Engine(
    "seed", 0, SCREENS, slot_cycles=None, result_latency=6, pattern_latency=0, rect_latency=1, margin=1, turns=False,
    line_buffered=True,
)  # fmt: skip
# Two more stages of the test after the first, which the slot is, depth compared, ray stored. The cells of u and of v:
# dividend, three cycles of two bits each; in the last the ray is stored.
EXACT = Engine(
    "exact", 1, SCREENS, slot_cycles=1, result_latency=4, pattern_latency=6, rect_latency=1, margin=0, turns=True,
    line_buffered=True,
)  # fmt: skip
BEAM = Engine(
    "beam", 2, BEAM_SCREENS, slot_cycles=0, result_latency=0, pattern_latency=0, rect_latency=2, margin=0, turns=True,
    line_buffered=False,
)  # fmt: skip
ENGINES: Mapping[str, Engine] = {engine.name: engine for engine in (SEED, EXACT, BEAM)}
"""By name."""
