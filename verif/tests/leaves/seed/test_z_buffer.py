# SPDX-License-Identifier: MIT
"""Leaf tests of `z_buffer`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from unit_vectors import any_config
from vectors import AXES, config_id, ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unconnected, unsigned
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.records import Origin, rect_of
from raycaster.rtl.common.widths import AXIS_BITS, MIRROR_BITS, RGB_BITS, position_bits
from raycaster.rtl.seed.z_buffer import z_buffer


@pytest.mark.parametrize(
    "config",
    [any_config(), any_config(fraction_bits=8), any_config(materials=True), any_config(fraction_bits=3, patterns=True)],
    ids=config_id,
)
def test_z_buffer(config, tmp_path, random):
    width = position_bits(config)
    kept_words = ["found_axis", "found_colour", *(["found_mirror"] if config.materials else [])]
    leaf = Leaf(z_buffer, lambda: ports(
        "clk hit found", steps=Steps(), offered=rect_of(config), colour=unsigned(RGB_BITS), depth=unsigned(width),
        point=Origin(config), found_axis=unsigned(AXIS_BITS), found_colour=unsigned(RGB_BITS),
        found_mirror=unsigned(MIRROR_BITS) if config.materials else unconnected(MIRROR_BITS),
        found_point=Origin(config), config=config
    ), tmp_path)  # fmt: skip
    limit = (1 << width) - 1
    stimulus = [{"steps_reset_z_buf": 1}]
    for number in range(1500):
        # Few depths, so that many tie; the first hit makes all registers known.
        depth = random.choice([0, 1, 255, 256, limit - 1, limit, random.integers(limit)])
        write = number == 0 or random.random() < 0.7
        stimulus.append(
            {
                "steps_reset_z_buf": int(number > 0 and random.random() < 0.15),
                "steps_write_z_buf": int(write),
                "hit": int(number == 0 or random.random() < 0.7),
                "depth": int(depth),
                "offered_axis": int(random.integers(3)),
                "colour": int(random.integers(1 << RGB_BITS)),
                **({"offered_mirror": int(random.integers(5))} if config.materials else {}),
                **{f"point_{axis}": int(random.integers(limit + 1)) for axis in AXES},
            }
        )
    outputs = leaf.run_both(stimulus, settled=2)
    kept = None
    for cycle, (inputs, output) in enumerate(zip(stimulus[1:], outputs[1:], strict=True)):
        assert output["found"] == (kept is not None), cycle
        if kept is not None:
            for name in kept_words:
                of_port = name.replace("found", "offered")
                assert output[name] == kept["colour" if name == "found_colour" else of_port], cycle
            for axis in AXES:
                assert output[f"found_point_{axis}"] == kept[f"point_{axis}"], cycle
        if inputs["steps_reset_z_buf"]:
            kept = None
        elif inputs["steps_write_z_buf"] and inputs["hit"] and (kept is None or inputs["depth"] < kept["depth"]):
            kept = inputs
