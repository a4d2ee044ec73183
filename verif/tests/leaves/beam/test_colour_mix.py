# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_mix`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import check, leaf_of

from raycaster.configuration import CHANNEL_BITS
from raycaster.rtl.beam.colour_mix import colour_mix
from raycaster.rtl.common.widths import MIRROR_BITS


@pytest.mark.parametrize("behind", [0, 1, 3])
def test_colour_mix(behind, tmp_path, random):
    """Every mirror share, with channels at their limits and in between; the colour behind has fraction bits."""
    far_bits = CHANNEL_BITS + 2 * behind
    leaf = leaf_of(colour_mix, tmp_path, near=CHANNEL_BITS, mirror=MIRROR_BITS, far=far_bits, mixed=far_bits + 2)
    # The colour behind is at most 255, with no fraction.
    ends = [[near, far << 2 * behind] for near in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << 2 * behind) + 1], size=(400, 2)).tolist()]
    cases = [(near, mirror, far) for near, far in pairs for mirror in range(5)]
    mixed = [(4 - mirror) * (near << 2 * behind) + mirror * far for near, mirror, far in cases]
    stimulus = [dict(zip(("near", "mirror", "far"), case, strict=True)) for case in cases]
    check(leaf, stimulus, [{"mixed": value} for value in mixed], latency=1)
