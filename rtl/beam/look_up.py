# SPDX-License-Identifier: MIT
"""The look of the rectangle that a ray sees."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import Facet, Look
from raycaster.rtl.common.widths import RGB_BITS
from raycaster.rtl.engine.pattern_colour import pattern_colour


@block
def look_up(clk, step, facets, sight, seen, config: Configuration):
    """Look up the colour that a ray sees on the rectangle that sight names, `LOOK_UP_LATENCY` cycles after a step.

    Args:
        clk: the clock.
        step: strobe; takes sight.
        facets: `Facet` of each rectangle, side by side, the first in the lowest bits; read with step.
        sight: `Winner` or, with patterns, `Sight`; read with step.
        seen: `Seen`; output, valid from `LOOK_UP_LATENCY` cycles after a step until the next one.
        config: the design.
    """
    words = [unsigned(len(Facet(config).word)) for _ in range(config.rectangles)]
    takers = [word_of(Facet(config).cut(facets, i), word) for i, word in enumerate(words)]
    found, look = bit(), Look(config)
    look_bits = len(look.word)

    @always(clk.posedge)
    def find():
        if step:
            found.next = sight.valid
            look.word.next = words[sight.index][look_bits:]

    if config.patterns:
        odd_u, odd_v, colour = bit(), bit(), unsigned(RGB_BITS)
        painter = pattern_colour(look, odd_u=odd_u, odd_v=odd_v, colour=colour)

        @always(clk.posedge)
        def follow_cells():
            if step:
                odd_u.next = sight.odd_u
                odd_v.next = sight.odd_v

    else:
        colour = look.colour

    result = seen.joined(found=found, mirror=look.mirror, colour=colour)

    @always_comb
    def join():
        seen.word.next = result

    return instances()
