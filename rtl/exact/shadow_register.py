# SPDX-License-Identifier: MIT
"""The shadow of a hit point: flags that the unit looks for the light, and that a rectangle is in between."""

from myhdl import always, block, instances

from raycaster.configuration import COORDINATE_BITS
from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign, times
from raycaster.rtl.common.interfaces import AIM_CYCLES


@block
def shadow_register(clk, steps, in_question, hit, numerator, denominator, found_slope, looking, shaded):
    """Set a flag when the shadow ray hits anything strictly between the light and the hit point P.

    The ray meets P at t = 1 / e, and a rectangle at t = numerator / denominator: before P if numerator * e <
    denominator.

    A unit whose point is not in question goes on with its own ray, and its flag shaded is don't care. So each unit has
    a register that chooses its ray, close to the multiplexers; one register for all units would be too slow.

    Args:
        steps: `Steps`; only reset_z_buf, aim and write_shadow are read.
        in_question: flag; `RayFate`'s, read in the last cycle of steps.aim.
        hit: flag; the shadow ray hits the rectangle. Read with steps.write_shadow.
        numerator: unsigned; at most the size of the world if hit is high. Read with steps.write_shadow.
        denominator: unsigned; read with steps.write_shadow.
        found_slope: unsigned; e. Read with steps.write_shadow.
        looking: output flag; the unit tests its shadow ray. From the cycle after the last one of steps.aim to
            steps.reset_z_buf.
        shaded: output flag; there was a hit before P since steps.aim. Valid from the cycle after steps.write_shadow.
    """
    distance = unsigned(COORDINATE_BITS)
    reached, multiply = times(distance, found_slope, COORDINATE_BITS + len(found_slope))
    in_between = bit()
    last = AIM_CYCLES - 1

    # The light and the plane are both in the world, so the distance between them fits a coordinate's width.
    narrow = assign(distance, lambda: numerator[COORDINATE_BITS:])

    compare = assign(in_between, lambda: hit and (reached < denominator))

    @always(clk.posedge)
    def look():
        if steps.reset_z_buf:
            looking.next = False
        elif steps.aim[last]:
            looking.next = in_question

    @always(clk.posedge)
    def keep():
        if steps.aim[0]:
            shaded.next = False
        elif steps.write_shadow and in_between:
            shaded.next = True

    return instances()
