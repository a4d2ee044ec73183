# SPDX-License-Identifier: MIT
"""How much what a ray saw weighs in the colour of its pixel."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import share_bits, unsigned


@block
def colour_share(clk, steps, found, found_mirror, share, missed, config: Configuration):
    """share: of what was found, or of the background where nothing was; valid where steps.add_colour is high.

    Shares are in units of 4 ** -config.reflections, share_bits wide, and all shares of a pixel add up to one: a mirror
    passes found_mirror quarters of its weight on, the last hit and a miss pass nothing on. found_mirror: 0 to 4.
    missed: there is nothing left, from the cycle after its steps.add_colour.
    """
    bits = share_bits(config)
    whole = 1 << (bits - 1)

    weight, half, quarter, some, passed_on = (unsigned(bits) for _ in range(5))

    # A weight that is passed on has a quarter: there is one mirror less than there are reflections.
    @always_comb
    def split():
        half.next = 0
        quarter.next = 0
        if found_mirror[1]:
            half.next = weight >> 1
        if found_mirror[0]:
            quarter.next = weight >> 2

    @always_comb
    def add_parts():
        some.next = half + quarter

    # The last ray stores no reflected one.
    @always_comb
    def pass_on():
        passed_on.next = 0
        if found and steps.store_ray:
            if found_mirror[2]:
                passed_on.next = weight
            else:
                passed_on.next = some

    @always_comb
    def keep():
        share.next = weight - passed_on

    @always_comb
    def judge():
        missed.next = weight == 0

    @always(clk.posedge)
    def follow():
        if steps.reset_colour:
            weight.next = whole
        elif steps.add_colour:
            weight.next = passed_on

    return instances()
