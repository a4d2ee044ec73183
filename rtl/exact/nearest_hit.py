# SPDX-License-Identifier: MIT
"""The nearest hit so far, by exact comparison of fractions."""

from myhdl import always, always_comb, block, instances

from raycaster.rtl.common.widths import bit, unsigned


@block
def nearest_hit(
    clk,
    steps,
    offered,
    hit,
    at_mirror,
    numerator,
    denominator,
    found,
    found_surface,
    found_distance,
    found_slope,
    found_at_mirror,
):
    """Keep what is offered at steps.write_z_buf if it is a hit, and nearer than what is kept.

    t = numerator / denominator is nearer than another where numerator * other denominator < other numerator *
    denominator. Of two hits at one t the first stays, which is the lower rectangle: rectangles come in order. offered,
    found_surface: `Surface`s; found: anything was hit since steps.reset_z_buf; found_surface, found_distance,
    found_slope, found_at_mirror: of the nearest, from the cycle after its write: its numerator, its denominator and,
    where that is not None, its at_mirror.
    """
    numerator_bits, denominator_bits = len(numerator), len(denominator)
    offered_product, nearest_product = (unsigned(numerator_bits + denominator_bits) for _ in range(2))
    nearer = bit()

    @always_comb
    def multiply():
        offered_product.next = numerator * found_slope
        nearest_product.next = found_distance * denominator

    @always_comb
    def compare():
        nearer.next = hit and ((not found) or (offered_product < nearest_product))

    @always(clk.posedge)
    def keep():
        if steps.reset_z_buf:
            found.next = False
        elif steps.write_z_buf and nearer:
            found.next = True
            found_distance.next = numerator
            found_slope.next = denominator
            found_surface.word.next = offered.word

    if at_mirror is not None:

        @always(clk.posedge)
        def keep_corner():
            if steps.write_z_buf and nearer:
                found_at_mirror.next = at_mirror

    return instances()
