# SPDX-License-Identifier: MIT
"""A channel of a mirror's colour, mixed from its own colour and the colour that it mirrors."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import signed, unsigned


@block
def colour_mix(clk, near, mirror, far, mixed):
    """Mix one channel of a mirror: mixed = (4 - mirror) * near + mirror * far, in units of a quarter.

    The result follows `MIX_LATENCY` cycles later. No bit is lost.

    Args:
        clk: the clock.
        near: unsigned, 8 bits; the mirror's own colour.
        mirror: unsigned, `MIRROR_BITS` bits, 0 to 4; the share that it mirrors, in quarters.
        far: unsigned, the width of near and two fraction bits for each mirror behind this one; the colour that the
            mirror shows.
        mixed: unsigned, two bits wider than far; output, `MIX_LATENCY` cycles after the other ports.
    """
    near_bits, far_bits, mixed_bits = len(near), len(far), len(mixed)
    fraction_bits = far_bits - near_bits

    own = unsigned(far_bits)
    apart = signed(far_bits + 1)
    whole = unsigned(mixed_bits)
    doubles, singles, share = (signed(mixed_bits + 1) for _ in range(3))
    total = signed(mixed_bits + 2)

    @always_comb
    def widen():
        own.next = near << fraction_bits
        whole.next = near << (fraction_bits + 2)

    @always_comb
    def compare():
        apart.next = far - own

    @always_comb
    def weigh():
        doubles.next = 0
        singles.next = 0
        if mirror[2]:
            doubles.next = apart << 2
        elif mirror[1]:
            doubles.next = apart << 1
        if mirror[0]:
            singles.next = apart

    @always_comb
    def add_shares():
        share.next = doubles + singles

    @always_comb
    def add():
        total.next = whole + share

    @always(clk.posedge)
    def keep():
        mixed.next = total[mixed_bits:]

    return instances()
