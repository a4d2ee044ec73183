# SPDX-License-Identifier: MIT
"""Leaf tests of `row_slope` and `slope_start`: the slope of the first column of each row of a screen."""

from __future__ import annotations

import pytest
from span_vectors import span_config
from vectors import basis_inputs, by_axis

from raycaster.golden.rays import primary_slopes
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.widths import span_slope_bits
from raycaster.rtl.span.row_slope import row_slope
from raycaster.rtl.span.slope_start import slope_start
from raycaster.scene import UNTURNED
from raycaster.verif.random_world import random_basis

DESIGNS = [{"screen": "tiny"}, {"screen": "tiny", "turn": True}, {"rows": 180, "scale": 3, "turn": True}]


@pytest.mark.parametrize("options", DESIGNS, ids=str)
def test_row_slope(options, leaf_of, random):
    config = span_config(**options)
    leaf, screen = leaf_of(row_slope, config, slope=lambda: Vector(span_slope_bits(config))), config.screen_geometry
    for frame in range(2 if screen.rows > 100 else 6):
        basis = random_basis(random) if config.turn else UNTURNED
        if frame == 1 and config.turn:
            basis = ((-512, 511, -512),) * 3
        leaf.stimulus += [basis_inputs(basis) | {"next_row": 0}, {"first_row": 1}, {"first_row": 0}]
        for slope in primary_slopes(screen, basis)[:, 0].tolist():
            wait = int(random.integers(3))
            leaf.stimulus += [{"next_row": 0}] * wait
            leaf.case({"next_row": 1}, by_axis("slope_", slope))
    leaf.check(settled=3, spare=True)


def test_slope_start(leaf_of, random):
    config = span_config(screen="tiny", turn=True)
    bits = {"forward": Signed(10), "right": Signed(10), "up": Signed(10), "component": Signed(span_slope_bits(config))}
    leaf, screen = leaf_of(slope_start, config, **bits), config.screen_geometry
    for _ in range(8):
        forward, right, up = random.choice([-512, 511, *random.integers(-512, 512, 3)], 3).tolist()
        leaf.stimulus += [
            {"forward": forward, "right": right, "up": up, "next_row": 0},
            {"first_row": 1},
            {"first_row": 0},
        ]
        for row in range(screen.rows):
            slope = screen.view_distance * forward - screen.centre_column * right + (screen.horizon_row - row) * up
            leaf.case({"next_row": 1}, {"component": slope})
    leaf.check(settled=3)
