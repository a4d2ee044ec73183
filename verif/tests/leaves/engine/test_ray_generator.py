# SPDX-License-Identifier: MIT
"""`ray_generator`: rays of whole rows and columns; some are not loaded, and the previous one must then stay."""

from vectors import designs, slope_inputs, unit_config

from raycaster.golden.rays import primary_slopes
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.screens import VIEW_DISTANCE


@designs(*(
    unit_config(screen=screen, rows=rows, units=units)
    for screen, rows, units in (
        ("vga", 240, 1), ("vga", 240, 5), ("vga", 240, 32), ("vga", 240, 40), ("vga", 240, 320),
        ("vga", 200, 20), ("vga", 200, 64), ("tiny", 48, 1), ("tiny", 48, 16), ("tiny", 48, 64),
    )
))  # fmt: skip
def test_ray_generator(config, leaf_of):
    leaf = leaf_of(ray_generator, config, slope=Slope)
    screen = config.screen_geometry
    rays = {(row, column) for row in (0, 1, screen.horizon_row, screen.rows - 1) for column in range(screen.columns)}
    rays |= {(row, column) for row in range(screen.rows) for column in (0, screen.centre_column, screen.columns - 1)}
    slopes, shown = primary_slopes(screen), None
    for number, (row, column) in enumerate(sorted(rays)):
        place = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        for load in [1] if number % 8 == 0 else [0] if number % 8 == 1 else [0, 1]:
            leaf.case({**place, "steps_screen_to_ray": load}, shown)
            shown = slope_inputs(slopes[row, column], "initial_signs") if load else shown
    assert shown["slope_dx"] == VIEW_DISTANCE
    # The counters stop one past their last value, where nothing may overflow.
    past = {"place_row": screen.rows, "place_column_offset": config.groups, "column_base": config.units - 1}
    leaf.case(past, shown)
    leaf.check(settled=1)
