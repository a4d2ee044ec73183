# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_combiner`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from hard_scenes import pixel_ports
from unit_vectors import plain_shares, unit_config
from vectors import check, colour_word, driven, leaf_of

from raycaster.hdl.signals import tied
from raycaster.rtl.common.widths import MIRROR_BITS, RGB_BITS
from raycaster.rtl.engine.colour_combiner import colour_combiner


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
def test_colour_combiner(colour_bits, reflections, materials, tmp_path, random):
    """Pixels of a ray and its reflections, each of which hits something or not."""
    config = unit_config(colour_bits=colour_bits, reflections=reflections, materials=materials)
    mirror = MIRROR_BITS if materials else lambda: tied(0, MIRROR_BITS)
    leaf = leaf_of(colour_combiner, tmp_path, config, found_colour=RGB_BITS, found_mirror=mirror)
    stimulus, expected = [], {}
    for _ in range(200):
        run_time = int(random.integers(reflections + 1))
        palette = random.choice([0, 1, 255, 128, *random.integers(256, size=4)], (run_time + 2, 3)).astype(np.uint8)
        *words, background = map(colour_word, palette)
        held = {"picture_background": background, "steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
        stimulus.append({**held, "steps_reset_colour": 1})
        # Whether each ray hits something, and how many quarters of that are mirror.
        hits = [(bool(random.random() < 0.75), int(random.integers(5))) for _ in words]
        hits = hits if materials else [(found, 2) for found, _ in hits]
        # After its end a ray continues and may find something, which must not count.
        for number, ((found, quarters), word) in enumerate(zip(hits, words, strict=True)):
            ray = {**held, "found": found, "found_colour": word, "found_mirror": quarters}
            # Only the hit in the cycle of the addition counts.
            stimulus += [{**ray, "found": random.integers(2)}] * int(random.integers(2))
            stimulus.append({**ray, "steps_add_colour": 1, "steps_store_ray": number < run_time})
            if number < run_time or not materials:
                missed = any(not found or quarters == 0 for found, quarters in hits[: number + 1])
                expected[len(stimulus)] = {"missed": missed}
        seen = [palette[number] if found else palette[-1] for number, (found, _) in enumerate(hits)]
        pixel = sum(share * colour.astype(object) for share, colour in zip(plain_shares(hits), seen, strict=True))
        expected[len(stimulus)] = expected.get(len(stimulus), {}) | pixel_ports(config, pixel)
        stimulus.append({**held, "found": random.integers(2)})
    check(leaf, driven(leaf, stimulus), expected, settled=1)
