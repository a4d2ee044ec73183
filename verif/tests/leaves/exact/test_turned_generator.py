# SPDX-License-Identifier: MIT
"""`turned_generator`: place and camera come a cycle before the ray is loaded; without a load, nothing changes."""

import numpy as np
from vectors import basis_inputs, designs, exact_config, slope_inputs

from raycaster.rtl.exact.turned_generator import turned_generator
from raycaster.verif.random_world import random_basis


@designs(*(exact_config(turn=True, units=n, screen=screen) for n, screen in ((4, "vga"), (5, "vga"), (2, "tiny"))))
def test_turned_generator(config, leaf_of, random):
    leaf, screen, shown = leaf_of(turned_generator, config), config.screen_geometry, None
    for number in range(500):
        basis = random_basis(random)
        row = int(random.choice([0, screen.horizon_row, screen.rows - 1, random.integers(screen.rows)]))
        column = int(random.choice([0, screen.centre_column, screen.columns - 1, random.integers(screen.columns)]))
        load = int(number == 0 or random.random() < 0.8)
        held = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held |= basis_inputs(basis)
        for strobe in (0, load):
            leaf.case({**held, "steps_screen_to_ray": strobe}, shown)
        if load:
            place = [screen.view_distance, column - screen.centre_column, screen.horizon_row - row]
            shown = slope_inputs(np.array(place) @ np.array(basis), "initial_signs")
    # The counters stop one past their last value, where nothing may overflow.
    leaf.case({**held, "place_row": screen.rows, "place_column_offset": config.groups}, shown)
    leaf.check(settled=2)
