# SPDX-License-Identifier: MIT
"""The control that operates all units of the exact engine in lockstep."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, tied, unconnected, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.interfaces import ShadowPass
from raycaster.rtl.common.records import Surface
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.exact.cell_finder import DIVISION_CYCLES
from raycaster.rtl.exact.rect_tester import LATENCY
from raycaster.rtl.exact.shadow_sequencer import shadow_sequencer

WRITE_AT = LATENCY - 1
"""Bit of in_flight that is set when a unit's test ends."""

PATTERN_LATENCY = 2 * DIVISION_CYCLES
"""Cycles until the cells of a pattern are known, u before v."""


@block
def exact_control(clk, reset_ray_caster, enable, picture, rects, steps, fate, offered, done, config: Configuration):
    """Operate all units of the exact engine in lockstep, with a ray_sequencer that starts a rectangle per clock.

    steps.write_z_buf follows steps.find_intersection by `LATENCY` cycles, those of rect_tester; in a shadow pass, with
    `config.light`, steps.write_shadow does so instead. With `config.patterns` a pass continues until the cells of the
    nearest hit are known: steps.load_divider comes in the cycle after each steps.write_z_buf, and steps.store_quotient
    `DIVISION_CYCLES` cycles after the last steps.load_divider.

    Ports that ray_sequencer also has work as described there.

    Args:
        reset_ray_caster: flag; synchronous reset to idle.
        enable: flag, read while idle; starts a group of rays.
        picture: `Picture`; only reflections is read: 0 to `config.most_reflections`, stable while rendering.
        rects: `Rects`; index and fetch are outputs. usable must be stable from the cycle that reads enable on; the
            surface of rect is read.
        steps: output `Steps`, for all units; load_divider and store_quotient are driven with `config.patterns`.
        fate: `GroupFate`; may_hit and any_alive as in ray_sequencer, any_in_question as in shadow_sequencer, and
            any_towards is not read.
        offered: output `Surface`; in the cycle of steps.write_z_buf, the surface of the rectangle whose
            steps.find_intersection came `LATENCY` cycles before.
        done: output flag; all rays have been traced. High until reset_ray_caster.
    """
    in_flight = unsigned(WRITE_AT + 1 + (PATTERN_LATENCY if config.patterns else 0))
    first, second = (Surface(config) for _ in range(LATENCY - 1))
    # Unless the scene is fixed, a shadow pass wants the same rectangles as a reflection.
    shadow_pass = ShadowPass(comes_next=None if config.fixed else unconnected(1))
    from_light = bit() if config.light else tied(0, 1)

    sequencer = ray_sequencer(
        clk=clk, reset_ray_caster=reset_ray_caster, enable=enable, picture=picture, rects=rects, steps=steps,
        in_flight=in_flight, fate=fate, shadow_pass=shadow_pass, early_out=tied(0, 1), done=done,
        rect_cycles=1, config=config,
    )  # fmt: skip

    if config.light:
        shadows = shadow_sequencer(
            clk=clk, reset_ray_caster=reset_ray_caster, shadow_pass=shadow_pass, any_in_question=fate.any_in_question,
            aim=steps.aim, from_light=from_light,
        )  # fmt: skip

        operate_shadows = assign(steps.write_shadow, lambda: in_flight[WRITE_AT] and from_light)

    operate_stages = assign(steps.write_z_buf, lambda: in_flight[WRITE_AT] and not from_light)

    if config.patterns:
        load_at, store_at = WRITE_AT + 1, WRITE_AT + 1 + DIVISION_CYCLES

        load = assign(steps.load_divider, lambda: in_flight[load_at] and not from_light)
        store = assign(
            steps.store_quotient, lambda: in_flight[store_at] and (in_flight[store_at:] == 0) and not from_light
        )

    # The surface is delayed along with its tests here, once for all units.
    carry_surface = register(
        clk, (first.word, second.word, offered.word), lambda: (rects.rect.surface, first.word, second.word)
    )

    return instances()
