# SPDX-License-Identifier: MIT
"""Expected behaviour of an engine's control and of the sorted rectangles, for leaf tests."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.engines import buffered_engine_of

EARLY_OUT_AT = 2
"""Cycles from the start of a rectangle that no ray runs towards to its early out, the last cycle of its test."""


def check_cycles(cycles: Mapping[str, int], config: Configuration) -> None:
    """Check the longest times of a row and of a group, as the register reports them after a whole frame in time.

    Raises:
        AssertionError: they contradict each other or the budget; or they are not 0 in a design with lists of frames.
    """
    if not config.facts.whole_frames:
        # A row is its groups, one after another; less than one cycle per group comes on top.
        longest = buffered_engine_of(config).group_cycles(config)
        assert cycles["row"] // config.groups <= cycles["group"] <= longest, cycles
        assert config.groups <= cycles["row"] < config.screen_geometry.row_cycles, cycles
    else:
        assert cycles == {"row": 0, "group": 0}, cycles


def sorted_rect(rectangles: Rectangles, index: int, prefix: str, config: Configuration | None = None) -> dict[str, int]:
    """Return what `rect_sorter` must output for a rectangle, as values for the ports of a `Rect` named `prefix`.

    Values of the looks are included if there is a configuration that has them.
    """
    axis = int(rectangles.axes[index])
    u, v = OTHER_AXES[axis]
    low, high = rectangles.low[index], rectangles.high[index]
    fields = {
        "axis": axis,
        "position": low[axis],
        "u_low": low[u],
        "u_high": high[u],
        "v_low": low[v],
        "v_high": high[v],
        "colour": int.from_bytes(bytes(rectangles.colours[index])),
    }
    if config and config.materials:
        fields["mirror"] = rectangles.mirrors[index]
    if config and config.patterns:
        fields["kind"] = rectangles.kinds[index] if rectangles.cells[index] < WORLD_SIZE else 0
        fields["cell"] = int(rectangles.cells[index]).bit_length() - 4
        fields["colour_2"] = int.from_bytes(bytes(rectangles.colours_2[index]))
    return {f"{prefix}_{name}": int(value) for name, value in fields.items()}


@dataclass
class TraceCycle:
    """Expected behaviour of an engine's control in one cycle of tracing a group of rays."""

    steps: dict[str, int]
    """Values for the ports of `steps`."""

    bounce: int
    """0 in the pass of the primary ray, 1 and 2 in those of its reflections."""

    current: int | None = None
    """Rectangle that is held for the dividers to start on; None for don't care."""

    offered: int | None = None
    """Rectangle whose quotients were stored last; in the exact engine the one whose verdict is due."""

    towards: int | None = None
    """1 if a ray runs towards the rectangle that was started; None for don't care."""

    alive: int | None = None
    """1 if a ray still hits anything; None for don't care."""


def step_names(config: Configuration) -> list[str]:
    """List the attributes of `Steps` that the control of a line-buffered engine drives."""
    return [
        name
        for name in vars(Steps())
        if (config.facts.divides or config.patterns or name not in ("load_divider", "store_quotient"))
        and (config.light or name not in ("aim", "from_light", "write_shadow"))
    ]


def rect_cycles(config: Configuration) -> int:
    """Return the cycles from one rectangle to the next: one, or those for the 9 integer bits and the fraction bits."""
    return -(-(9 + config.fraction_bits) // config.divider_bits) if config.facts.divides else 1


def ends_early(config: Configuration) -> bool:
    """True if a rectangle that no ray runs towards has enough cycles to be ended early."""
    return bool(config.culling) and rect_cycles(config) > EARLY_OUT_AT + 1


def trace_cycles(
    config: Configuration,
    usable: Sequence[int],
    reflections: int,
    *,
    may_hit: Collection[int] | None = None,
    behind: Collection[tuple[int, int]] = (),
    lost: int | None = None,
) -> list[TraceCycle]:
    """List the cycles from the one that generates a group's rays to the last before `done`, timed as in the blocks'
    contracts.

    Args:
        config: gives the engine, the divider and culling.
        usable: indices of the rectangles that are enabled and have a plane, ascending.
        reflections: number of reflections of the scene.
        may_hit: indices of the rectangles that a primary ray may hit; None for all.
        behind: (bounce, index) of the rectangles that no ray runs towards.
        lost: the bounce after which no ray is alive.
    """
    division = rect_cycles(config)
    exact = not config.facts.divides
    offered_after = 3 if exact else division + 4
    idle = {f"steps_{name}": 0 for name in step_names(config)}
    cycles = [TraceCycle(dict(idle), 0)]

    def strobe(cycle: int, *names: str) -> None:
        cycles[cycle].steps |= {f"steps_{name}": 1 for name in names}

    strobe(0, "screen_to_ray", "reset_colour", "reset_z_buf")
    for bounce in range(reflections + 1):
        visited = [index for index in usable if bounce or may_hit is None or index in may_hit]
        early = [ends_early(config) and (bounce, index) in behind for index in visited]
        starts = list(accumulate((EARLY_OUT_AT + 1 if ended else division for ended in early), initial=0))
        offered = [start + offered_after for start, ended in zip(starts, early, strict=False) if not ended]
        # A pass without rectangles only searches for one and adds the background; a lost ray adds it at once.
        traced = lost is None or bounce <= lost
        patterns = 6 if config.patterns and exact else 0
        length = 2 + max([starts[-1], *(end + patterns for end in offered)]) if traced else 1
        first = len(cycles)
        cycles += [TraceCycle(idle | {"steps_initial_ray": int(bounce == 0)}, bounce) for _ in range(length)]
        strobe(-1, "add_colour", "reset_z_buf", *(["store_ray"] if bounce < reflections else []))
        cycles[-1].alive = int(lost is None or bounce < lost)
        for index, ended, place in zip(visited if traced else [], early, starts, strict=False):
            start = first + place
            strobe(start, "find_intersection")
            if exact:
                strobe(start + 3, "write_z_buf")
                cycles[start].current = cycles[start + 3].offered = index
                if config.patterns:
                    strobe(start + 4, "load_divider")
                if config.patterns and place == starts[-2]:
                    strobe(start + 7, "store_quotient")
                continue
            cycles[start + 1].towards = int((bounce, index) not in behind)
            strobe(start + 2, "load_divider")
            for cycle in cycles[start : start + (EARLY_OUT_AT + 1 if ended else division)]:
                cycle.current = index
            if not ended:
                strobe(start + 2 + division, "store_quotient")
                strobe(start + 4 + division, "write_z_buf")
                for cycle in cycles[start + 3 + division :]:
                    cycle.offered = index
    # A finished rectangle is held until the next one has finished.
    for before, cycle in pairwise(cycles):
        if not exact and cycle.offered is None:
            cycle.offered = before.offered
    return cycles
