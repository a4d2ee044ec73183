# SPDX-License-Identifier: MIT
"""The one control that operates all ray units in step."""

from myhdl import Signal, always, always_comb, block, downrange, enum

from raycaster.configuration import Configuration
from raycaster.rtl.interfaces import Rect
from raycaster.rtl.widths import bit, bits_for, index_bits, unsigned

RayState = enum("IDLE", "GENERATE", "TRACE", "BLEND", "DONE")


@block
def ray_control(clk, reset_ray_caster, enable, reflections, rects, steps, finishing_rect, done, config: Configuration):
    """Cycle through the usable rectangles once a ray, for the primary ray and each reflection, then raise done.

    A new rectangle starts every config.divider_steps cycles: with find_intersection in cycle t, load_divider is in
    t + 2, store_quotient in t + 2 + divider_steps (together with the next rectangle's load_divider) and write_z_buf two
    cycles later; after the last one BLEND follows, and then the next ray. finishing_rect is the rectangle whose
    quotients were stored. enable is looked at while idle; done stays until reset_ray_caster, which is synchronous.
    reflections: 0 to config.reflections, still while rendering; rects.usable: from the cycle that looks at enable.
    """
    rectangles = config.rectangles
    last_slot = config.divider_steps - 1
    load_at = 1
    store_at = load_at + config.divider_steps
    write_at = store_at + 2

    state = Signal(RayState.IDLE)
    bounce = unsigned(2)
    slot = unsigned(bits_for(config.divider_steps))
    candidates, waiting, others = (unsigned(rectangles) for _ in range(3))
    lowest, upcoming = (unsigned(index_bits(config)) for _ in range(2))
    offered, fetched, take = (bit() for _ in range(3))
    start_ray = bit()
    in_flight = unsigned(write_at + 1)  # bit i is set i + 1 cycles after a find_intersection
    dividing_rect = Rect()

    # A new ray follows two of the states.
    @always_comb
    def see_start():
        start_ray.next = steps.screen_to_ray or steps.add_color

    # The rectangle at hand has had its time slot.
    @always_comb
    def see_take():
        take.next = start_ray or (fetched and slot == last_slot)

    # While nothing is at hand, the next ray's first rectangle is looked for: it wants all of them again.
    @always_comb
    def choose_candidates():
        if take:
            candidates.next = waiting
        else:
            candidates.next = rects.usable

    # The lowest rectangle comes first, so that of equals the lower one wins; the others go on waiting.
    @always_comb
    def choose_rectangle():
        lowest.next = 0
        others.next = candidates
        for i in downrange(rectangles):
            if candidates[i]:
                lowest.next = i
                others.next = candidates
                others.next[i] = 0

    # The choice stands in registers before it is fetched: memory and sorter take most of a cycle by themselves.
    @always(clk.posedge)
    def offer():
        if take or not fetched:
            upcoming.next = lowest
            waiting.next = others
            offered.next = candidates != 0

    # A rectangle is fetched in the cycle before it may start.
    @always_comb
    def fetch():
        rects.index.next = upcoming
        rects.fetch.next = take

    # Whether there is a rectangle at hand, and the place in its time slot.
    @always(clk.posedge)
    def take_slots():
        if reset_ray_caster:
            fetched.next = False
        elif take:
            fetched.next = offered
        if start_ray or slot == last_slot:
            slot.next = 0
        else:
            slot.next = slot + 1

    # Where a ray is in its life.
    @always(clk.posedge)
    def advance():
        if reset_ray_caster:
            state.next = RayState.IDLE
        elif state == RayState.IDLE:
            if enable:
                state.next = RayState.GENERATE
        elif state == RayState.GENERATE:
            bounce.next = 0
            state.next = RayState.TRACE
        elif state == RayState.TRACE:
            if (not fetched) and (in_flight[write_at:] == 0):
                state.next = RayState.BLEND
        elif state == RayState.BLEND:
            if bounce == reflections:
                state.next = RayState.DONE
            else:
                bounce.next = bounce + 1
                state.next = RayState.TRACE

    # What each state asserts.
    @always_comb
    def operate():
        steps.screen_to_ray.next = state == RayState.GENERATE
        steps.reset_color.next = state == RayState.GENERATE
        steps.reset_z_buf.next = start_ray
        steps.add_color.next = state == RayState.BLEND
        steps.store_ray.next = state == RayState.BLEND
        steps.initial_ray.next = bounce == 0
        steps.find_intersection.next = (state == RayState.TRACE) and fetched and (slot == 0)
        done.next = state == RayState.DONE

    # Follow each rectangle on its way to the z buffer.
    @always(clk.posedge)
    def follow():
        if reset_ray_caster:
            in_flight.next = 0
        else:
            in_flight.next[write_at + 1 : 1] = in_flight[write_at:]
            in_flight.next[0] = steps.find_intersection

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

    return (
        see_start, see_take, choose_candidates, choose_rectangle, offer, fetch, take_slots, advance, operate, follow,
        operate_stages, carry_rectangle,
    )  # fmt: skip
