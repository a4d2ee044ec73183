# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_mean`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import check, leaf_of

from raycaster.configuration import CHANNEL_BITS, MOST_REFLECTIONS
from raycaster.rtl.beam.colour_mean import colour_mean


@pytest.mark.parametrize("behind", [0, 1, 3])
def test_colour_mean(behind, tmp_path, random):
    """Channels at their limits and in between; the colour behind has fraction bits."""
    far_bits, number = CHANNEL_BITS + behind, 3 - behind
    widths = {"own": CHANNEL_BITS, "behind": far_bits, "reflections": 3, "mean": far_bits + 1}
    ends = [[own, far << behind] for own in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << behind) + 1], size=(200, 2)).tolist()]
    # With fewer reflections than number, the mean is don't care.
    cases = [(own, far, depth) for own, far in pairs for depth in range(number, MOST_REFLECTIONS + 1)]
    stimulus = [{"own": own, "behind": far, "reflections": depth} for own, far, depth in cases]
    means = [(own << behind) + (far if depth > number else own << behind) for own, far, depth in cases]
    check(leaf_of(colour_mean, tmp_path, **widths, number=number), stimulus, [{"mean": mean} for mean in means])
