# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that make a pixel's colour from those that its rays find."""

from itertools import product

import numpy as np
import pytest
from arithmetic_vectors import cases, plain_shares
from hard_scenes import pixel_ports
from vectors import by, colour_word, named, unit_config

from raycaster.configuration import CHANNEL_BITS
from raycaster.design.decide import configure
from raycaster.rtl.common.records import Colour, Look
from raycaster.rtl.common.widths import RGB_BITS, SHADE_BITS, share_bits
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.colour_share import colour_share
from raycaster.rtl.engine.colour_sum import colour_sum
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.rtl.engine.quarters_of import QUARTERS_BITS, quarters_of
from raycaster.rtl.engine.shade_colour import shade_colour
from raycaster.scene import PATTERNS


def test_pattern_colour(leaf_of, random):
    """Every pattern in every kind of cell, with two complementary colours and random ones."""
    leaf = leaf_of(pattern_colour, look=lambda: Look(configure(materials=True, patterns=True)), colour=RGB_BITS)
    for kind, odd_u, odd_v in product(range(len(PATTERNS)), range(2), range(2)):
        second = (0, (odd_u + odd_v) % 2, odd_v, odd_u)[kind]
        for colours in ((0, (1 << RGB_BITS) - 1), ((1 << RGB_BITS) - 1, 0), random.integers(1 << RGB_BITS, size=2)):
            look = {"kind": kind, "colour": colours[0], "colour_2": colours[1]}
            look |= {"mirror": random.integers(5), "cell": random.integers(8)}
            leaf.case({**named("look", look), "odd_u": odd_u, "odd_v": odd_v}, {"colour": colours[second]})
    leaf.check()


@by(width=[3, 8, 9])
def test_quarters_of(width, leaf_of):
    leaf = leaf_of(quarters_of, whole=width, quarters=QUARTERS_BITS, share=width)
    for whole, quarters in product(range(1 << width), range(5)):
        leaf.case({"whole": whole, "quarters": quarters}, {"share": whole * quarters // 4})
    leaf.check()


def test_shade_colour(leaf_of):
    """Every value of a channel with every shade; the three channels have different values."""
    leaf = leaf_of(shade_colour, colour=Colour, shade=SHADE_BITS, shaded=RGB_BITS)
    for value, shade, dark in product(range(256), range(4), (0, 1)):
        colour = (value, 255 - value, value ^ 0x5A)
        channels = dict(zip(("colour_red", "colour_green", "colour_blue"), colour, strict=True))
        shaded = bytes(shade * channel // 4 if dark else channel for channel in colour)
        leaf.case({**channels, "dark": dark, "shade": shade}, {"shaded": int.from_bytes(shaded)})
    leaf.check()


@by(reflections=[0, 1, 2, 4], materials=[False, True])
def test_colour_share(reflections, materials, leaf_of, random):
    """Every mirror after every other one, with misses in between."""
    config = unit_config(reflections=reflections, materials=materials)
    leaf = leaf_of(colour_share, config)
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
    one_ray = list(product((False, True), range(5) if materials else [2]))
    whole = 1 << (share_bits(config) - 1)
    for run_time in range(reflections + 1):
        for hits in cases(random, run_time, one_ray):
            leaf.case({**idle, "steps_reset_colour": 1})
            missed = False
            # Without materials, the background of a miss gets the weight of all that would have followed.
            weighing = hits if materials else [(True, 2)] * len(hits)
            for number, ((found, quarters), share) in enumerate(zip(hits, plain_shares(weighing), strict=True)):
                # Only the hit in the cycle of the addition counts.
                other = {"found": random.integers(2), "found_mirror": random.integers(5)}
                leaf.stimulus += [{**idle, **other}] * int(random.integers(2))
                ray = {"found": found, "found_mirror": quarters, "steps_store_ray": number < run_time}
                leaf.case({**idle, **ray, "steps_add_colour": 1}, {"share": share * whole, "missed": missed})
                missed = missed or not found or quarters == 0
            if run_time < reflections:
                leaf.case(idle)
    leaf.check(settled=1, spare=True)


@pytest.mark.slow_sets("1", "8")
@by(colour_bits=[1, 4, 8], reflections=[0, 1, 2, 4], materials=[False, True])
def test_colour_sum(colour_bits, reflections, materials, leaf_of, random):
    """All shares that a pixel's rays may have; with many reflections, a random choice."""
    config = unit_config(reflections=reflections, colour_bits=colour_bits, materials=materials)
    leaf = leaf_of(colour_sum, config, channel=CHANNEL_BITS, blended=colour_bits)
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0}
    one = 1 << (share_bits(config) - 1)
    for run_time in range(reflections + 1):
        for quarters in cases(random, run_time, list(range(5)) if materials else [2]):
            shares = plain_shares([(True, quarter) for quarter in quarters])
            for values in ([255] * len(shares), *random.integers(256, size=(8, len(shares))).tolist()):
                leaf.case({**idle, "steps_reset_colour": 1})
                for share, value in zip(shares, values, strict=True):
                    leaf.stimulus += [{**idle, "channel": random.integers(256)}] * int(random.integers(2))
                    leaf.case({**idle, "channel": value, "share": share * one, "steps_add_colour": 1})
                total = sum(share * value for share, value in zip(shares, values, strict=True))
                leaf.case(idle, {"blended": int(total) >> CHANNEL_BITS - colour_bits})
    leaf.check(settled=1)


@by(colour_bits=[1, 4, 8], reflections=[0, 1, 2, 4], materials=[False, True])
def test_colour_combiner(colour_bits, reflections, materials, leaf_of, random):
    """Pixels of a ray and its reflections, which hit or miss."""
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
