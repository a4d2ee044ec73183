# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_combiner`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from unit_vectors import any_config, plain_shares
from vectors import ports

from raycaster.configuration import CHANNEL_BITS
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import tied, unsigned
from raycaster.rtl.common.interfaces import Picture, Steps
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.common.widths import MIRROR_BITS, RGB_BITS
from raycaster.rtl.engine.colour_combiner import colour_combiner


def mirrored(random: np.random.Generator, run_time: int) -> list[tuple[bool, int]]:
    """Return, for a ray and its reflections, whether each hits something and how many quarters of that are mirror."""
    return [(bool(random.random() < 0.75), int(random.integers(5))) for _ in range(run_time + 1)]


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
def test_colour_combiner(colour_bits, reflections, materials, tmp_path, random):
    config = any_config(colour_bits=colour_bits, reflections=reflections, materials=materials)
    leaf = Leaf(colour_combiner, lambda: ports(
        "clk found missed", steps=Steps(), found_colour=unsigned(RGB_BITS),
        found_mirror=unsigned(MIRROR_BITS) if materials else tied(0, MIRROR_BITS), picture=Picture(),
        pixel=Pixel(colour_bits), config=config
    ), tmp_path)  # fmt: skip
    stimulus, results = [], []
    for _ in range(200):
        run_time = int(random.integers(reflections + 1))
        palette = random.choice([0, 1, 255, 128, *random.integers(256, size=4)], (run_time + 2, 3)).astype(np.uint8)
        *words, background = (int.from_bytes(bytes(colour)) for colour in palette)
        held = {"picture_background": background, "steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
        stimulus.append({**held, "steps_reset_colour": 1})
        # After its end a ray continues and may find something, which must not count.
        hits = mirrored(random, run_time) if materials else [(found, 2) for found, _ in mirrored(random, run_time)]
        for number, ((found, quarters), word) in enumerate(zip(hits, words, strict=True)):
            ray = {**held, "found": int(found), "found_colour": word}
            if materials:
                ray["found_mirror"] = quarters
            # Only the hit in the cycle of the addition counts.
            stimulus += [{**ray, "found": int(random.integers(2))}] * int(random.integers(2))
            stimulus.append({**ray, "steps_add_colour": 1, "steps_store_ray": int(number < run_time)})
            missed = any(not found or quarters == 0 for found, quarters in hits[: number + 1])
            if number < run_time or not materials:
                results.append((len(stimulus), None, missed, hits))
        seen = [palette[number] if found else palette[-1] for number, (found, _) in enumerate(hits)]
        pixel = sum(share * colour.astype(object) for share, colour in zip(plain_shares(hits), seen, strict=True))
        results.append((len(stimulus), [int(channel) for channel in pixel], None, hits))
        stimulus.append({**held, "found": int(random.integers(2))})
    stimulus = [{name: value for name, value in cycle.items() if name in leaf.given} for cycle in stimulus]
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, pixel, missed, hits in results:
        assert missed is None or outputs[cycle]["missed"] == missed, hits
        for name, channel in zip(("red", "green", "blue"), pixel or (), strict=pixel is not None):
            assert outputs[cycle][f"pixel_{name}"] == channel >> (CHANNEL_BITS - colour_bits), hits
