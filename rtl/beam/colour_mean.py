# SPDX-License-Identifier: MIT
"""A channel of the colour of a mirror that reflects half."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import unsigned


@block
def colour_mean(own, behind, reflections, mean, number: int):
    """Add the two halves of one channel of a mirror that reflects half: mean = own + behind, in units of a half.

    No bit is lost. Combinational.

    Args:
        own: unsigned, 8 bits; the mirror's colour.
        behind: unsigned, the width of own and a fraction bit for each mirror behind this one; the colour that the
            mirror shows.
        reflections: unsigned, `REFLECTION_BITS` bits; the number of reflections that the scene asks for. If it equals
            number, own counts twice, as nothing is behind; if it is less, mean is don't care.
        mean: unsigned, one bit wider than behind; output.
        number: the number of mirrors before this one.
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
