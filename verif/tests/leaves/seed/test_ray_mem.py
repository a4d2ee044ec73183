# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_mem`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from unit_vectors import any_config
from vectors import AXES, ports

from raycaster.golden.random_world import EXTREMES
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.records import Origin, Ray
from raycaster.rtl.common.widths import AXIS_BITS, position_bits
from raycaster.rtl.seed.ray_mem import ray_mem

fractions = pytest.mark.parametrize(
    "config", [any_config(fraction_bits=bits) for bits in (0, 3, 8)], ids=lambda config: f"F{config.fraction_bits}"
)


@fractions
def test_ray_mem(config, tmp_path, random):
    leaf = Leaf(ray_mem, lambda: ports(
        "clk", steps=Steps(), found_axis=unsigned(AXIS_BITS), found_point=Origin(config), ray=Ray(config),
        reflected=Ray(config)
    ), tmp_path)  # fmt: skip
    values = [*EXTREMES, (1 << position_bits(config)) - 1]
    stimulus = [
        {
            "steps_store_ray": int(number == 0 or random.random() < 0.7),
            "found_axis": number % 3,
            **{f"found_point_{axis}": int(random.choice(values)) for axis in AXES},
            **{f"ray_d{axis}": int(random.integers(2)) for axis in AXES},
            **{f"ray_{axis}": int(random.choice(values)) for axis in AXES},
        }
        for number in range(300)
    ]
    outputs = leaf.run_both(stimulus, settled=1)
    for inputs, output in zip(stimulus[:-1], outputs[1:], strict=True):
        if inputs["steps_store_ray"]:
            expected = {f"reflected_{axis}": inputs[f"found_point_{axis}"] for axis in AXES}
            for number, axis in enumerate(AXES):
                expected[f"reflected_d{axis}"] = inputs[f"ray_d{axis}"] ^ (inputs["found_axis"] == number)
        assert output == expected, inputs
