# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_seen`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import beam_config
from vectors import check, driven, leaf_of

from raycaster.configuration import MOST_REFLECTIONS
from raycaster.rtl.beam.colour_seen import colour_seen
from raycaster.rtl.common.records import shade_of
from raycaster.rtl.common.widths import RGB_BITS


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("number", [0, 1, 3])
def test_colour_seen(materials, number, tmp_path, random):
    """The background if this ray or one before it found nothing; a mirror only where reflections follow."""
    config = beam_config(reflections=4, materials=materials)
    leaf = leaf_of(colour_seen, tmp_path, config, shade=lambda: shade_of(config), number=number)
    stimulus, expected, shade = [], [], {}
    for _ in range(400):
        reached, hit = int(random.integers(2)), int(random.random() < 0.7)
        colour, mirror = random.integers(1 << RGB_BITS), random.integers(1, 5) if materials else 0
        background = random.integers(1 << RGB_BITS)
        reflections = int(random.integers(MOST_REFLECTIONS + 1)) if materials else 0
        stimulus.append({
            "reached": reached, "seen_found": hit, "seen_colour": colour, "seen_mirror": mirror,
            "picture_background": background, "picture_reflections": reflections,
        })  # fmt: skip
        expected.append(shade | {"found": reached and hit})
        seen = int(colour if reached and hit else background).to_bytes(3)
        shade = dict(zip(("shade_red", "shade_green", "shade_blue"), seen, strict=True))
        shade |= {"shade_mirror": mirror if reflections > number else 0} if materials else {}
    check(leaf, driven(leaf, [*stimulus, {}]), [*expected, shade], settled=1)
