# SPDX-License-Identifier: MIT
"""Leaf tests of `camera_axis`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

from itertools import product

from vectors import STEP, ports, stepped

from raycaster.configuration import COORDINATE_BITS, WORLD_SIZE
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.system.camera_axis import camera_axis


def test_camera_axis(tmp_path, random):
    leaf = Leaf(camera_axis, lambda: ports(
        "clk reset move more less", start=unsigned(COORDINATE_BITS), position=unsigned(COORDINATE_BITS)
    ), tmp_path)  # fmt: skip
    stimulus = []
    walls = [*range(2 * STEP), *range(WORLD_SIZE - 2 * STEP, WORLD_SIZE)]
    for start, up in product(walls, (0, 1)):
        stimulus.append({"reset": 1, "start": start, "move": 1, "more": 1, "less": 0})
        stimulus.append({"reset": 0, "start": start, "move": 1, "more": up, "less": 1 - up})
        for _ in range(40):
            move, more, less = (int(random.random() < likely) for likely in (0.8, 0.5, 0.5))
            stimulus.append({"reset": 0, "start": start, "move": move, "more": more, "less": less})
    # Across the whole world and back, up to both walls.
    for more in (1, 0):
        stimulus += [{"reset": 0, "start": 0, "move": 1, "more": more, "less": 1 - more}] * (WORLD_SIZE // STEP + 3)
    position = 0
    for cycle, (inputs, output) in enumerate(zip(stimulus, leaf.run_both(stimulus, settled=1), strict=True)):
        if cycle:
            assert output == {"position": position}, cycle
        if inputs["reset"]:
            position = inputs["start"]
        elif inputs["move"]:
            position = stepped(position, inputs["more"], inputs["less"])
