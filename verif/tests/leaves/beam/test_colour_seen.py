# SPDX-License-Identifier: MIT
"""`colour_seen`: the background if this ray or one before it found nothing; a mirror only where reflections follow."""

from beam_vectors import beam_config
from vectors import by

from raycaster.configuration import MOST_REFLECTIONS
from raycaster.rtl.beam.colour_seen import colour_seen
from raycaster.rtl.common.records import Shade
from raycaster.rtl.common.widths import RGB_BITS


@by(number=[0, 1, 3], materials=[False, True])
def test_colour_seen(materials, number, leaf_of, random):
    config = beam_config(reflections=4, materials=materials)
    leaf = leaf_of(colour_seen, config, shade=lambda: Shade(config), number=number)
    shade = {}
    for _ in range(400):
        reached, hit = int(random.integers(2)), int(random.random() < 0.7)
        colour, mirror = random.integers(1 << RGB_BITS), random.integers(1, 5) if materials else 0
        background = random.integers(1 << RGB_BITS)
        reflections = int(random.integers(MOST_REFLECTIONS + 1)) if materials else 0
        picture = {"picture_background": background, "picture_reflections": reflections}
        found = {"seen_found": hit, "seen_colour": colour, "seen_mirror": mirror}
        leaf.case({"reached": reached, **found, **picture}, shade | {"found": reached and hit})
        seen = int(colour if reached and hit else background).to_bytes(3)
        shade = dict(zip(("shade_red", "shade_green", "shade_blue"), seen, strict=True))
        shade |= {"shade_mirror": mirror if reflections > number else 0} if materials else {}
    leaf.case({}, shade)
    leaf.check(settled=1, spare=True)
