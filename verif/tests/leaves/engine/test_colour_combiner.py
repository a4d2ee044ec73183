# SPDX-License-Identifier: MIT
"""Leaf test of `colour_combiner`: pixels of a ray and its reflections, which hit or miss."""

import numpy as np
from arithmetic_vectors import plain_shares
from hard_scenes import pixel_ports
from vectors import by, colour_word, unit_config

from raycaster.rtl.engine.colour_combiner import colour_combiner


@by(colour_bits=[1, 4, 8], reflections=[0, 1, 2, 4], materials=[False, True])
def test_colour_combiner(colour_bits, reflections, materials, leaf_of, random):
    config = unit_config(colour_bits=colour_bits, reflections=reflections, materials=materials)
    leaf = leaf_of(colour_combiner, config)
    for _ in range(200):
        run_time = int(random.integers(reflections + 1))
        palette = random.choice([0, 1, 255, 128, *random.integers(256, size=4)], (run_time + 2, 3)).astype(np.uint8)
        *words, background = map(colour_word, palette)
        held = {"picture_background": background, "steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
        leaf.case({**held, "steps_reset_colour": 1})
        # Whether each ray hits something, and how many quarters of that are mirror.
        hits = [(bool(random.random() < 0.75), int(random.integers(5))) for _ in words]
        hits = hits if materials else [(found, 2) for found, _ in hits]
        # After its end a ray continues and may find something, which must not count.
        for number, ((found, quarters), word) in enumerate(zip(hits, words, strict=True)):
            ray = {**held, "found": found, "found_colour": word, "found_mirror": quarters}
            # Only the hit in the cycle of the addition counts.
            leaf.stimulus += [{**ray, "found": random.integers(2)}] * int(random.integers(2))
            leaf.case({**ray, "steps_add_colour": 1, "steps_store_ray": number < run_time})
            if number < run_time or not materials:
                missed = any(not found or quarters == 0 for found, quarters in hits[: number + 1])
                leaf.expected[leaf.cycle]["missed"] = missed
        seen = [palette[number] if found else palette[-1] for number, (found, _) in enumerate(hits)]
        pixel = sum(share * colour.astype(object) for share, colour in zip(plain_shares(hits), seen, strict=True))
        leaf.expected[leaf.cycle] |= pixel_ports(config, pixel)
        leaf.case({**held, "found": random.integers(2)})
    leaf.check(settled=1, spare=True)
