# SPDX-License-Identifier: MIT
"""What a ray adds to its pixel."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import MIRROR_BITS, RGB_BITS, bit, unsigned


@block
def colour_seen(clk, reached, seen, picture, found, shade, number: int):
    """The colour that a ray saw, or the background from the first ray that found nothing on, SEEN_LATENCY cycles later.

    reached: all rays before it have found something; seen: a `Seen`; found: it has too, combinational; shade: a
    `Shade`; number: of reflections before it. Of the last hit that a scene asks for, nothing is behind.
    """
    colour, here = unsigned(RGB_BITS), bit()

    @always_comb
    def look():
        here.next = reached and seen.found

    @always_comb
    def tell():
        found.next = here

    @always_comb
    def choose():
        colour.next = picture.background
        if here:
            colour.next = seen.colour

    if "mirror" in shade.layout:
        mirror = unsigned(MIRROR_BITS)

        @always_comb
        def look_at_mirror():
            mirror.next = 0
            if picture.reflections > number:
                mirror.next = seen.mirror

        @always(clk.posedge)
        def keep():
            shade.word.next = concat(mirror, colour)

    else:

        @always(clk.posedge)
        def keep():
            shade.word.next = colour

    return instances()
