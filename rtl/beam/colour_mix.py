# SPDX-License-Identifier: MIT
"""One channel of what a mirror shows: its own colour, and as much of what is behind it as it mirrors."""

from myhdl import always, always_comb, block, instances

from raycaster.rtl.common.widths import signed, unsigned


@block
def colour_mix(clk, near, mirror, far, mixed):
    """mixed = (4 - mirror) * near + mirror * far, of worth a quarter, MIX_LATENCY cycles later: no bit is lost.

    near: the mirror's own, 8 bits; mirror: 0 to 4; far: near's width and two bits of fraction for each mirror behind
    this one; mixed: two bits more.
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
