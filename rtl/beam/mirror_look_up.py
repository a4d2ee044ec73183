# SPDX-License-Identifier: MIT
"""The mirror that a ray meets."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import Facet


@block
def mirror_look_up(clk, facets, winner, last, config: Configuration):
    """Look up the mirror that a ray meets: the rectangle that winner names, `LOOK_UP_LATENCY` cycles later.

    Args:
        clk: the clock.
        facets: `Facet` of each rectangle, side by side, the first in the lowest bits.
        winner: `Winner`; a new one each cycle.
        last: `Reflector`; output, `LOOK_UP_LATENCY` cycles after winner.
        config: the design.
    """
    facet = Facet(config)
    words = [unsigned(len(facet.word)) for _ in range(config.rectangles)]
    takers = [word_of(Facet(config).cut(facets, i), word) for i, word in enumerate(words)]
    mirror = last.joined(at_mirror=winner.at_mirror, axis=facet.axis, distance=facet.distance)

    @always_comb
    def find():
        facet.word.next = words[winner.index]

    @always(clk.posedge)
    def keep():
        last.word.next = mirror

    return instances()
