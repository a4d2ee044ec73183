# SPDX-License-Identifier: MIT
"""`colour_mix`: every mirror share, with channels at their limits and between; the colour behind has fraction bits."""

from vectors import by

from raycaster.configuration import CHANNEL_BITS
from raycaster.rtl.beam.colour_mix import colour_mix
from raycaster.rtl.common.widths import MIRROR_BITS


@by(behind=[0, 1, 3])
def test_colour_mix(behind, leaf_of, random):
    far_bits = CHANNEL_BITS + 2 * behind
    leaf = leaf_of(colour_mix, near=CHANNEL_BITS, mirror=MIRROR_BITS, far=far_bits, mixed=far_bits + 2)
    # The colour behind is at most 255, with no fraction.
    ends = [[near, far << 2 * behind] for near in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << 2 * behind) + 1], size=(400, 2)).tolist()]
    for near, far in pairs:
        for mirror in range(5):
            mixed = (4 - mirror) * (near << 2 * behind) + mirror * far
            leaf.case({"near": near, "mirror": mirror, "far": far}, {"mixed": mixed})
    leaf.check(latency=1)
