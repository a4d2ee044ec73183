# SPDX-License-Identifier: MIT
"""Leaf tests of `slope_component`: MyHDL and converted Verilog match the expected values on the same vectors."""

from exact_vectors import exact_config
from vectors import ports

from raycaster.golden.random_world import random_basis
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.widths import exact_slope_bits, unit_bits
from raycaster.rtl.exact.slope_component import slope_component


def test_slope_component(tmp_path, random):
    config = exact_config(turn=True, units=8)
    screen = config.screen_geometry
    leaf = Leaf(slope_component, lambda: ports(
        "clk negative", steps=Steps(), **{name: signed(10) for name in ("forward", "right", "up", "column", "row")},
        column_base=unsigned(unit_bits(config)), size=unsigned(exact_slope_bits(config)), config=config
    ), tmp_path)  # fmt: skip
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
            expected.append(component)
        if load:
            across = given["column"] + given["column_base"]
            component = screen.view_distance * forward + across * right + given["row"] * up
    outputs = leaf.run_both([*stimulus, {"steps_screen_to_ray": 0}], settled=2)
    for cycle, wanted in enumerate([*expected, component]):
        if cycle >= 2:
            assert (outputs[cycle]["size"], outputs[cycle]["negative"]) == (abs(wanted), int(wanted < 0))
