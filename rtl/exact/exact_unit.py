# SPDX-License-Identifier: MIT
"""One of the exact engine's units: a ray, its nearest hit, its reflections, and the colour of its pixel."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.interfaces import Eye, Slope
from raycaster.rtl.common.records import Mirror, Signs, Surface
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import bit, exact_slope_bits, eye_bits, unsigned
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.exact.eye_register import eye_register
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.rect_tester import rect_tester


@block
def exact_unit(clk, steps, place, column_base, camera, rect, offered, picture, pixel, fate, config: Configuration):
    """Trace the pixel at (place.row, place.column_offset * units + column_base) as the steps say.

    It holds no control of its own: one exact_control operates all units in step. camera: a `Point`; rect: the rectangle
    at hand, a new one each clock; offered: the `Surface` of the one whose verdict is due; pixel: valid after the last
    step; fate: with config.culling.
    """
    initial_signs, signs = Signs(), Signs()
    slope, eye = Slope(exact_slope_bits(config)), Eye(eye_bits(config))
    mirror, found_surface = Mirror(), Surface()
    hit, found = bit(), bit()
    missed = bit() if config.culling else unconnected(1)
    numerator, denominator = unsigned(eye_bits(config) - 1), unsigned(exact_slope_bits(config))

    generator = ray_generator(
        clk=clk, steps=steps, place=place, column_base=column_base, initial_signs=initial_signs, slope=slope,
        config=config,
    )  # fmt: skip
    memory = eye_register(
        clk=clk, steps=steps, camera=camera, initial_signs=initial_signs, found_surface=found_surface, eye=eye,
        signs=signs, mirror=mirror,
    )  # fmt: skip
    tester = rect_tester(
        clk=clk, steps=steps, rect=rect, eye=eye, signs=signs, slope=slope, mirror=mirror, hit=hit, numerator=numerator,
        denominator=denominator,
    )  # fmt: skip
    nearest = nearest_hit(
        clk=clk, steps=steps, offered=offered, hit=hit, numerator=numerator, denominator=denominator, found=found,
        found_surface=found_surface,
    )  # fmt: skip
    combiner = colour_combiner(
        clk=clk, steps=steps, found=found, found_colour=found_surface.colour, picture=picture, missed=missed,
        pixel=pixel, config=config,
    )  # fmt: skip

    if config.culling:
        # After a miss the unit goes on with a ray that is none: it hits nothing.
        @always_comb
        def judge_alive():
            fate.alive.next = found and not missed

    return instances()
