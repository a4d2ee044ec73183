# SPDX-License-Identifier: MIT
"""The control that operates all units of the seed engine in lockstep."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.interfaces import ShadowPass
from raycaster.rtl.common.records import Rect
from raycaster.rtl.engine.ray_sequencer import EARLY_OUT_AT, ends_early, ray_sequencer
from raycaster.rtl.seed.intersection_helper import LOAD_AT, WRITE_AFTER


@block
def ray_control(clk, reset_ray_caster, enable, picture, rects, steps, fate, offered, done, config: Configuration):
    """Operate all units of the seed engine in lockstep, with a ray_sequencer that keeps pace with the dividers.

    A new rectangle starts every `config.divider_steps` cycles: with steps.find_intersection in cycle t,
    steps.load_divider comes in t + `LOAD_AT`, steps.store_quotient `config.divider_steps` cycles later (together with
    the next rectangle's steps.load_divider) and steps.write_z_buf `WRITE_AFTER` cycles after that. The early_out of
    ray_sequencer comes in t + `EARLY_OUT_AT`, from the fate.any_towards of the cycle before.

    Ports that ray_sequencer also has work as described there.

    Args:
        reset_ray_caster: flag; synchronous reset to idle.
        enable: flag, read while idle; starts a group of rays.
        picture: `Picture`; only reflections is read: 0 to `config.most_reflections`, stable while rendering.
        rects: `Rects`; index and fetch are outputs. usable must be stable from the cycle that reads enable on; rect is
            copied with steps.load_divider.
        steps: output `Steps`, for all units.
        fate: `GroupFate`; may_hit and any_alive as in ray_sequencer. any_towards is valid in the cycle after
            steps.find_intersection.
        offered: output `Rect`; the rectangle whose quotients were stored last.
        done: output flag; all rays have been traced. High until reset_ray_caster.
    """
    # Bit i of in_flight comes i + 1 cycles after find_intersection.
    load_at, dropped = LOAD_AT - 1, EARLY_OUT_AT - 1
    store_at = load_at + config.divider_steps
    write_at = store_at + WRITE_AFTER

    in_flight = unsigned(write_at + 1)
    none_towards = bit()
    early_out = bit() if ends_early(config) else tied(0, 1)
    dividing = Rect(config)

    sequencer = ray_sequencer(
        clk=clk, reset_ray_caster=reset_ray_caster, enable=enable, picture=picture, rects=rects, steps=steps,
        in_flight=in_flight, fate=fate, shadow_pass=ShadowPass(), early_out=early_out, done=done,
        rect_cycles=config.divider_steps, config=config,
    )  # fmt: skip

    operate_stages = assign(
        (steps.load_divider, steps.store_quotient, steps.write_z_buf),
        lambda: (in_flight[load_at], in_flight[store_at], in_flight[write_at]),
    )

    # The rectangle is delayed along with its division here, once for all units.
    @always(clk.posedge)
    def carry_rectangle():
        if steps.load_divider:
            dividing.word.next = rects.rect.word
        if steps.store_quotient:
            offered.word.next = dividing.word

    if ends_early(config):
        # The combined flag of all units is registered here; see ray_sequencer.
        register_towards = register(clk, none_towards, lambda: not fate.any_towards)

        end_early = assign(early_out, lambda: in_flight[dropped] and none_towards)

    return instances()
