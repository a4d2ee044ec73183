# SPDX-License-Identifier: MIT
"""One of the exact engine's parallel units: a ray, its nearest hit, its reflections, and the colour of its pixel."""

from myhdl import always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Eye, Mirror, Signs, Slope, Surface
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import bit, exact_slope_bits, eye_bits, unsigned
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.exact.eye_register import eye_register
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.rect_tester import rect_tester


@block
def exact_unit(
    clk,
    steps,
    row,
    column_base,
    column_offset,
    camera,
    rect,
    offered,
    background,
    reflections,
    pixel,
    outlook,
    config: Configuration,
):
    """Trace the pixel at (row, column_offset * units + column_base) as the steps say; pixel stands after the last.

    It holds no control of its own: one exact_control operates all units in step. rect: the rectangle at hand, a new one
    each clock; offered: the one whose verdict is due. camera: whole world units. outlook: with config.culling.
    """
    initial_signs, signs = Signs(), Signs()
    slope = Slope(exact_slope_bits(config))
    eye = Eye(eye_bits(config))
    mirror = Mirror()
    found_surface = Surface()
    hit, found = bit(), bit()
    missed = bit() if config.culling else unconnected(1)
    numerator = unsigned(eye_bits(config) - 1)
    denominator = unsigned(exact_slope_bits(config))

    generator = ray_generator(clk, steps, row, column_base, column_offset, initial_signs, slope, config)
    memory = eye_register(clk, steps, camera, initial_signs, found_surface, eye, signs, mirror)
    tester = rect_tester(clk, steps, rect, eye, signs, slope, mirror, hit, numerator, denominator)
    nearest = nearest_hit(clk, steps, offered, hit, numerator, denominator, found, found_surface)
    combiner = colour_combiner(clk, steps, found, found_surface.colour, background, reflections, missed, pixel, config)

    common = generator, memory, tester, nearest, combiner
    if not config.culling:
        return common

    # What is lost hits nothing any more.
    @always_comb
    def judge():
        outlook.alive.next = found and not missed

    return common, judge
