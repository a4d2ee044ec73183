# SPDX-License-Identifier: MIT
"""What is known of a fixed rectangle that a ray met."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import unsigned


@block
def facet_rom(clk, index, axis, distance, colour, config: Configuration):
    """The rectangle's own, a cycle after its index. distance, from the camera to its plane: None where that is live."""
    axes, colours = config.fixed.column("axis"), config.fixed.column("colour")

    # What a ray sees, and what a mirror is.
    @always(clk.posedge)
    def look_up():
        axis.next = axes[int(index)]
        colour.next = colours[int(index)]

    if not config.fixed.camera:
        return look_up

    # A table holds words without a sign.
    distance_bits = len(distance)
    distances = tuple(distance % (1 << distance_bits) for distance in config.fixed.distances)
    word = unsigned(distance_bits)

    # How far away it is.
    @always(clk.posedge)
    def look_up_distance():
        word.next = distances[int(index)]

    # The sign is the highest bit's.
    @always_comb
    def extend():
        distance.next = word.signed()

    return look_up, look_up_distance, extend
