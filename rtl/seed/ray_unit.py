# SPDX-License-Identifier: MIT
"""One of the parallel units: a ray, its nearest hit, its reflections, and the colour of its pixel."""

from myhdl import always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Origin, Signs, Slope
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import AXIS_BITS, RGB_BITS, bit, position_bits, unsigned
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.engine.ray_sequencer import impatient
from raycaster.rtl.seed.intersection_finder import intersection_finder
from raycaster.rtl.seed.ray_mem import ray_mem
from raycaster.rtl.seed.z_buffer import z_buffer


@block
def ray_unit(
    clk,
    steps,
    row,
    column_base,
    column_offset,
    camera,
    current_plane,
    finishing_rect,
    background,
    reflections,
    pixel,
    outlook,
    config: Configuration,
):
    """Trace the pixel at (row, column_offset * units + column_base) as the steps say; pixel stands after the last.

    It holds no control of its own: one ray_control operates all units in step. camera: whole world units. outlook: with
    config.culling.
    """
    fraction_bits = config.fraction_bits
    position_width = position_bits(config)

    initial_signs, reflected_signs, signs = Signs(), Signs(), Signs()
    slope = Slope()
    reflected_origin, origin, point, found_point = (Origin(config) for _ in range(4))
    hit, found = bit(), bit()
    ahead = bit() if impatient(config) else unconnected(1)
    missed = bit() if config.culling else unconnected(1)
    depth = unsigned(position_width)
    found_axis = unsigned(AXIS_BITS)
    found_colour = unsigned(RGB_BITS)

    generator = ray_generator(clk, steps, row, column_base, column_offset, initial_signs, slope, config)
    finder = intersection_finder(
        clk, steps, current_plane, finishing_rect, origin, signs, slope, hit, depth, point, ahead, config
    )
    z_buf = z_buffer(
        clk, steps, finishing_rect, hit, depth, point, found, found_axis, found_colour, found_point, config
    )
    memory = ray_mem(clk, steps, found_axis, found_point, signs, reflected_origin, reflected_signs)
    combiner = colour_combiner(clk, steps, found, found_colour, background, reflections, missed, pixel, config)

    # The camera's ray first, then what the mirrors make of it.
    @always_comb
    def choose_ray():
        if steps.initial_ray:
            origin.x.next = 0
            origin.y.next = 0
            origin.z.next = 0
            origin.x.next[position_width:fraction_bits] = camera.x
            origin.y.next[position_width:fraction_bits] = camera.y
            origin.z.next[position_width:fraction_bits] = camera.z
            signs.dx.next = initial_signs.dx
            signs.dy.next = initial_signs.dy
            signs.dz.next = initial_signs.dz
        else:
            origin.x.next = reflected_origin.x
            origin.y.next = reflected_origin.y
            origin.z.next = reflected_origin.z
            signs.dx.next = reflected_signs.dx
            signs.dy.next = reflected_signs.dy
            signs.dz.next = reflected_signs.dz

    common = generator, finder, z_buf, memory, combiner, choose_ray
    if not config.culling:
        return common

    # What is lost hits nothing any more.
    @always_comb
    def judge():
        outlook.alive.next = found and not missed

    if not impatient(config):
        return common, judge

    # Nor does it run towards anything.
    @always_comb
    def look_ahead():
        outlook.ahead.next = ahead and not missed

    return common, judge, look_ahead
