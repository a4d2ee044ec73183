# SPDX-License-Identifier: MIT
"""The nearest hit so far, by exact comparison of fractions."""

from myhdl import always, always_comb, block, instances

from raycaster.rtl.common.widths import bit, unsigned


@block
def nearest_hit(clk, steps, offered, hit, numerator, denominator, found, found_surface):
    """Keep what is offered at steps.write_z_buf if it is a hit, and nearer than what is kept.

    t = numerator / denominator is nearer than another where numerator * other denominator < other numerator *
    denominator. Of two hits at one t the first stays, which is the lower rectangle: rectangles come in order. offered,
    found_surface: `Surface`s; found: anything was hit since steps.reset_z_buf; found_surface: the nearest, from the
    cycle after its write.
    """
    numerator_bits, denominator_bits = len(numerator), len(denominator)
    nearest_numerator = unsigned(numerator_bits)
    nearest_denominator = unsigned(denominator_bits)
    offered_product, nearest_product = (unsigned(numerator_bits + denominator_bits) for _ in range(2))
    nearer = bit()

    @always_comb
    def multiply():
        offered_product.next = numerator * nearest_denominator
        nearest_product.next = nearest_numerator * denominator

    @always_comb
    def compare():
        nearer.next = hit and ((not found) or (offered_product < nearest_product))

    @always(clk.posedge)
    def keep():
        if steps.reset_z_buf:
            found.next = False
        elif steps.write_z_buf and nearer:
            found.next = True
            nearest_numerator.next = numerator
            nearest_denominator.next = denominator
            found_surface.word.next = offered.word

    return instances()
