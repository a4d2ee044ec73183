# SPDX-License-Identifier: MIT
"""The colour of a pixel, blended from its ray and all the ray's reflections at once."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, tied, unconnected, unsigned
from raycaster.rtl.beam.colour_mean import colour_mean
from raycaster.rtl.beam.colour_mix import colour_mix
from raycaster.rtl.beam.colour_seen import colour_seen
from raycaster.rtl.beam.latencies import MIX_LATENCY, mixes
from raycaster.rtl.common.delay_line import delay_line
from raycaster.rtl.common.records import Seen, Shade


@block
def colour_blend(clk, seen, picture, pixel, config: Configuration):
    """Blend the colours that a ray and its reflections saw into a pixel, one per clock, `blend_latency` cycles later.

    From the first ray that misses on, the background is shown.

    Args:
        clk: the clock.
        seen: `Seen` of the ray and of each of its reflections, side by side, the ray in the lowest bits.
        picture: `Picture` of the live scene; run is not read.
        pixel: `Pixel`; output, `blend_latency` cycles after seen.
        config: the design.
    """
    colour_bits, mirrors = config.colour_bits, config.reflections
    rays = range(mirrors + 1)

    ones = [Seen(config).cut(seen, number) for number in rays]
    shades = [Shade(config) for _ in rays]
    reached = [tied(1, bit()), *(bit() for _ in range(mirrors)), unconnected(bit())]
    lookers = [
        colour_seen(clk, reached=reached[number], seen=one, picture=picture, found=reached[number + 1], shade=shade,
            number=number)
        for number, one, shade in zip(rays, ones, shades, strict=True)
    ]  # fmt: skip

    # From the last mirror to the first, a mirror's own colour is joined with the colour behind it.
    behind = [[shades[-1].red, shades[-1].green, shades[-1].blue]]
    for _ in range(mirrors):
        behind.append([unsigned(len(channel) + (2 if mixes(config) else 1)) for channel in behind[-1]])
    joints = [(mirrors - 1 - turn, behind[turn], behind[turn + 1]) for turn in range(mirrors)]
    red, green, blue = behind[-1]
    top = pixel.joined(
        **{
            name: channel(len(channel), len(channel) - colour_bits)
            for name, channel in (("red", red), ("green", green), ("blue", blue))
        }
    )

    if mixes(config):
        # A mirror's own colour waits until the colour behind it is known.
        nears = [*(shade.twin() for shade in shades[: mirrors - 1]), shades[mirrors - 1]]
        waits = [
            delay_line(clk, shades[number].word, nears[number].word, (mirrors - 1 - number) * MIX_LATENCY)
            for number in range(mirrors - 1)
        ]
        mixers = [
            colour_mix(clk, near=own, mirror=nears[number].mirror, far=far, mixed=mixed)
            for number, fars, both in joints
            for own, far, mixed in zip(
                (nears[number].red, nears[number].green, nears[number].blue), fars, both, strict=True
            )
        ]

        @always_comb
        def round_down():
            pixel.word.next = top

    else:
        means = [
            colour_mean(own=own, behind=far, reflections=picture.reflections, mean=mean, number=number)
            for number, fars, both in joints
            for own, far, mean in zip(
                (shades[number].red, shades[number].green, shades[number].blue), fars, both, strict=True
            )
        ]

        @always(clk.posedge)
        def round_down():
            pixel.word.next = top

    return instances()
