# SPDX-License-Identifier: MIT
"""Leaf tests of `camera_axis`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

from vectors import STEP, check, leaf_of, stepped

from raycaster.configuration import COORDINATE_BITS, WORLD_SIZE
from raycaster.rtl.system.camera_axis import camera_axis


def test_camera_axis(tmp_path, random):
    """Steps near both walls, and across the whole world and back."""
    leaf = leaf_of(camera_axis, tmp_path, start=COORDINATE_BITS, position=COORDINATE_BITS)
    cases = []
    walls = [*range(2 * STEP), *range(WORLD_SIZE - 2 * STEP, WORLD_SIZE)]
    for start, up in product(walls, (0, 1)):
        cases += [(1, start, 1, 1, 0), (0, start, 1, up, 1 - up)]
        cases += [(0, start, *(int(random.random() < likely) for likely in (0.8, 0.5, 0.5))) for _ in range(40)]
    for more in (1, 0):
        cases += [(0, 0, 1, more, 1 - more)] * (WORLD_SIZE // STEP + 3)
    expected, position = [], 0
    for reset, start, move, more, less in cases:
        expected.append({"position": position})
        if reset:
            position = start
        elif move:
            position = stepped(position, more, less)
    stimulus = [dict(zip(("reset", "start", "move", "more", "less"), case, strict=True)) for case in cases]
    check(leaf, stimulus, expected, settled=1)
