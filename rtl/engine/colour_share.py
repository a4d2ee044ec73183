# SPDX-License-Identifier: MIT
"""How much what a ray saw weighs in the colour of its pixel."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import share_bits, unsigned


@block
def colour_share(clk, steps, found, found_mirror, share, missed, config: Configuration):
    """Weigh each ray's colour in its pixel.

    All shares of a pixel add up to one, which is the highest of their `share_bits` bits. The last ray keeps all the
    weight that is left; it stores no reflected ray. Before it a mirror passes found_mirror quarters of its weight on,
    and a miss nothing; or, without `config.materials`, all pass half on.

    Args:
        clk: the clock.
        steps: `Steps`; reset_colour, add_colour and store_ray are read. With steps.add_colour, store_ray is low for the
            last ray.
        found: flag; the ray has a hit. Read with steps.add_colour.
        found_mirror: unsigned, 3 bits; how much the hit mirrors, 0 to 4 quarters, read with steps.add_colour and
            `config.materials`.
        share: unsigned output, `share_bits` bits; the share of the hit, or of the background where there is none. Valid
            where steps.add_colour is high.
        missed: output flag; a ray has found nothing, or nothing that mirrors, so that later hits do not count. Valid
            from the cycle after that ray's steps.add_colour.
        config: the design.
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
