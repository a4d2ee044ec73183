# SPDX-License-Identifier: MIT
"""Leaf tests of `slope_component`: MyHDL and converted Verilog match the expected values on the same vectors."""

from exact_vectors import exact_config
from vectors import check, leaf_of

from raycaster.golden.random_world import random_basis
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.exact.slope_component import slope_component


def test_slope_component(tmp_path, random):
    """Random bases and places; a place that is not loaded changes nothing."""
    config = exact_config(turn=True, units=8)
    screen = config.screen_geometry
    widths = dict.fromkeys(("forward", "right", "up", "column", "row"), Signed(10))
    leaf = leaf_of(slope_component, tmp_path, config, **widths, size=exact_slope_bits(config))
    stimulus, expected, component = [], [], 0
    for _ in range(1000):
        forward, right, up = (int(value) for value in random_basis(random)[0])
        column = int(random.choice([0, screen.columns - config.units, random.integers(screen.columns)]))
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        given = {"column": column - screen.centre_column, "row": screen.horizon_row - row}
        given |= {"column_base": int(random.integers(config.units)), "forward": forward, "right": right, "up": up}
        load = int(not stimulus or random.random() < 0.8)
        for strobe in (0, load):
            stimulus.append({**given, "steps_screen_to_ray": strobe})
            expected.append({"size": abs(component), "negative": component < 0})
        if load:
            across = given["column"] + given["column_base"]
            component = screen.view_distance * forward + across * right + given["row"] * up
    expected.append({"size": abs(component), "negative": component < 0})
    check(leaf, [*stimulus, {"steps_screen_to_ray": 0}], expected, settled=2)
