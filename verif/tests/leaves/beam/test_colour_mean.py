# SPDX-License-Identifier: MIT
"""Leaf test of `colour_mean`: channels at their limits and in between; the colour behind has fraction bits."""

from vectors import by

from raycaster.configuration import CHANNEL_BITS, MOST_REFLECTIONS
from raycaster.rtl.beam.colour_mean import colour_mean


@by(behind=[0, 1, 3])
def test_colour_mean(behind, leaf_of, random):
    far_bits, number = CHANNEL_BITS + behind, 3 - behind
    widths = {"own": CHANNEL_BITS, "behind": far_bits, "reflections": 3, "mean": far_bits + 1}
    leaf = leaf_of(colour_mean, **widths, number=number)
    ends = [[own, far << behind] for own in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << behind) + 1], size=(200, 2)).tolist()]
    for own, far in pairs:
        # With fewer reflections than number, the mean is don't care.
        for depth in range(number, MOST_REFLECTIONS + 1):
            mean = (own << behind) + (far if depth > number else own << behind)
            leaf.case({"own": own, "behind": far, "reflections": depth}, {"mean": mean})
    leaf.check()
