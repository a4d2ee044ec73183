# SPDX-License-Identifier: MIT
"""The nearest hit so far, by exact comparison of fractions."""

from myhdl import always, block, instances

from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign, times


@block
def nearest_hit(
    clk, steps, offered, hit, at_mirror, numerator, denominator, found, found_surface, found_distance, found_slope,
    found_at_mirror,
):  # fmt: skip
    """Keep the nearest hit: at steps.write_z_buf, take the offered hit if it is nearer than the stored one.

    t = numerator / denominator is nearer than another if numerator * other denominator < other numerator * denominator.
    At equal t the first hit stays, which is the lower rectangle, as rectangles come in order. The found_ outputs
    describe the nearest hit, from the cycle after its write.

    Args:
        steps: `Steps`; only reset_z_buf and write_z_buf are read.
        offered: `Surface` of the offered rectangle; read with steps.write_z_buf.
        hit: flag; the ray hits the offered rectangle. Read with steps.write_z_buf.
        at_mirror: flag; the hit is in the plane of the mirror that the ray left last. Read with steps.write_z_buf.
        numerator: unsigned; the numerator of t, read with steps.write_z_buf.
        denominator: unsigned; the denominator of t, read with steps.write_z_buf.
        found: output flag; something was hit since steps.reset_z_buf.
        found_surface: output `Surface` of the nearest hit.
        found_distance: unsigned output, as wide as numerator; the nearest hit's numerator.
        found_slope: unsigned output, as wide as denominator; the nearest hit's denominator.
        found_at_mirror: output flag; the nearest hit's at_mirror.
    """
    product_bits = len(numerator) + len(denominator)
    offered_product, multiply_offered = times(numerator, found_slope, product_bits)
    nearest_product, multiply_nearest = times(found_distance, denominator, product_bits)
    nearer = bit()

    compare = assign(nearer, lambda: hit and ((not found) or (offered_product < nearest_product)))

    @always(clk.posedge)
    def keep():
        if steps.reset_z_buf:
            found.next = False
        elif steps.write_z_buf and nearer:
            found.next = True
            found_distance.next, found_slope.next = numerator, denominator
            found_surface.word.next, found_at_mirror.next = offered.word, at_mirror

    return instances()
