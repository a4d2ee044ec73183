# SPDX-License-Identifier: MIT
"""A copy of the rectangles that an engine has fetched, for a second reader."""

from myhdl import block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus, plus, register
from raycaster.rtl.common.widths import AXIS_BITS, WIDE_BITS, index_bits


class WideRect(Record):
    """A rectangle without colour, whose bounds may be one unit further out."""

    def __init__(self):
        bounds = dict.fromkeys(("u_low", "u_high", "v_low", "v_high"), Signed(WIDE_BITS))
        super().__init__({"axis": AXIS_BITS, "position": COORDINATE_BITS} | bounds)


@block
def rect_copy(clk, rects, copy, margin: int, config: Configuration):
    """Store each rectangle that the engine fetches from rects, and present it to a second reader through copy.

    Args:
        rects: `Rects` of the engine; all inputs here, and rect comes a cycle after fetch.
        copy: `Rects` of the second reader; index and fetch are read. rect is an output, a `WideRect` with bounds margin
            further out, and comes two cycles after fetch; don't care if the engine has not fetched it.
        margin: distance by which the bounds are further out, in world units.
    """
    rect, bounds = rects.rect, ("u_low", "u_high", "v_low", "v_high")
    kept = Record({"axis": AXIS_BITS} | dict.fromkeys(("position", *bounds), COORDINATE_BITS))
    words = [unsigned(len(kept.word)) for _ in range(config.rectangles)]
    at_hand, number = bit(), unsigned(index_bits(config))
    u_low, u_high, v_low, v_high = (signed(COORDINATE_BITS + 1) for _ in range(4))
    wide_u_low, widen_u_low = minus(u_low, margin, Signed(WIDE_BITS))
    wide_u_high, widen_u_high = plus(u_high, margin, Signed(WIDE_BITS))
    wide_v_low, widen_v_low = minus(v_low, margin, Signed(WIDE_BITS))
    wide_v_high, widen_v_high = plus(v_high, margin, Signed(WIDE_BITS))

    follow = register(clk, (at_hand, number), lambda: (rects.fetch, rects.index))

    bare = kept.joined(
        axis=rect.axis, position=rect.position, u_low=rect.u_low, u_high=rect.u_high, v_low=rect.v_low,
        v_high=rect.v_high,
    )  # fmt: skip

    write = register(clk, words[number], lambda: bare, at_hand)
    read = register(clk, kept.word, lambda: words[copy.index], copy.fetch)

    extend = assign((u_low, u_high, v_low, v_high), lambda: (kept.u_low, kept.u_high, kept.v_low, kept.v_high))

    wide = copy.rect.joined(
        axis=kept.axis, position=kept.position, u_low=wide_u_low, u_high=wide_u_high, v_low=wide_v_low,
        v_high=wide_v_high,
    )  # fmt: skip

    present = register(clk, copy.rect.word, lambda: wide)

    return instances()
