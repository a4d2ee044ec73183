# SPDX-License-Identifier: MIT
"""The mirror that a ray meets."""

from myhdl import always, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import facet_of
from raycaster.rtl.common.widths import unsigned


@block
def mirror_look_up(clk, facets, winner, last, config: Configuration):
    """last, a `Reflector`: the rectangle that a `Winner` tells, LOOK_UP_LATENCY cycles later.

    facets: each rectangle's `Facet`, side by side, the first in the lowest bits.
    """
    facet = facet_of(config)
    words = [unsigned(len(facet.word)) for _ in range(config.rectangles)]
    takers = [word_of(facet_of(config).cut(facets, i), word) for i, word in enumerate(words)]
    # Of a facet, a reflector has the axis and the distance, which are next to each other in both.
    end, low = facet.slice("axis")[0] + 1, facet.slice("distance")[1]

    @always(clk.posedge)
    def find():
        last.word.next = concat(winner.at_mirror, words[winner.index][end:low])

    return instances()
