# SPDX-License-Identifier: MIT
"""One channel of what a ray sees in a mirror that shows half."""

from myhdl import always_comb, block, instances

from raycaster.rtl.common.widths import unsigned


@block
def colour_mean(own, behind, reflections, mean, number: int):
    """mean = own + behind, of worth a half: no bit is lost. Combinational.

    own: the mirror's colour, 8 bits; behind: own's width and a bit of fraction for each mirror behind this one; number:
    of mirrors before this one. Where a scene asks for no more reflections than these, own counts twice.
    """
    mean_bits = len(mean)
    fraction_bits = len(behind) - len(own)

    whole, other = unsigned(mean_bits), unsigned(mean_bits)

    @always_comb
    def widen():
        whole.next = own << fraction_bits

    @always_comb
    def choose():
        other.next = behind
        if reflections == number:
            other.next = own << fraction_bits

    @always_comb
    def add():
        mean.next = whole + other

    return instances()
