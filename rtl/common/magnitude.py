# SPDX-License-Identifier: MIT
"""The magnitude of a signed number."""

from myhdl import always_comb, block, instances

from raycaster.rtl.common.widths import signed


@block
def magnitude(value, result):
    """result = |value|, combinational. value: signed, above its least number; result: unsigned, one bit less.

    A value may be wider than that, if its magnitude fits the result.
    """
    bits = len(result)
    opposite = signed(len(value))

    @always_comb
    def negate():
        opposite.next = -value

    @always_comb
    def choose():
        if value < 0:
            result.next = opposite[bits:]
        else:
            result.next = value[bits:]

    return instances()
