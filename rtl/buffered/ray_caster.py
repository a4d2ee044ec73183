# SPDX-License-Identifier: MIT
"""The ray caster of an engine with a line buffer: one control, and units that it operates in lockstep."""

from collections.abc import Callable

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, side_by_side, tied, unconnected, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import GroupFate, RayFate, Steps
from raycaster.rtl.common.records import Pixel, Rect, Surface
from raycaster.rtl.common.widths import unit_bits
from raycaster.rtl.cull.group_culler import group_culler
from raycaster.rtl.engine.ray_sequencer import ends_early


@block
def ray_caster(
    clk, reset_ray_caster, enable, place, camera, picture, rects, done, pixels, config: Configuration,
    control: Callable, unit: Callable,
):  # fmt: skip
    """Compute the pixels of `config.units` neighbouring columns at once.

    It starts when enable is high and reset_ray_caster low. place and the scene must then be stable until done.

    Args:
        reset_ray_caster: synchronous, active high.
        enable: flag; starts a group.
        place: `Place` of the group.
        camera: `Camera` of the live scene.
        picture: `Picture` of the live scene; run is not read.
        rects: `Rects`; drives index and fetch, reads usable and rect.
        done: flag; output, the group is complete. It stays high until reset_ray_caster.
        pixels: unsigned, a `Pixel` word of `pixel_bits` bits for each of the `config.units` units, unit 0 in the lowest
            bits; output, valid from done to reset_ray_caster.
        control: the engine's block that operates all units.
        unit: the engine's block of one unit.
    """
    # With a mirrored eye, all rays are traced alike.
    steps = Steps(initial_ray=bit() if config.facts.divides else unconnected(1))
    offered = Rect(config) if config.facts.divides else Surface(config)
    unit_pixels = [Pixel(config.colour_bits) for _ in range(config.units)]
    fates = [RayFate() for _ in range(config.units)]
    together = side_by_side([pixel.word for pixel in unit_pixels])
    alive = side_by_side([fate.alive for fate in fates])
    towards = side_by_side([fate.towards for fate in fates])
    in_question = side_by_side([fate.in_question for fate in fates])
    # The prediction requires that only the slope's y component changes with the column.
    predicts = config.culling and not config.turn
    fate = GroupFate(
        config,
        any_towards=None if ends_early(config) else tied(1, 1),
        any_alive=None if config.follows_fate else tied(1, 1),
        may_hit=None if predicts else tied((1 << config.rectangles) - 1, unsigned(config.rectangles)),
    )

    operator = control(
        clk=clk, reset_ray_caster=reset_ray_caster, enable=enable, picture=picture, rects=rects, steps=steps, fate=fate,
        offered=offered, done=done, config=config,
    )  # fmt: skip
    units = [
        unit(
            clk=clk, steps=steps, place=place, column_base=tied(number, unit_bits(config)), camera=camera,
            rect=rects.rect, offered=offered, picture=picture, pixel=unit_pixels[number], fate=fates[number],
            config=config,
        )
        for number in range(config.units)
    ]  # fmt: skip

    join_pixels = assign(pixels, lambda: together)

    if predicts:
        culler = group_culler(
            clk=clk, reset_ray_caster=reset_ray_caster, start_group=steps.screen_to_ray, done=done, place=place,
            camera=camera, rects=rects, may_hit=fate.may_hit, config=config,
        )  # fmt: skip

    if config.follows_fate:
        judge_alive = assign(fate.any_alive, lambda: alive != 0)

    if config.light:
        judge_light = assign(fate.any_in_question, lambda: in_question != 0)

    if ends_early(config):
        judge_towards = assign(fate.any_towards, lambda: towards != 0)

    return instances()
