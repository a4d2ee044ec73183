# SPDX-License-Identifier: MIT
"""Leaf test of `camera_axis`: steps near both walls, and across the whole world and back."""

from itertools import product

from vectors import STEP, stepped

from raycaster.configuration import COORDINATE_BITS, WORLD_SIZE
from raycaster.rtl.system.camera_axis import camera_axis


def test_camera_axis(leaf_of, random):
    leaf = leaf_of(camera_axis, start=COORDINATE_BITS, position=COORDINATE_BITS)
    cases = []
    walls = [*range(2 * STEP), *range(WORLD_SIZE - 2 * STEP, WORLD_SIZE)]
    for start, up in product(walls, (0, 1)):
        cases += [(1, start, 1, 1, 0), (0, start, 1, up, 1 - up)]
        cases += [(0, start, *(int(random.random() < likely) for likely in (0.8, 0.5, 0.5))) for _ in range(40)]
    for more in (1, 0):
        cases += [(0, 0, 1, more, 1 - more)] * (WORLD_SIZE // STEP + 3)
    position = 0
    for case in cases:
        leaf.case(dict(zip(("reset", "start", "move", "more", "less"), case, strict=True)), {"position": position})
        reset, start, move, more, less = case
        if reset:
            position = start
        elif move:
            position = stepped(position, more, less)
    leaf.check(settled=1)
