# SPDX-License-Identifier: MIT
"""The one control that operates all ray units in step."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Rect
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.engine.ray_sequencer import impatient, ray_sequencer


@block
def ray_control(
    clk,
    reset_ray_caster,
    enable,
    reflections,
    rects,
    steps,
    prospects,
    finishing_rect,
    done,
    config: Configuration,
):
    """A ray_sequencer around the dividers, with done and the other ports as it has them.

    A new rectangle starts every config.divider_steps cycles: with find_intersection in cycle t, load_divider is in
    t + 2, store_quotient in t + 2 + divider_steps (together with the next rectangle's load_divider) and write_z_buf two
    cycles later. finishing_rect is the rectangle whose quotients were stored. An impatient control gives a rectangle up
    in t + 2 if no ray runs towards it: prospects.ahead is low in t + 1.
    """
    slot_cycles = config.divider_steps
    load_at = 1
    store_at = load_at + slot_cycles
    write_at = store_at + 2

    in_flight = unsigned(write_at + 1)
    hopeless, give_up = bit(), bit() if impatient(config) else tied(0, bit())
    dividing_rect = Rect()

    sequencer = ray_sequencer(
        clk, reset_ray_caster, enable, reflections, rects, steps, in_flight, prospects, give_up, done, slot_cycles,
        config,
    )  # fmt: skip

    # Stages that lie a fixed number of cycles behind the start.
    @always_comb
    def operate_stages():
        steps.load_divider.next = in_flight[load_at]
        steps.store_quotient.next = in_flight[store_at]
        steps.write_z_buf.next = in_flight[write_at]

    # The rectangle moves with its division: it is the same for all units, so they need no copies.
    @always(clk.posedge)
    def carry_rectangle():
        if steps.load_divider:
            dividing_rect.axis.next = rects.rect.axis
            dividing_rect.position.next = rects.rect.position
            dividing_rect.u_low.next = rects.rect.u_low
            dividing_rect.u_high.next = rects.rect.u_high
            dividing_rect.v_low.next = rects.rect.v_low
            dividing_rect.v_high.next = rects.rect.v_high
            dividing_rect.colour.next = rects.rect.colour
        if steps.store_quotient:
            finishing_rect.axis.next = dividing_rect.axis
            finishing_rect.position.next = dividing_rect.position
            finishing_rect.u_low.next = dividing_rect.u_low
            finishing_rect.u_high.next = dividing_rect.u_high
            finishing_rect.v_low.next = dividing_rect.v_low
            finishing_rect.v_high.next = dividing_rect.v_high
            finishing_rect.colour.next = dividing_rect.colour

    common = sequencer, operate_stages, carry_rectangle
    if not impatient(config):
        return common

    # All units together take a cycle to say that the plane lies behind them.
    @always(clk.posedge)
    def look_ahead():
        hopeless.next = not prospects.ahead

    # Its division has just begun.
    @always_comb
    def judge():
        give_up.next = in_flight[load_at] and hopeless

    return common, look_ahead, judge
