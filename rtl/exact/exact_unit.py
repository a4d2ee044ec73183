# SPDX-License-Identifier: MIT
"""One of the exact engine's units: a ray, its nearest hit, its reflections, and the colour of its pixel."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.interfaces import Eye, Slope
from raycaster.rtl.common.records import Signs, mirror_of, surface_of
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import RGB_BITS, bit, exact_slope_bits, eye_bits, unsigned
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.exact.cell_finder import cell_finder
from raycaster.rtl.exact.eye_register import eye_register
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.rtl.exact.turned_generator import turned_generator


@block
def exact_unit(clk, steps, place, column_base, camera, rect, offered, picture, pixel, fate, config: Configuration):
    """Trace the pixel at (place.row, place.column_offset * `config.units` + column_base) as the steps say.

    The unit has no control: one exact_control operates all units in step. A hit after the ray has ended does not count.

    Args:
        clk: the clock.
        steps: `Steps`, common to all units; initial_ray is not read.
        place: `Place`; the group of columns, read with steps.screen_to_ray. With `config.turn` it holds still from the
            cycle before that on.
        column_base: unsigned, `unit_bits` bits; the unit's column within its group, constant.
        camera: `Camera`; its position is read with steps.screen_to_ray. With `config.turn` its basis holds still from
            the cycle before that on.
        rect: `Rect` to test, a new one each clock; read with steps.find_intersection.
        offered: `Surface` of the rectangle whose verdict is due; read with steps.write_z_buf.
        picture: `Picture`; only background is read, with steps.add_colour.
        pixel: output `Pixel`; valid after the last step.
        fate: output `RayFate`; only alive is driven, with `config.culling` or `config.materials`.
        config: the design.
    """
    initial_signs, signs = Signs(), Signs()
    slope, eye = Slope(exact_slope_bits(config)), Eye(eye_bits(config))
    mirror, found_surface = mirror_of(config), surface_of(config)
    at_mirror = bit()
    found_at_mirror = bit() if mirror.has("met_x") else unconnected(1)
    hit, found = bit(), bit()
    missed = bit() if config.culling or config.materials else unconnected(1)
    numerator, found_distance = (unsigned(eye_bits(config) - 1) for _ in range(2))
    denominator = unsigned(exact_slope_bits(config))
    found_slope = unsigned(len(denominator)) if config.patterns else unconnected(len(denominator))
    colour = unsigned(RGB_BITS) if config.patterns else found_surface.colour

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
        clk=clk, steps=steps, rect=rect, eye=eye, signs=signs, slope=slope, mirror=mirror, hit=hit,
        at_mirror=at_mirror, numerator=numerator, denominator=denominator,
    )  # fmt: skip
    nearest = nearest_hit(
        clk=clk, steps=steps, offered=offered, hit=hit, at_mirror=at_mirror, numerator=numerator,
        denominator=denominator, found=found, found_surface=found_surface, found_distance=found_distance,
        found_slope=found_slope, found_at_mirror=found_at_mirror,
    )  # fmt: skip
    combiner = colour_combiner(
        clk=clk, steps=steps, found=found, found_colour=colour, found_mirror=found_surface.mirror,
        picture=picture, missed=missed, pixel=pixel, config=config,
    )  # fmt: skip

    if config.patterns:
        odd_u, odd_v = bit(), bit()
        finder = cell_finder(
            clk=clk, steps=steps, eye=eye, signs=signs, slope=slope, found_surface=found_surface,
            found_distance=found_distance, found_slope=found_slope, odd_u=odd_u, odd_v=odd_v,
        )  # fmt: skip
        painter = pattern_colour(look=found_surface, odd_u=odd_u, odd_v=odd_v, colour=colour)

    # What a ray that has ended goes on to hit does not count.
    if config.materials:

        @always_comb
        def judge_alive():
            fate.alive.next = found and (found_surface.mirror != 0) and not missed

    elif config.culling:

        @always_comb
        def judge_alive():
            fate.alive.next = found and not missed

    return instances()
