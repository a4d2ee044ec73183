# SPDX-License-Identifier: MIT
"""cocotb: a design with a line buffer that is too slow for its scene loses columns, reports this, and never disturbs
the monitor."""

from __future__ import annotations

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject

from raycaster.rtl.engines import buffered_engine_of
from raycaster.scene import Scene
from raycaster.sim.harness import Harness
from raycaster.verif.expected import check_cycles

_CAMERA = {"position": [20, 256, 100]}
_COLOURS = ("#ff0000", "#00ff00", "#0000ff", "#ffff00", "#00ffff", "#ff00ff")
_FLOOR = {"corners": [[0, 0, 0], [511, 511, 0]], "colour": "#c8c8b4"}
_LIGHT = Scene.model_validate({"background": "#402010", "camera": _CAMERA, "rect": [_FLOOR]})


def _heavy(rectangles: int, light: bool) -> Scene:
    """Return two mirrors that a ray bounces between, under ceilings that it rises towards, so culling skips few.

    A light is at the camera, so nothing ends its shadow passes early.
    """
    rect = [{"corners": [[x, 0, 0], [x, 511, 511]], "colour": "#50a0ff"} for x in (10, 30)]
    for number in range(rectangles - len(rect)):
        height = 120 + number
        colour = _COLOURS[number % len(_COLOURS)]
        rect.append({"corners": [[0, 0, height], [511, 511, height]], "colour": colour})
    lights = {"light": _CAMERA} if light else {}
    return Scene.model_validate({"background": "#104020", "camera": _CAMERA, "rect": rect, **lights})


@cocotb.test()
async def underrun(bench: HierarchyObject) -> None:
    """Show a light scene, one that is too heavy, and the light one again. The monitor checks the sync of each frame."""
    harness = Harness(bench)
    bus, monitor, configuration = harness.bus, harness.monitor, harness.configuration
    reflections = configuration.most_reflections
    heavy = _heavy(configuration.rectangles, configuration.light)
    light_picture, heavy_picture = harness.golden(_LIGHT, reflections), harness.golden(heavy, reflections)

    async def underruns() -> int:
        return (await bus.read("status"))["underrun"]

    async def expect_in_time(picture: np.ndarray, what: str) -> None:
        harness.expect_picture(await monitor.frame(), picture, what)
        assert await underruns() == 0
        check_cycles(await bus.read("cycles"), configuration)

    await harness.reset()
    await harness.load(_LIGHT, reflections)
    await expect_in_time(light_picture, "the light scene")

    await harness.load(heavy, reflections)
    assert buffered_engine_of(configuration).group_cycles(configuration) > configuration.group_budget, (
        "this design cannot underrun"
    )
    _expect_abandoned_rows(harness, await monitor.frame(), heavy_picture, light_picture)
    assert await underruns() == 1
    assert (await bus.read("cycles"))["row"] == harness.screen.row_cycles, "a row ends when its time is over"
    await harness.load(_LIGHT, reflections)
    harness.expect_picture(await monitor.frame(), light_picture, "the light scene after the heavy one")
    await bus.write("status", underrun=0)
    assert await underruns() == 1, "underrun is sticky, and writing 0 must not clear it"
    await bus.write("status", underrun=1)
    assert await underruns() == 0, "writing 1 clears underrun"
    await bus.write("cycles")
    await expect_in_time(light_picture, "the light scene, one frame later")
    monitor.check_pins()


def _expect_abandoned_rows(harness: Harness, seen: np.ndarray, complete: np.ndarray, before: np.ndarray) -> None:
    """Check that each row is new up to some group of columns, and from there on shows its old half of the buffer."""
    screen, configuration = harness.screen, harness.configuration
    lengths = set()
    # The last rows that filled the halves completely are the last two of the previous frame.
    halves = [before[(screen.rows - 2 + half) * screen.doubling] for half in range(2)]
    for row in range(screen.rows):
        line = row * screen.doubling
        for groups in range(configuration.groups + 1):
            new = groups * configuration.units * screen.doubling
            if np.array_equal(seen[line], np.concatenate([complete[line, :new], halves[row % 2][new:]])):
                lengths.add(groups)
                break
        else:
            raise AssertionError(f"row {row}: expected new columns, then the old rest of its half of the buffer")
        assert (seen[line : line + screen.doubling] == seen[line]).all(), f"row {row}: its lines differ"
        halves[row % 2] = seen[line]
    assert max(lengths) > 0, "no group of columns was ever complete"
    assert min(lengths) < configuration.groups, "no row was abandoned"
