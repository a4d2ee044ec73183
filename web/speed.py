# SPDX-License-Identifier: MIT
"""How fast the page draws in Chromium, beside the same design compiled for this machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING, Any

from rich.progress import track
from rich.table import Table

from raycaster.configuration import Configuration
from raycaster.output import Console
from raycaster.play.machine import Machine, build_machine
from raycaster.play.walk import Walker
from raycaster.scene import load_scene, packaged_scenes

if TYPE_CHECKING:
    from playwright.sync_api import Page

SCENES = ("mirror_room", "boxes", "floor", "gallery", "staircase")
"""That need no more than the fastest of the page's designs."""

FRAMES = 40
WARM = 5
"""Frames before those that count: a browser compiles what runs often once more."""

RUN = """async ([model, source, warm, count]) => {
    const machine = await Machine.start(model), times = [];
    await machine.call("load", readScene(source, "scene", machine.design.rectangles));
    for (let frame = 0; frame < warm + count; frame++) times.push((await machine.frame()).milliseconds);
    machine.end();
    return times.slice(warm);
}"""


def _native(config: Configuration, scene: str, build: Path) -> Iterator[float]:
    """Milliseconds of each frame, with what it takes to get the picture."""
    with Machine(build_machine(config, build, processor=False), config) as machine:
        machine.frame(writes=Walker(load_scene(packaged_scenes()[scene]), config).load())
        for frame in range(WARM + FRAMES):
            began = perf_counter()
            machine.frame()
            if frame >= WARM:
                yield 1000 * (perf_counter() - began)


def speed(
    page: Page, site: Path, model: str, config: Configuration, build: Path, console: Console
) -> list[dict[str, Any]]:
    """Measure a model of the page, one scene after the other.

    Args:
        page: of a browser, `browser_page`'s.
        site: the page's directory.
        model: its name in the page.
        config: the design in it.
        build: the directory that holds `model/`.
        console: for the progress bar.

    Returns:
        For each scene its name, the medians of a frame's milliseconds in the browser and natively, and how many frames
        the walk shows in a second while it checks each of them.
    """
    rows = []
    for name in track(SCENES, "scenes", console=console, transient=True):
        # The page of the scene's lives stands still, so that nothing else is drawn.
        page.goto(f"{(site / 'index.html').absolute().as_uri()}#pixel")
        page.wait_for_function("RayCaster.state.pixel")
        source = packaged_scenes()[name].read_text()
        in_browser = median(page.evaluate(RUN, [model, source, WARM, FRAMES]))
        native = median(_native(config, name, build))
        page.goto("about:blank")
        page.goto((site / "index.html").absolute().as_uri())
        page.wait_for_function("RayCaster.state.walk?.frames > 2")
        page.select_option("#walk-scene", name)
        shown = "RayCaster.state.walk.frames"
        page.wait_for_timeout(2000)
        began, first = perf_counter(), page.evaluate(shown)
        page.wait_for_timeout(5000)
        rate = (page.evaluate(shown) - first) / (perf_counter() - began)
        rows.append({"scene": name, "browser_ms": in_browser, "native_ms": native, "shown": rate})
    return rows


def speed_table(rows: Sequence[dict[str, Any]]) -> Table:
    """The measurements, a line a scene."""
    table = Table("scene", "browser", "native", "ratio", "frames a second shown")
    for row in rows:
        ratio = row["browser_ms"] / row["native_ms"]
        times = (f"{row['browser_ms']:.0f} ms", f"{row['native_ms']:.0f} ms", f"{ratio:.2f}", f"{row['shown']:.1f}")
        table.add_row(row["scene"], *times)
    return table
