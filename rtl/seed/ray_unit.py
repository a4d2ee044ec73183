# SPDX-License-Identifier: MIT
"""A unit of the seed engine: a ray, its nearest hit, its reflections, and the colour of its pixel."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, tied, unconnected, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.records import Signs
from raycaster.rtl.common.widths import AXIS_BITS, MIRROR_BITS, RGB_BITS, position_bits
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.engine.ray_sequencer import ends_early
from raycaster.rtl.seed.intersection_finder import intersection_finder
from raycaster.rtl.seed.ray_mem import Origin, Ray, ray_mem
from raycaster.rtl.seed.z_buffer import z_buffer


@block
def ray_unit(clk, steps, place, column_base, camera, rect, offered, picture, pixel, fate, config: Configuration):
    """Trace the pixel at (place.row, place.column_offset * `config.units` + column_base), controlled by steps.

    The unit has no control: one ray_control operates all units in lockstep. A hit after the ray has ended does not
    count.

    Args:
        steps: `Steps`, common to all units.
        place: `Place`; the group of columns, read with steps.screen_to_ray.
        column_base: unsigned, `unit_bits` bits; the unit's column within its group, constant.
        camera: `Point`; the start of all primary rays.
        rect: `Rect` whose test steps.find_intersection starts.
        offered: `Rect` whose quotients were stored last.
        picture: `Picture`; only background is read, with steps.add_colour.
        pixel: output `Pixel`; valid after the last step.
        fate: output `RayFate`; alive is driven with `config.culling` or `config.materials`, and towards if the control
            ends rectangles early.
    """
    fraction_bits = config.fraction_bits

    initial_signs, slope = Signs(), Slope()
    ray, reflected = Ray(config), Ray(config)
    point, found_point = Origin(config), Origin(config)
    hit, found = bit(), bit()
    towards = bit() if ends_early(config) else unconnected(1)
    missed = bit() if config.follows_fate else unconnected(1)
    depth = unsigned(position_bits(config))
    found_axis, found_colour = unsigned(AXIS_BITS), unsigned(RGB_BITS)
    found_mirror = unsigned(MIRROR_BITS) if config.materials else tied(0, MIRROR_BITS)
    colour = unsigned(RGB_BITS) if config.patterns else offered.colour
    odd_u, odd_v = (bit() if config.patterns else tied(0, 1) for _ in range(2))
    start_x, start_y, start_z = (unsigned(position_bits(config)) for _ in range(3))

    generator = ray_generator(
        clk=clk, steps=steps, place=place, column_base=column_base, initial_signs=initial_signs, slope=slope,
        config=config,
    )  # fmt: skip
    finder = intersection_finder(
        clk=clk, steps=steps, rect=rect, offered=offered, ray=ray, slope=slope, hit=hit, depth=depth, point=point,
        odd_u=odd_u, odd_v=odd_v, towards=towards, config=config,
    )  # fmt: skip
    z_buf = z_buffer(
        clk=clk, steps=steps, offered=offered, colour=colour, hit=hit, depth=depth, point=point, found=found,
        found_axis=found_axis, found_colour=found_colour, found_mirror=found_mirror, found_point=found_point,
        config=config,
    )  # fmt: skip
    memory = ray_mem(clk=clk, steps=steps, found_axis=found_axis, found_point=found_point, ray=ray, reflected=reflected)
    combiner = colour_combiner(
        clk=clk, steps=steps, found=found, found_colour=found_colour, found_mirror=found_mirror, picture=picture,
        missed=missed, pixel=pixel, config=config,
    )  # fmt: skip

    if config.patterns:
        painter = pattern_colour(look=offered, odd_u=odd_u, odd_v=odd_v, colour=colour)

    @always_comb
    def align_camera():
        start_x.next = camera.x << fraction_bits
        start_y.next = camera.y << fraction_bits
        start_z.next = camera.z << fraction_bits

    primary = ray.joined(x=start_x, y=start_y, z=start_z, dx=initial_signs.dx, dy=initial_signs.dy, dz=initial_signs.dz)
    choose_ray = assign(ray.word, lambda: primary if steps.initial_ray else reflected.word)

    # Hits after a ray has ended do not count.
    if config.materials:
        judge_alive = assign(fate.alive, lambda: found and (found_mirror != 0) and not missed)

    elif config.culling:
        judge_alive = assign(fate.alive, lambda: found and not missed)

    if ends_early(config):
        judge_towards = assign(fate.towards, lambda: towards and not missed)

    return instances()
