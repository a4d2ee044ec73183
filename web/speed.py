# SPDX-License-Identifier: MIT
"""Measure how fast the page draws in Chromium, compared with the same design compiled natively."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
    """Measure a model of the page, scene by scene.

    Args:
        page: browser page, from `browser_page`.
        site: directory of the written page.
        model: name of the model on the page.
        config: configuration of the model.
        build: directory that holds `model/`.
        console: console for the progress bar.

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


def speed_table(rows: Sequence[dict[str, Any]]) -> Table:
    """Format the measurements as a table, one row per scene."""
    table = Table("scene", "browser", "native", "ratio", "frames per second shown")
    for row in rows:
        ratio = row["browser_ms"] / row["native_ms"]
        times = (f"{row['browser_ms']:.0f} ms", f"{row['native_ms']:.0f} ms", f"{ratio:.2f}", f"{row['shown']:.1f}")
        table.add_row(row["scene"], *times)
    return table
