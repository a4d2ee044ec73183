# SPDX-License-Identifier: MIT
"""The sequence of steps that traces a group of rays, whichever engine computes the hits."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import REFLECTION_BITS
from raycaster.rtl.engine.rect_sequencer import rect_sequencer

EARLY_OUT_AT = 2
"""Cycles from find_intersection to early_out."""

RayState = enum("IDLE", "GENERATE", "TRACE", "BLEND", "DONE")


def ends_early(config: Configuration) -> bool:
    """Return True if a design ends rectangles early, which takes more cycles per rectangle than early_out does."""
    return config.culling and config.facts.divides and config.divider_steps > EARLY_OUT_AT + 1


@block
def ray_sequencer(
    clk, reset_ray_caster, enable, picture, rects, steps, in_flight, fate, shadow_pass, early_out, done, rect_cycles,
    config: Configuration,
):  # fmt: skip
    """Cycle through the usable rectangles once per ray, for the primary ray and each reflection, then raise done.

    A new rectangle starts every `rect_cycles` cycles, with steps.find_intersection. When nothing is in flight after the
    last rectangle, BLEND follows, and then the next ray. In a fixed scene, the primary ray and each reflection cycle
    through their own sets of rectangles that they may hit, instead of the usable ones.

    With `config.light` a shadow pass may follow each pass, before BLEND: shadow_pass starts it.

    Culling skips rectangles and rays that cannot change a pixel, and is correct if its signals are valid in time:

    - fate.may_hit is read in the same cycle as enable, and the primary ray skips the rectangles whose bit is 0. Ones
      are always safe, so a mask that is not known in time is all ones.
    - fate.any_alive is read only in BLEND, the cycle after the last steps.write_z_buf and the first in which the units
      know its hit (later if exact_control waits for a pattern's cells). So there is no time for a register: a cycle
      later, the last rectangle would not count. If it is low, BLEND repeats until done, so no unit may become alive
      again before the next group.
    - fate.any_towards is valid in the cycle after steps.find_intersection, from the units' registers, and belongs to
      that rectangle until its early_out, `EARLY_OUT_AT` cycles after steps.find_intersection. There is time for one
      register, in the control. early_out ends the test of a rectangle that no ray runs towards, and clears its bit of
      in_flight; a cycle later the rectangle would be past that bit, and its division would be stored.

    Args:
        reset_ray_caster: flag; synchronous reset to idle.
        enable: flag, read while idle; starts a group of rays.
        picture: `Picture`; only reflections is read: 0 to `config.most_reflections`, stable while rendering.
        rects: `Rects`; index and fetch are outputs. usable must be stable from the cycle that reads enable on; rect is
            not read.
        steps: output `Steps`, except load_divider, store_quotient, write_z_buf and the signals of shadows, which the
            control derives from in_flight.
        in_flight: unsigned output; bit i is set i + 1 cycles after a rectangle's steps.find_intersection, and the last
            bit marks the last cycle that a rectangle needs.
        fate: `GroupFate`; may_hit and any_alive are read. any_towards is left to the control, which derives early_out
            from it.
        shadow_pass: `ShadowPass`, used with `config.light`; drives traced, reads the rest.
        early_out: flag, `EARLY_OUT_AT` cycles after steps.find_intersection; no ray runs towards that rectangle. Tied
            to 0 if rectangles are not ended early.
        done: output flag; all rays have been traced. High until reset_ray_caster.
        rect_cycles: cycles from one rectangle to the next.
    """
    write_at, dropped = len(in_flight) - 1, EARLY_OUT_AT

    state = Signal(RayState.IDLE)
    bounce = unsigned(REFLECTION_BITS)
    start_ray, fetched, starting = bit(), bit(), bit()
    traced = bit()
    passed, restart, stop = (bit(), bit(), bit()) if config.light else (traced, start_ray, reset_ray_caster)
    wanted = unsigned(config.rectangles)
    if config.fixed:
        first, *reflected = config.passes
        unused = [0] * (1 << REFLECTION_BITS)
        masks, shadow_masks = (tuple([*passes, *unused][: len(unused)]) for passes in (reflected, config.shadows))
        wanted_next = unsigned(config.rectangles)

    sequencer = rect_sequencer(
        clk=clk, reset_ray_caster=stop, start_ray=restart, wanted=wanted, early_out=early_out,
        index=rects.index, fetch=rects.fetch, fetched=fetched, starting=starting, rect_cycles=rect_cycles,
        config=config,
    )  # fmt: skip

    see_start = assign(start_ray, lambda: steps.screen_to_ray or steps.add_colour)
    see_end = assign(traced, lambda: (state == RayState.TRACE) and (not fetched) and (in_flight[write_at:] == 0))

    if config.light:
        wait_for_light = assign((shadow_pass.traced, passed), lambda: (traced, traced and not shadow_pass.awaited))
        follow_light = assign(
            (restart, stop), lambda: (start_ray or shadow_pass.start, reset_ray_caster or shadow_pass.stop)
        )

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
            if passed:
                state.next = RayState.BLEND
        elif state == RayState.BLEND:
            if bounce == picture.reflections:
                state.next = RayState.DONE
            else:
                bounce.next = bounce + 1
                if fate.any_alive:
                    state.next = RayState.TRACE

    @always_comb
    def operate():
        steps.screen_to_ray.next = steps.reset_colour.next = state == RayState.GENERATE
        steps.reset_z_buf.next = start_ray
        steps.add_colour.next = state == RayState.BLEND
        # The last ray stores no reflection: that would be one mirror too many for an engine that mirrors the eye.
        steps.store_ray.next = (state == RayState.BLEND) and (bounce != picture.reflections)
        steps.initial_ray.next = bounce == 0
        steps.find_intersection.next = (state == RayState.TRACE) and starting
        done.next = state == RayState.DONE

    @always(clk.posedge)
    def follow():
        if stop:
            in_flight.next = 0
        else:
            in_flight.next[write_at + 1 : 1] = in_flight[write_at:]
            in_flight.next[0] = steps.find_intersection
            if early_out:
                in_flight.next[dropped] = False

    # While a ray is traced, the next one is a reflection, which may hit any rectangle.
    if config.fixed:
        after_this = unsigned(config.rectangles) if config.light else wanted_next

        look_ahead = assign(after_this, lambda: masks[bounce])

        if config.light:
            from_light = unsigned(config.rectangles)

            look_from_light = assign(from_light, lambda: shadow_masks[bounce])
            choose_next = assign(wanted_next, lambda: from_light if shadow_pass.comes_next else after_this)

        choose_wanted = assign(wanted, lambda: wanted_next if state == RayState.TRACE else first)

    else:
        choose_wanted = assign(wanted, lambda: rects.usable if state == RayState.TRACE else rects.usable & fate.may_hit)

    return instances()
