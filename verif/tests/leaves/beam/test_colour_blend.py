# SPDX-License-Identifier: MIT
"""`colour_blend`: from a miss on, every ray shows the background; the mirrors before a ray set its weight."""

from fractions import Fraction

from beam_vectors import beam_config
from hard_scenes import pixel_ports
from vectors import designs

from raycaster.rtl.beam.colour_blend import colour_blend
from raycaster.rtl.beam.latencies import blend_latency, mixes
from raycaster.rtl.common.records import Seen
from raycaster.rtl.common.widths import RGB_BITS


@designs(
    beam_config(colour_bits=6),
    beam_config(reflections=0),
    beam_config(reflections=2),
    beam_config(reflections=4, colour_bits=6),
    beam_config(reflections=1, materials=True),
    beam_config(reflections=2, materials=True, colour_bits=6),
    beam_config(reflections=4, materials=True),
    beam_config(reflections=0, materials=True),
)
def test_colour_blend(config, leaf_of, random):
    rays, record = config.reflections + 1, Seen(config)
    leaf = leaf_of(colour_blend, config, seen=rays * len(record.word))
    latency, background, reflections = blend_latency(config), 0x123456, 0
    for number in range(3000):
        if number % 100 == 0:
            background, reflections = int(random.integers(1 << RGB_BITS)), number // 100 % rays
        found = (random.random(rays) < 0.8).astype(int).tolist()
        colours = [int(random.integers(1 << RGB_BITS)) for _ in found]
        mirrors = [int(random.integers(5)) if mixes(config) else 2 for _ in found]
        rows = zip(found, mirrors, colours, strict=True)
        fields = [dict(zip(("found", "mirror", "colour"), one, strict=True)) for one in rows]
        word = sum(record.pack(one) << i * len(record.word) for i, one in enumerate(fields))
        leaf.case({"picture_background": background, "picture_reflections": reflections, "seen": word})
        seen = [colour if all(found[: i + 1]) else background for i, colour in enumerate(colours)]
        pixel = []
        for low in (16, 8, 0):
            channels = [Fraction(colour >> low & 255) for colour in seen[: reflections + 1]]
            value = channels.pop()
            for own, quarters in reversed(list(zip(channels, mirrors, strict=False))):
                value = ((4 - quarters) * own + quarters * value) / 4
            pixel.append(value)
        # For the last cases of a background, it has changed on the way.
        leaf.expect(pixel_ports(config, pixel), when=number % 100 < 100 - latency)
    leaf.check(latency, spare=True)
