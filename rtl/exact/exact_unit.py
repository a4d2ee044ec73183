# SPDX-License-Identifier: MIT
"""A unit of the exact engine: a ray, its nearest hit, its reflections, and the colour of its pixel."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unconnected, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.interfaces import Slope, Vector
from raycaster.rtl.common.records import Colour, Signs, Surface
from raycaster.rtl.common.widths import RGB_BITS, exact_slope_bits, eye_bits, eye_distance_bits, light_slope_bits
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.engine.shade_colour import shade_colour
from raycaster.rtl.exact.cell_finder import cell_finder
from raycaster.rtl.exact.eye_register import Mirror, eye_register
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.ray_switch import ray_switch
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.rtl.exact.shadow_ray import shadow_ray
from raycaster.rtl.exact.shadow_register import shadow_register
from raycaster.rtl.exact.turned_generator import turned_generator


@block
def exact_unit(clk, steps, place, column_base, camera, rect, offered, picture, pixel, fate, config: Configuration):
    """Trace the pixel at (place.row, place.column_offset * `config.units` + column_base), controlled by steps.

    The unit has no control: one exact_control operates all units in lockstep. A hit after the ray has ended does not
    count. With `config.light` the tester also serves the shadow ray, in shadow passes.

    Args:
        steps: `Steps`, common to all units; initial_ray is not read.
        place: `Place`; the group of columns, read with steps.screen_to_ray. With `config.turn` it must be stable from
            the cycle before that on.
        column_base: unsigned, `unit_bits` bits; the unit's column within its group, constant.
        camera: `Camera`; its position is read with steps.screen_to_ray. With `config.turn` its basis, and with
            `config.light` the light, must be stable from the cycle before that until the last step.
        rect: `Rect` to test, a new one each clock; read with steps.find_intersection.
        offered: `Surface` of the rectangle whose test ends; read with steps.write_z_buf.
        picture: `Picture`; only background is read, with steps.add_colour.
        pixel: output `Pixel`; valid after the last step.
        fate: output `RayFate`; alive is driven with `config.culling` or `config.materials`, in_question with
            `config.light`.
    """
    initial_signs, signs = Signs(), Signs()
    slope, eye = Slope(exact_slope_bits(config)), Vector(eye_bits(config))
    mirror, found_surface = Mirror(config), Surface(config)
    at_mirror = bit()
    found_at_mirror = bit() if mirror.has("met_x") else unconnected(1)
    hit, found = bit(), bit()
    missed = bit() if config.follows_fate or config.light else unconnected(1)
    numerator, found_distance = (unsigned(eye_distance_bits(config)) for _ in range(2))
    slope_bits = exact_slope_bits(config)
    denominator = unsigned(slope_bits)
    found_slope = unsigned(slope_bits) if config.varied else unconnected(slope_bits)
    colour = unsigned(RGB_BITS) if config.patterns else found_surface.colour
    ray, shown, tested_denominator = (eye, signs, slope, mirror), colour, denominator
    if config.light:
        light_bits = light_slope_bits(config)
        shadow_signs, shadow_slope = Signs(), Slope(light_bits)
        ray = Vector(eye_bits(config)), Signs(), Slope(light_bits), Mirror(config)
        tested_denominator, shown = unsigned(light_bits), unsigned(RGB_BITS)
    tested_eye, tested_signs, tested_slope, tested_mirror = ray

    if config.turn:
        generator = turned_generator(
            clk=clk, steps=steps, place=place, column_base=column_base, camera=camera, initial_signs=initial_signs,
            slope=slope, config=config,
        )  # fmt: skip
    else:
        generator = ray_generator(
            clk=clk, steps=steps, place=place, column_base=column_base, initial_signs=initial_signs, slope=slope,
            config=config,
        )  # fmt: skip
    memory = eye_register(
        clk=clk, steps=steps, camera=camera, initial_signs=initial_signs, found_surface=found_surface,
        found_distance=found_distance, found_at_mirror=found_at_mirror, eye=eye, signs=signs, mirror=mirror,
    )  # fmt: skip
    tester = rect_tester(
        clk=clk, steps=steps, rect=rect, eye=tested_eye, signs=tested_signs, slope=tested_slope, mirror=tested_mirror,
        hit=hit, at_mirror=at_mirror, numerator=numerator, denominator=tested_denominator,
    )  # fmt: skip
    nearest = nearest_hit(
        clk=clk, steps=steps, offered=offered, hit=hit, at_mirror=at_mirror, numerator=numerator,
        denominator=denominator, found=found, found_surface=found_surface, found_distance=found_distance,
        found_slope=found_slope, found_at_mirror=found_at_mirror,
    )  # fmt: skip
    combiner = colour_combiner(
        clk=clk, steps=steps, found=found, found_colour=shown, found_mirror=found_surface.mirror,
        picture=picture, missed=missed, pixel=pixel, config=config,
    )  # fmt: skip

    if config.patterns:
        odd_u, odd_v = bit(), bit()
        finder = cell_finder(
            clk=clk, steps=steps, eye=eye, signs=signs, slope=slope, found_surface=found_surface,
            found_distance=found_distance, found_slope=found_slope, odd_u=odd_u, odd_v=odd_v,
        )  # fmt: skip
        kept_odd_v = bit() if config.light else odd_v
        painter = pattern_colour(look=found_surface, odd_u=odd_u, odd_v=kept_odd_v, colour=colour)

        if config.light:
            # The divider keeps running during the shadow pass.
            keep_cell = register(clk, kept_odd_v, lambda: odd_v, steps.aim[0])

    if config.light:
        lit_colour, dark, facing, looking, shaded = Colour(), bit(), bit(), bit(), bit()
        switch = ray_switch(
            from_light=looking, camera=camera, eye=eye, signs=signs, slope=slope, mirror=mirror,
            shadow_signs=shadow_signs, shadow_slope=shadow_slope, tested_eye=tested_eye, tested_signs=tested_signs,
            tested_slope=tested_slope, tested_mirror=tested_mirror,
        )  # fmt: skip
        aim = shadow_ray(
            clk=clk, steps=steps, camera=camera, eye=eye, signs=signs, slope=slope, found_surface=found_surface,
            found_distance=found_distance, found_slope=found_slope, shadow_signs=shadow_signs,
            shadow_slope=shadow_slope, facing=facing,
        )  # fmt: skip
        shadow = shadow_register(
            clk=clk, steps=steps, in_question=fate.in_question, hit=hit, numerator=numerator,
            denominator=tested_denominator, found_slope=found_slope, looking=looking, shaded=shaded,
        )  # fmt: skip
        dimmer = shade_colour(colour=lit_colour, dark=dark, shade=camera.light_shade, shaded=shown)

        # The slope of a unit's own ray fits fewer bits.
        narrow = assign(denominator, lambda: tested_denominator[slope_bits:])
        see_dark = assign(dark, lambda: camera.light_on and ((not facing) or shaded))
        ask = assign(fate.in_question, lambda: camera.light_on and found and facing and (not shaded) and not missed)
        look = assign(lit_colour.word, lambda: colour)

    # Hits after a ray has ended do not count.
    if config.materials:
        judge_alive = assign(fate.alive, lambda: found and (found_surface.mirror != 0) and not missed)

    elif config.culling:
        judge_alive = assign(fate.alive, lambda: found and not missed)

    return instances()
