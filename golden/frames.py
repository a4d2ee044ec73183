# SPDX-License-Identifier: MIT
"""The time of a frame of the span engine, whose units draw rows in turn."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration
from raycaster.errors import UserError
from raycaster.golden.spans import Row, SpanModel
from raycaster.golden.world import Rectangles
from raycaster.scene import Scene

FIRST_DEAL = 4
"""Cycles from the StartScreen at which a frame begins to the deal of its first row, if the units are ready."""

BANK = 2048
"""Runs of a bank of a queue's memory; up to four banks take a cycle more than one."""


def frame_cycles(rows: Iterable[Row], columns: int, units: int = 1, places: int = 0, first: int = FIRST_DEAL) -> int:
    """Return the cycles from the StartScreen at which a frame begins until its list is whole.

    Unit i draws the rows i, i + units, and so on. A row is dealt when its unit is done with the one before and, with
    more than one unit, has room for a whole row in its queue, but at the earliest in the cycle after the row above. It
    starts in the next cycle. Runs are collected row by row, one per cycle.

    Args:
        rows: the rows, from the top.
        columns: columns of a row.
        units: number of units.
        places: runs that the queue of a unit holds; not used with one unit.
        first: cycles from StartScreen to the deal of the first row.
    """
    # Cycles from the fetch of a run to that in which it may be collected, and runs that have left the memory till then.
    offered, ahead = (3, 4) if places <= BANK else (4, 8)
    free = [first] * units
    fetched: list[list[int]] = [[] for _ in range(units)]
    collected: list[list[int]] = [[] for _ in range(units)]
    last, above = 0, first - 1
    for number, row in enumerate(rows):
        unit = number % units
        fetches, takes = fetched[unit], collected[unit]
        deal = max(free[unit], above + 1)
        if units > 1 and len(fetches) > places - columns:
            deal = max(deal, fetches[len(fetches) - (places - columns) - 1] + 1)
        start = deal + 1
        free[unit], above = start + row.cycles, deal
        for offset in row.taken:
            if units == 1:
                last = start + offset
                continue
            fetch = start + offset + 1
            if fetches:
                fetch = max(fetch, fetches[-1] + 1)
            if len(takes) >= ahead:
                fetch = max(fetch, takes[-ahead] + 1)
            last = max(last + 1, fetch + offered)
            fetches.append(fetch)
            takes.append(last)
    return last + 1


def model_for(scene: Scene, config: Configuration, reflections: int | None = None) -> SpanModel:
    """Return the model of a design that draws a scene, with its own reflections if none are given."""
    model = SpanModel.of_scene(scene, config.screen_geometry, reflections)
    model = replace(model, patterns=config.patterns, lights=config.light)
    # A scene that is built in may lack rectangles that are not seen.
    return replace(model, rectangles=Rectangles.of_fixed(config.fixed.rectangles)) if config.fixed else model


def scene_cycles(scene: Scene, config: Configuration, reflections: int | None = None) -> int:
    """Return the cycles of a design's frame of a scene, with its own reflections if none are given.

    Several units get a copy of the table first, and have queues for two rows.
    """
    return cycles_of(scene_rows(scene, config, reflections), config)


def scene_rows(scene: Scene, config: Configuration, reflections: int | None = None) -> list[Row]:
    """Return the rows of a design's frame of a scene, with its own reflections if none are given."""
    return list(model_for(scene, config, reflections).rows(config.screen_geometry, scene.camera.basis))


def cycles_of(rows: Iterable[Row], config: Configuration) -> int:
    """Return the cycles in which a design draws a frame of these rows."""
    columns = config.screen_geometry.columns
    first = FIRST_DEAL + (config.rectangles if config.units > 1 else 0)
    return frame_cycles(rows, columns, config.units, 2 * columns, first)


def runs_of(rows: Iterable[Row]) -> int:
    """Return the entries that a list needs for a frame of these rows."""
    return sum(len(row.runs) for row in rows)


def refreshes(cycles: int, config: Configuration) -> int:
    """Return the refreshes of the monitor that a frame takes, from StartScreen to the one at which it is shown.

    A frame that is whole in the cycle of a StartScreen is too late for it.
    """
    return cycles // config.screen_geometry.frame_cycles + 1


def shown_hz(cycles: int, config: Configuration) -> str:
    """Return the frames per second that a monitor shows if each takes these cycles, and its refresh divided by what."""
    screen = config.screen_geometry
    times, hz = refreshes(cycles, config), screen.clock_hz / screen.frame_cycles
    return f"{hz:.0f}" if times == 1 else f"{hz:.0f}/{times} = {hz / times:.0f}"


def screens_before(scene: Scene, config: Configuration, reflections: int | None = None) -> int:
    """Return the screens from the StartScreen at which a scene goes live to that at which its first frame is shown.

    Without whole frames there are none.
    """
    if not config.facts.whole_frames:
        return 0
    return refreshes(scene_cycles(scene, config, reflections), config)


def check_list(rows: Iterable[Row], config: Configuration, path: Path) -> None:
    """Check that a design's lists hold the frame of a scene file; otherwise the scene would never be shown.

    Raises:
        UserError: they do not.
    """
    if (needed := runs_of(rows)) > config.list:
        raise UserError(
            f"{path}: a frame has {needed:,} runs of one colour, but a list of the design holds {config.list:,}; take "
            f"{as_typed('list', needed + needed % 2)} or more"
        )
