# SPDX-License-Identifier: MIT
"""The rectangles that an engine has seen, to be looked at again while it works on others."""

from myhdl import always, always_comb, block, concat

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.rtl.common.legacy import PipelinedRects
from raycaster.rtl.common.widths import AXIS_BITS, bit, index_bits, signed, unsigned


@block
def rect_copy(clk, rects, copy, margin: int, config: Configuration):
    """Keep each rectangle that the engine fetches from rects, and give it to a second reader through copy.

    rects: Sequential- or PipelinedRects, only listened to. copy: like PipelinedRects, the rectangle as a WideRect:
    bounds are margin further out. What was never fetched means nothing.
    """
    width = COORDINATE_BITS
    word_bits = AXIS_BITS + 5 * width

    words = [unsigned(word_bits) for _ in range(config.rectangles)]
    asked, at_hand = bit(), bit()
    number_0, number = unsigned(index_bits(config)), unsigned(index_bits(config))
    seen, word = unsigned(word_bits), unsigned(word_bits)
    low_u, high_u, low_v, high_v = (signed(width + 1) for _ in range(4))

    # The fields in one word.
    @always_comb
    def pack():
        seen.next = concat(
            rects.rect.axis,
            rects.rect.position,
            rects.rect.u_low,
            rects.rect.u_high,
            rects.rect.v_low,
            rects.rect.v_high,
        )

    # What comes a cycle after it was asked for, or two.
    if isinstance(rects, PipelinedRects):

        @always(clk.posedge)
        def follow():
            asked.next = rects.fetch
            at_hand.next = asked
            number_0.next = rects.index
            number.next = number_0

    else:

        @always(clk.posedge)
        def follow():
            at_hand.next = rects.fetch
            number.next = rects.index

    # Keep it.
    @always(clk.posedge)
    def write():
        if at_hand:
            words[number].next = seen

    # What the second reader asks for.
    @always(clk.posedge)
    def read():
        if copy.fetch:
            word.next = words[copy.index]

    # Its bounds with a sign.
    @always_comb
    def extend():
        low_u.next = word[4 * width : 3 * width]
        high_u.next = word[3 * width : 2 * width]
        low_v.next = word[2 * width : width]
        high_v.next = word[width:]

    # And further out.
    @always(clk.posedge)
    def present():
        copy.rect.axis.next = word[word_bits : 5 * width]
        copy.rect.position.next = word[5 * width : 4 * width]
        copy.rect.u_low.next = low_u - margin
        copy.rect.u_high.next = high_u + margin
        copy.rect.v_low.next = low_v - margin
        copy.rect.v_high.next = high_v + margin

    return pack, follow, write, read, extend, present
