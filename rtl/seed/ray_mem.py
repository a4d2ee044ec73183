# SPDX-License-Identifier: MIT
"""The reflected ray."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import bit


@block
def ray_mem(clk, steps, found_axis, found_point, ray, reflected):
    """At steps.store_ray, keep the ray that leaves the hit point: the slope on the mirror's axis changes its sign.

    ray: the `Ray` that hit; reflected: the `Ray` that is kept. The slope's magnitudes do not change.
    """
    dx, dy, dz = bit(), bit(), bit()

    @always_comb
    def turn():
        dx.next = ray.dx != (found_axis == 0)
        dy.next = ray.dy != (found_axis == 1)
        dz.next = ray.dz != (found_axis == 2)

    @always(clk.posedge)
    def store():
        if steps.store_ray:
            reflected.word.next = concat(found_point.word, dx, dy, dz)

    return instances()
