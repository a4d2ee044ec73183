# SPDX-License-Identifier: MIT
"""The light at a column of a surface."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import column_bits


@block
def shadow_scan(
    clk, reset, start, column, stop, count, tested, read, place, dark, next_dark, done, config: Configuration
):  # fmt: skip
    """Find whether a column of a surface is in a shadow, and where that changes, or might: a pass over its shadows.

    Args:
        reset: flag; synchronous reset to idle.
        start: strobe; begins a pass while idle.
        column: unsigned, `column_bits` bits. Constant from start to done, like stop and count.
        stop: unsigned, `column_bits` bits; the column after the surface.
        count: unsigned, `count_bits` bits; the number of its shadows.
        tested: `Entry`; the shadow that was read last.
        read: output strobe; the table must read the shadow at place.
        place: unsigned output, `index_bits` bits; valid with read.
        dark: output flag; a shadow covers the column. Valid with done.
        next_dark: unsigned output, `column_bits` bits; the end of the shadow there that ends last, or else the column
            in which the next one begins, or stop. Valid with done.
        done: output strobe, count + 1 cycles after start.
        config: the design, with a light.
    """
    width = column_bits(config)

    busy, tests, begun, covers, later = (bit() for _ in range(5))
    rest = unsigned(len(count))

    compare = assign(begun, lambda: tested.start <= column)

    @always_comb
    def judge():
        covers.next = begun and (column < tested.stop)
        later.next = not (dark or begun) and (tested.start < next_dark)

    @always_comb
    def fetch():
        read.next = start or tests
        done.next = busy and not tests

    @always(clk.posedge)
    def advance():
        if reset or done:
            busy.next = False
            place.next = 0
        elif read:
            busy.next = True
            place.next = (place + 1) % (1 << len(place))
        if reset:
            tests.next = False
        elif start:
            tests.next = count != 0
            rest.next = count
        elif tests:
            tests.next = rest != 1
            rest.next = rest - 1

    @always(clk.posedge)
    def see():
        if start:
            dark.next = False
            next_dark.next = stop
        elif tests:
            if covers:
                dark.next = True
                if (not dark) or (tested.stop > next_dark):
                    next_dark.next = tested.stop
            elif later:
                next_dark.next = tested.start

    return instances()
