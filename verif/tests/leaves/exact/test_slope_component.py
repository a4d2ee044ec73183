# SPDX-License-Identifier: MIT
"""Leaf test of `slope_component`: random bases and places; a place that is not loaded changes nothing."""

from vectors import exact_config

from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.exact.slope_component import slope_component
from raycaster.verif.random_world import random_basis


def test_slope_component(leaf_of, random):
    config = exact_config(turn=True, units=8)
    screen = config.screen_geometry
    widths = dict.fromkeys(("forward", "right", "up", "column", "row"), Signed(10))
    leaf = leaf_of(slope_component, config, **widths, size=exact_slope_bits(config))
    component = 0
    for _ in range(1000):
        forward, right, up = (int(value) for value in random_basis(random)[0])
        column = int(random.choice([0, screen.columns - config.units, random.integers(screen.columns)]))
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        given = {"column": column - screen.centre_column, "row": screen.horizon_row - row}
        given |= {"column_base": int(random.integers(config.units)), "forward": forward, "right": right, "up": up}
        load = int(not leaf.stimulus or random.random() < 0.8)
        for strobe in (0, load):
            leaf.case({**given, "steps_screen_to_ray": strobe}, {"size": abs(component), "negative": component < 0})
        if load:
            across = given["column"] + given["column_base"]
            component = screen.view_distance * forward + across * right + given["row"] * up
    leaf.case({"steps_screen_to_ray": 0}, {"size": abs(component), "negative": component < 0})
    leaf.check(settled=2)
