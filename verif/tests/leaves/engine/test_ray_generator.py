# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_generator`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from unit_vectors import any_config
from vectors import AXES, config_id, ports

from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Place, Slope, Steps
from raycaster.rtl.common.records import Signs
from raycaster.rtl.common.widths import unit_bits
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.screens import VIEW_DISTANCE


@pytest.mark.parametrize(
    "config",
    [
        any_config(screen=screen, rows=rows, units=units)
        for screen, rows, units in (
            ("vga", 240, 1), ("vga", 240, 5), ("vga", 240, 32), ("vga", 240, 40), ("vga", 240, 320),
            ("vga", 200, 20), ("vga", 200, 64), ("tiny", 48, 1), ("tiny", 48, 16), ("tiny", 48, 64),
        )
    ],
    ids=config_id,
)  # fmt: skip
def test_ray_generator(config, tmp_path):
    leaf = Leaf(ray_generator, lambda: ports(
        "clk", steps=Steps(), place=Place(config), column_base=unsigned(unit_bits(config)), initial_signs=Signs(),
        slope=Slope(), config=config
    ), tmp_path)  # fmt: skip
    screen = config.screen_geometry
    horizon, last_row, last_column = screen.horizon_row, screen.rows - 1, screen.columns - 1
    rays = {(row, column) for row in (0, 1, horizon, last_row) for column in range(screen.columns)}
    rays |= {(row, column) for row in range(screen.rows) for column in (0, screen.centre_column, last_column)}
    stimulus = [
        {
            "place_row": row,
            "place_column_offset": column // config.units,
            "column_base": column % config.units,
            "steps_screen_to_ray": load,
        }
        for number, (row, column) in enumerate(sorted(rays))
        # Some rays are not loaded; the previous one must then stay.
        for load in ([1] if number % 8 == 0 else [0] if number % 8 == 1 else [0, 1])
    ]
    # The counters stop one past their last value, where nothing may overflow.
    stimulus.append({"place_row": screen.rows, "place_column_offset": config.groups, "column_base": config.units - 1})
    outputs = leaf.run_both(stimulus, settled=1)
    slopes = primary_slopes(screen)
    loaded = 0
    for inputs, output in zip(stimulus[:-1], outputs[1:], strict=True):
        if inputs["steps_screen_to_ray"]:
            loaded += 1
            column = inputs["place_column_offset"] * config.units + inputs["column_base"]
            slope = slopes[inputs["place_row"], column]
            expected = {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
            expected |= {f"initial_signs_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}
            assert expected["slope_dx"] == VIEW_DISTANCE
        assert output == expected, inputs
    assert loaded > len(rays) * 3 // 4
