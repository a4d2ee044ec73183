# SPDX-License-Identifier: MIT
"""How much what a ray saw weighs in the colour of its pixel."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import share_bits, unsigned


@block
def colour_share(clk, steps, found, found_mirror, share, missed, config: Configuration):
    """share: of what was found, or of the background where nothing was; valid where steps.add_colour is high.

    All shares of a pixel add up to one, which is the highest of their `share_bits`. The last ray keeps all the weight
    that is left. Before it a mirror passes found_mirror quarters of its weight on, 0 to 4, and a miss nothing; or all
    pass half on, where found_mirror is None, without config.materials.
    missed: a ray has found nothing, or nothing that mirrors, so that what follows does not count; from the cycle after
    its steps.add_colour.
    """
    bits = share_bits(config)
    whole = 1 << (bits - 1)

    weight, left = unsigned(bits), unsigned(bits)

    if config.materials:
        half, quarter, some, passed_on = (unsigned(bits) for _ in range(4))

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
            left.next = passed_on

        @always_comb
        def judge():
            missed.next = weight == 0

    else:
        # What it keeps is as much as what it passes on.
        @always_comb
        def keep():
            share.next = weight
            if steps.store_ray:
                share.next = weight >> 1

        @always_comb
        def pass_on():
            left.next = share

        @always(clk.posedge)
        def judge():
            if steps.reset_colour:
                missed.next = False
            elif steps.add_colour and not found:
                missed.next = True

    @always(clk.posedge)
    def follow():
        if steps.reset_colour:
            weight.next = whole
        elif steps.add_colour:
            weight.next = left

    return instances()
