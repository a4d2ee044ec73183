# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_seen`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import beam_config
from vectors import ports

from raycaster.configuration import MOST_REFLECTIONS
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.colour_seen import colour_seen
from raycaster.rtl.common.interfaces import Picture
from raycaster.rtl.common.records import seen_of, shade_of
from raycaster.rtl.common.widths import RGB_BITS


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("number", [0, 1, 3])
def test_colour_seen(materials, number, tmp_path, random):
    """The background if this ray or one before it found nothing; a mirror only where reflections follow."""
    config = beam_config(reflections=4, materials=materials)
    leaf = Leaf(colour_seen, lambda: ports(
        "clk reached found", seen=seen_of(config), picture=Picture(), shade=shade_of(config), number=number
    ), tmp_path)  # fmt: skip
    stimulus = [
        {
            "reached": int(random.integers(2)),
            "seen_found": int(random.random() < 0.7),
            "seen_colour": int(random.integers(1 << RGB_BITS)),
            **({"seen_mirror": int(random.integers(1, 5))} if materials else {}),
            "picture_background": int(random.integers(1 << RGB_BITS)),
            **({"picture_reflections": int(random.integers(MOST_REFLECTIONS + 1))} if materials else {}),
        }
        for _ in range(400)
    ]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, now, then in zip(stimulus, outputs, outputs[1:], strict=False):
        found = inputs["reached"] and inputs["seen_found"]
        assert now["found"] == found, inputs
        colour = inputs["seen_colour" if found else "picture_background"].to_bytes(3)
        assert bytes(then[f"shade_{channel}"] for channel in ("red", "green", "blue")) == colour, inputs
        if materials:
            goes_on = inputs["picture_reflections"] > number
            assert then["shade_mirror"] == (inputs["seen_mirror"] if goes_on else 0), inputs
