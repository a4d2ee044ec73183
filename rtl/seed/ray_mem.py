# SPDX-License-Identifier: MIT
"""The reflected ray."""

from myhdl import always, block


@block
def ray_mem(clk, steps, found_axis, found_point, signs, reflected_origin, reflected_signs):
    """At steps.store_ray, keep the ray that leaves the hit point: the slope on the mirror's axis changes its sign.

    signs are those of the ray that hit; the slope's magnitudes do not change, so they are not kept.
    """

    # The reflected ray starts where the last one ended.
    @always(clk.posedge)
    def store():
        if steps.store_ray:
            reflected_origin.x.next = found_point.x
            reflected_origin.y.next = found_point.y
            reflected_origin.z.next = found_point.z
            reflected_signs.dx.next = signs.dx
            reflected_signs.dy.next = signs.dy
            reflected_signs.dz.next = signs.dz
            if found_axis == 0:
                reflected_signs.dx.next = not signs.dx
            elif found_axis == 1:
                reflected_signs.dy.next = not signs.dy
            else:
                reflected_signs.dz.next = not signs.dz

    return (store,)
