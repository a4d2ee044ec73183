# SPDX-License-Identifier: MIT
"""The life of a group of rays, whatever computes where they hit."""

from myhdl import Signal, always, always_comb, block, enum

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.engine.rect_sequencer import rect_sequencer

GIVE_UP_AT = 2
"""Cycles from find_intersection to when it may be given up."""

RayState = enum("IDLE", "GENERATE", "TRACE", "BLEND", "DONE")


def impatient(config: Configuration) -> bool:
    """Whether a design gives rectangles up within their slot, which must be longer than it takes to know."""
    return config.culling and config.slot_cycles > GIVE_UP_AT + 1


@block
def ray_sequencer(
    clk,
    reset_ray_caster,
    enable,
    reflections,
    rects,
    steps,
    in_flight,
    prospects,
    give_up,
    done,
    slot_cycles,
    config: Configuration,
):
    """Cycle through the usable rectangles once a ray, for the primary ray and each reflection, then raise done.

    A new rectangle starts every slot_cycles: steps.find_intersection. Bit i of in_flight is set i + 1 cycles later; its
    last bit goes with the last that a rectangle needs. When nothing is in flight after the last rectangle, BLEND
    follows, and then the next ray. enable is looked at while idle; done stays until reset_ray_caster, which is
    synchronous. reflections: 0 to config.reflections, still while rendering; rects.usable: from the cycle that looks at
    enable.

    prospects: a primary ray passes by the rectangles that are not possible; when none is alive, BLEND follows BLEND
    until done, and none may come alive again. give_up: high in the second cycle after the start of a rectangle that
    nobody hits; the next one starts in the cycle after it.
    """
    write_at = len(in_flight) - 1
    given_up = GIVE_UP_AT

    state = Signal(RayState.IDLE)
    bounce = unsigned(2)
    start_ray, fetched, starting = bit(), bit(), bit()
    wanted = unsigned(config.rectangles)
    if config.fixed:
        first, second, third = (config.passes + 2 * (0,))[:3]

    sequencer = rect_sequencer(
        clk, reset_ray_caster, start_ray, wanted, give_up, rects.index, rects.fetch, fetched, starting, slot_cycles,
        config,
    )  # fmt: skip

    # A new ray follows two of the states.
    @always_comb
    def see_start():
        start_ray.next = steps.screen_to_ray or steps.add_colour

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
                if prospects.alive:
                    state.next = RayState.TRACE

    # What each state asserts.
    @always_comb
    def operate():
        steps.screen_to_ray.next = state == RayState.GENERATE
        steps.reset_colour.next = state == RayState.GENERATE
        steps.reset_z_buf.next = start_ray
        steps.add_colour.next = state == RayState.BLEND
        # A ray that nothing follows would be one mirror too many for an engine that mirrors the eye.
        steps.store_ray.next = (state == RayState.BLEND) and (bounce != reflections)
        steps.initial_ray.next = bounce == 0
        steps.find_intersection.next = (state == RayState.TRACE) and starting
        done.next = state == RayState.DONE

    # Follow each rectangle on its way to the z buffer.
    @always(clk.posedge)
    def follow():
        if reset_ray_caster:
            in_flight.next = 0
        else:
            in_flight.next[write_at + 1 : 1] = in_flight[write_at:]
            in_flight.next[0] = steps.find_intersection
            if give_up:
                in_flight.next[given_up] = False

    common = sequencer, see_start, advance, operate, follow

    if not config.fixed:
        # Those that the next ray may meet.
        @always_comb
        def choose_possible():
            wanted.next = rects.usable & prospects.possible
            if state == RayState.TRACE:
                wanted.next = rects.usable

        return common, choose_possible

    # Those that the next ray may meet.
    @always_comb
    def choose_wanted():
        wanted.next = first
        if state == RayState.TRACE:
            if bounce == 0:
                wanted.next = second
            else:
                wanted.next = third

    return common, choose_wanted
