# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_mean`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.configuration import CHANNEL_BITS, MOST_REFLECTIONS
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.colour_mean import colour_mean


@pytest.mark.parametrize("behind", [0, 1, 3])
def test_colour_mean(behind, tmp_path, random):
    """Channels at their limits and in between; the colour behind has fraction bits."""
    far_bits, number = CHANNEL_BITS + behind, 3 - behind
    leaf = Leaf(colour_mean, lambda: ports(
        "", own=unsigned(CHANNEL_BITS), behind=unsigned(far_bits), reflections=unsigned(3),
        mean=unsigned(far_bits + 1), number=number
    ), tmp_path)  # fmt: skip
    ends = [[own, far << behind] for own in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << behind) + 1], size=(200, 2)).tolist()]
    # With fewer reflections than number, the mean is don't care.
    depths = range(number, MOST_REFLECTIONS + 1)
    stimulus = [{"own": own, "behind": far, "reflections": depth} for own, far in pairs for depth in depths]
    for inputs, output in zip(stimulus, leaf.run_both(stimulus), strict=True):
        own = inputs["own"] << behind
        assert output["mean"] == own + (inputs["behind"] if inputs["reflections"] > number else own), inputs
