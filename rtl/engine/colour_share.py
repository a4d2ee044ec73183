# SPDX-License-Identifier: MIT
"""The share of each ray's colour in its pixel."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign, plus
from raycaster.rtl.common.widths import share_bits


@block
def colour_share(clk, steps, found, found_mirror, share, missed, config: Configuration):
    """Compute the share of each ray's colour in its pixel.

    The shares of a pixel add up to 1, the highest of their `share_bits` bits. The last ray, which stores no reflected
    ray, keeps all the remaining weight. Each earlier ray passes part of it on: a mirror found_mirror quarters, a miss
    nothing; without `config.materials`, always half.

    Args:
        steps: `Steps`; reset_colour, add_colour and store_ray are read. With steps.add_colour, store_ray is low for the
            last ray.
        found: flag; the ray has a hit. Read with steps.add_colour.
        found_mirror: unsigned, 3 bits; the share that the hit mirrors, 0 to 4 quarters. Read with steps.add_colour,
            only with `config.materials`.
        share: unsigned output, `share_bits` bits; the share of the hit, or of the background if there is none. Valid
            when steps.add_colour is high.
        missed: output flag; a ray has hit nothing, or no mirror, so later hits do not count. Valid from the cycle after
            that ray's steps.add_colour.
    """
    bits = share_bits(config)
    whole = 1 << (bits - 1)

    weight, left = unsigned(bits), unsigned(bits)

    if config.materials:
        half, quarter, passed_on = (unsigned(bits) for _ in range(3))
        some, add_parts = plus(half, quarter, bits)

        # A weight that is passed on is a multiple of 4: it has met fewer mirrors than there are reflections.
        split_half = assign(half, lambda: weight >> 1 if found_mirror[1] else 0)
        split_quarter = assign(quarter, lambda: weight >> 2 if found_mirror[0] else 0)

        # The last ray passes nothing on: it stores no reflected ray.
        @always_comb
        def pass_on():
            passed_on.next = 0
            if found and steps.store_ray:
                if found_mirror[2]:
                    passed_on.next = weight
                else:
                    passed_on.next = some

        keep = assign((share, left), lambda: (weight - passed_on, passed_on))
        judge = assign(missed, lambda: weight == 0)

    else:
        # A ray keeps as much as it passes on.
        keep = assign(share, lambda: weight >> 1 if steps.store_ray else weight)

        pass_on = assign(left, lambda: share)

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
