# SPDX-License-Identifier: MIT
"""The sequence of rectangles that an engine tests, and the time for each."""

from myhdl import always, always_comb, block, downrange, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import index_bits


@block
def rect_sequencer(
    clk, reset_ray_caster, start_ray, wanted, early_out, index, fetch, fetched, starting, rect_cycles,
    config: Configuration,
):  # fmt: skip
    """Give each wanted rectangle `rect_cycles` cycles, in ascending order, from the cycle after start_ray on.

    Args:
        reset_ray_caster: flag; synchronous reset, after which nothing is fetched.
        start_ray: strobe; the next cycle begins the first rectangle's test.
        wanted: unsigned, `config.rectangles` bits, one per rectangle; read in the cycle before start_ray.
        early_out: flag; this cycle is the last of the rectangle's test.
        index: unsigned output, `index_bits` bits; the rectangle that the memory must fetch, valid with fetch.
        fetch: output strobe, in the cycle before a test; the memory must fetch the rectangle. It also comes after the
            last test, when index is don't care.
        fetched: output flag; a test is under way, and the memory holds its rectangle.
        starting: output flag; first cycle of a test.
        rect_cycles: cycles of a test that does not end early.
    """
    rectangles = config.rectangles
    last_cycle = rect_cycles - 1

    cycle = unsigned(bits_for(rect_cycles))
    candidates, waiting, others = (unsigned(rectangles) for _ in range(3))
    lowest, upcoming = (unsigned(index_bits(config)) for _ in range(2))
    offered, take = bit(), bit()

    see_take = assign(take, lambda: start_ray or (fetched and (early_out or cycle == last_cycle)))

    # While no test is under way, the next ray's first rectangle is chosen: that ray wants all of them again.
    choose_candidates = assign(candidates, lambda: waiting if take else wanted)

    # The lowest rectangle comes first, so that it wins at equal distances; the others keep waiting.
    @always_comb
    def choose_rectangle():
        lowest.next = 0
        others.next = candidates
        for i in downrange(rectangles):
            if candidates[i]:
                lowest.next = i
                others.next = candidates
                others.next[i] = 0

    # The choice is registered before the fetch, so that choosing and reading have a cycle each.
    offer = register(clk, (upcoming, waiting, offered), lambda: (lowest, others, candidates != 0), take or not fetched)
    ask = assign((index, fetch), lambda: (upcoming, take))

    @always(clk.posedge)
    def advance():
        if reset_ray_caster:
            fetched.next = False
        elif take:
            fetched.next = offered
        if start_ray or early_out or cycle == last_cycle:
            cycle.next = 0
        else:
            cycle.next = cycle + 1

    start = assign(starting, lambda: fetched and cycle == 0)

    return instances()
