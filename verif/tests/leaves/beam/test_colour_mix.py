# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_mix`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.configuration import CHANNEL_BITS
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.colour_mix import colour_mix
from raycaster.rtl.common.widths import MIRROR_BITS


@pytest.mark.parametrize("behind", [0, 1, 3])
def test_colour_mix(behind, tmp_path, random):
    """Every mirror share, with channels at their limits and in between; the colour behind has fraction bits."""
    far_bits = CHANNEL_BITS + 2 * behind
    leaf = Leaf(colour_mix, lambda: ports(
        "clk", near=unsigned(CHANNEL_BITS), mirror=unsigned(MIRROR_BITS), far=unsigned(far_bits),
        mixed=unsigned(far_bits + 2)
    ), tmp_path)  # fmt: skip
    # The colour behind is at most 255, with no fraction.
    ends = [[near, far << 2 * behind] for near in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << 2 * behind) + 1], size=(400, 2)).tolist()]
    stimulus = [{"near": near, "mirror": mirror, "far": far} for near, far in pairs for mirror in range(5)]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, output in zip(stimulus, outputs[1:], strict=True):
        near, mirror, far = (inputs[name] for name in ("near", "mirror", "far"))
        assert output["mixed"] == (4 - mirror) * (near << 2 * behind) + mirror * far, inputs
