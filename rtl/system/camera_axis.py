# SPDX-License-Identifier: MIT
"""A coordinate of a camera that buttons move."""

from myhdl import always, block, instances

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign

STEP = 3
"""World units that a held button moves the camera per frame: across the world in about three seconds."""


@block
def camera_axis(clk, reset, move, more, less, start, position):
    """Move a camera's coordinate by `STEP` in the direction of a button, and never out of the world.

    Args:
        reset: synchronous, active high; sets position to start.
        move: strobe, once per frame.
        more: flag; the button that raises the coordinate, read with move. Both buttons at once count as none.
        less: flag; the button that lowers the coordinate, read with move.
        start: unsigned, 9 bits; the coordinate after reset.
        position: unsigned, 9 bits; output, the coordinate. It changes in the cycle after move.
    """
    most = WORLD_SIZE - 1 - STEP
    can_rise, can_fall = bit(), bit()

    look_ahead = assign(
        (can_rise, can_fall), lambda: (more and not less and position <= most, less and not more and position >= STEP)
    )

    @always(clk.posedge)
    def step():
        if reset:
            position.next = start
        elif move and can_rise:
            position.next = position + STEP
        elif move and can_fall:
            position.next = position - STEP

    return instances()
