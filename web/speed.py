# SPDX-License-Identifier: MIT
"""Measure how fast the page draws in Chromium, compared with the same design compiled natively."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING, Any

from rich.progress import track

from raycaster.configuration import Configuration
from raycaster.output import Console, Table
from raycaster.play.machine import Machine, build_machine
from raycaster.play.walk import Walker
from raycaster.scene import load_scene, packaged_scenes

if TYPE_CHECKING:
    from playwright.sync_api import Page

SCENES = ("mirror_room", "boxes", "floor", "gallery", "staircase")
"""Scenes for which the fastest of the page's designs is enough."""

FRAMES = 40
WARM = 5
"""Frames drawn before timing starts, because a browser recompiles code that runs often."""

HEADINGS = ("frame in Chromium", "natively", "ratio", "frames per second on the page")
"""Headings of the measurements after the scene's name."""

RUN = """async ([model, source, warm, count]) => {
    const machine = await Machine.start(model), times = [];
    await machine.call("load", readScene(source, "scene", machine.design.rectangles));
    for (let frame = 0; frame < warm + count; frame++) times.push((await machine.frame()).milliseconds);
    machine.end();
    return times.slice(warm);
}"""


def _native(config: Configuration, scene: str, build: Path) -> Iterator[float]:
    """Yield the milliseconds of each frame, including the transfer of its picture."""
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
    """Measure a model of the page, scene by scene, in a page from `browser_page`.

    Returns:
        For each scene its name, the median milliseconds per frame in the browser and natively, and the frames per
        second of the walk while it checks each frame.
    """
    rows = []
    for name in track(SCENES, "scenes", console=console, transient=True):
        # The Pixel tab is idle after its first frame, so nothing else is drawn.
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


def speed_texts(row: Mapping[str, Any]) -> list[str]:
    """Format a scene's measurements in the order of `HEADINGS`."""
    browser, native = row["browser_ms"], row["native_ms"]
    return [f"{browser:.0f} ms", f"{native:.0f} ms", f"{browser / native:.2f}", f"{row['shown']:.1f}"]


def speed_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Format the measurements as a table, one row per scene."""
    table = Table("scene", *HEADINGS)
    for row in rows:
        table.add_row(row["scene"], *speed_texts(row))
    return table
