# SPDX-License-Identifier: MIT
"""Leaf tests of `turned_generator`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from exact_vectors import basis_inputs, exact_config, slope_inputs
from vectors import config_id, ports

from raycaster.golden.random_world import random_basis
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Place, Slope, Steps
from raycaster.rtl.common.records import Signs, camera_of
from raycaster.rtl.common.widths import exact_slope_bits, unit_bits
from raycaster.rtl.exact.turned_generator import turned_generator


@pytest.mark.parametrize(
    "config",
    [exact_config(turn=True, units=units, screen=screen) for units, screen in ((4, "vga"), (5, "vga"), (2, "tiny"))],
    ids=config_id,
)
def test_turned_generator(config, tmp_path, random):
    """Place and camera come a cycle before the ray is loaded; a ray that is not loaded changes nothing."""
    leaf = Leaf(turned_generator, lambda: ports(
        "clk", steps=Steps(), place=Place(config), column_base=unsigned(unit_bits(config)), camera=camera_of(config),
        initial_signs=Signs(), slope=Slope(exact_slope_bits(config)), config=config
    ), tmp_path)  # fmt: skip
    screen = config.screen_geometry
    stimulus, expected, slope = [], [], None
    for number in range(500):
        basis = random_basis(random)
        row = int(random.choice([0, screen.horizon_row, screen.rows - 1, random.integers(screen.rows)]))
        column = int(random.choice([0, screen.centre_column, screen.columns - 1, random.integers(screen.columns)]))
        load = int(number == 0 or random.random() < 0.8)
        held = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held |= basis_inputs(basis)
        for strobe in (0, load):
            stimulus.append({**held, "steps_screen_to_ray": strobe})
            expected.append(slope)
        if load:
            place = [screen.view_distance, column - screen.centre_column, screen.horizon_row - row]
            slope = np.array(place) @ np.array(basis)
    # The counters stop one past their last value, where nothing may overflow.
    stimulus.append({**held, "place_row": screen.rows, "place_column_offset": config.groups})
    expected.append(slope)
    outputs = leaf.run_both(stimulus, settled=2)
    for cycle, wanted in enumerate(expected):
        assert wanted is None or outputs[cycle] == slope_inputs(wanted, "initial_"), stimulus[cycle - 1]
