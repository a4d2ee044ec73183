# SPDX-License-Identifier: MIT
"""The one control that operates all units of the exact engine in step."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Surface
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.engine.ray_sequencer import ray_sequencer

SLOT_CYCLES = 1
WRITE_AT = 2
"""The last bit of in_flight, which comes three cycles after find_intersection."""


@block
def exact_control(
    clk, reset_ray_caster, enable, reflections, rects, steps, prospects, offered, done, config: Configuration
):
    """A ray_sequencer that takes a rectangle a clock, with done and the other ports as it has them.

    write_z_buf follows find_intersection by three cycles, the latency of rect_tester; offered is the rectangle that
    find_intersection then started on.
    """
    in_flight = unsigned(WRITE_AT + 1)
    first, second = Surface(), Surface()

    sequencer = ray_sequencer(
        clk, reset_ray_caster, enable, reflections, rects, steps, in_flight, prospects, tied(0, bit()), done,
        SLOT_CYCLES, config,
    )  # fmt: skip

    # Its verdict is due.
    @always_comb
    def operate_stages():
        steps.write_z_buf.next = in_flight[WRITE_AT]

    # The rectangle moves with its tests: it is the same for all units, so they need no copies.
    @always(clk.posedge)
    def carry_rectangle():
        first.axis.next = rects.rect.axis
        first.position.next = rects.rect.position
        first.colour.next = rects.rect.colour
        second.axis.next = first.axis
        second.position.next = first.position
        second.colour.next = first.colour
        offered.axis.next = second.axis
        offered.position.next = second.position
        offered.colour.next = second.colour

    return sequencer, operate_stages, carry_rectangle
