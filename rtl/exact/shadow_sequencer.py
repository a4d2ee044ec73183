# SPDX-License-Identifier: MIT
"""The sequence of shadow passes."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import AIM_CYCLES

ShadowState = enum("WAIT", "AIM", "TEST")


@block
def shadow_sequencer(clk, reset_ray_caster, shadow_pass, any_in_question, aim, from_light):
    """Add a shadow pass after each pass of the rays, if the light may reach the hit point of any unit.

    When shadow_pass.traced reports the end of a pass, the units compute their shadow rays in the cycles of aim. The
    shadow pass begins in the cycle after the last of these. It ends with its last rectangle, or as soon as no hit point
    is in question; shadow_pass.stop then drops the tests in flight.

    Args:
        reset_ray_caster: flag; synchronous reset to idle.
        shadow_pass: `ShadowPass`; traced is read, and the rest is driven.
        any_in_question: flag of `GroupFate`; read in the last cycle of aim and in each cycle of the shadow pass, so it
            must be valid in the cycle after a steps.write_shadow.
        aim: output, as in `Steps`.
        from_light: output, as in `Steps`; high from the cycle after aim until the pass is over.
    """
    last = AIM_CYCLES - 1

    state = Signal(ShadowState.WAIT)
    cycle = unsigned(AIM_CYCLES)
    aimed, decided = bit(), bit()

    @always(clk.posedge)
    def advance():
        if reset_ray_caster:
            state.next = ShadowState.WAIT
        elif state == ShadowState.WAIT:
            cycle.next = 1
            if shadow_pass.traced:
                state.next = ShadowState.AIM
        elif state == ShadowState.AIM:
            cycle.next[AIM_CYCLES:1] = cycle[last:]
            cycle.next[0] = False
            if aimed:
                state.next = ShadowState.WAIT
                if any_in_question:
                    state.next = ShadowState.TEST
        elif shadow_pass.traced:
            state.next = ShadowState.WAIT

    see_end = assign((aimed, decided), lambda: (cycle[last], (state == ShadowState.TEST) and not any_in_question))
    operate_aim = assign(aim, lambda: cycle if state == ShadowState.AIM else 0)
    operate_from_light = assign(from_light, lambda: state == ShadowState.TEST)

    # The rays continue after the last cycle of AIM or TEST.
    @always_comb
    def ask():
        shadow_pass.awaited.next = state != ShadowState.TEST
        if (state == ShadowState.AIM) and aimed and not any_in_question:
            shadow_pass.awaited.next = False
        shadow_pass.comes_next.next = (state == ShadowState.WAIT) or ((state == ShadowState.AIM) and not aimed)
        shadow_pass.start.next = (state == ShadowState.AIM) and aimed and any_in_question
        shadow_pass.stop.next = decided and not shadow_pass.traced

    return instances()
