# SPDX-License-Identifier: MIT
"""The ray casting engine: one control, many units."""

from myhdl import ConcatSignal, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.hierarchy import constant
from raycaster.rtl.interfaces import Plane, Rect, Steps
from raycaster.rtl.ray_control import ray_control
from raycaster.rtl.ray_unit import ray_unit
from raycaster.rtl.widths import pixel_bits, unit_bits, unsigned


@block
def ray_caster(
    clk,
    reset_ray_caster,
    enable,
    row,
    column_offset,
    camera,
    background,
    reflections,
    rects,
    done,
    colors,
    config: Configuration,
):
    """Compute the colours of config.units neighbouring pixels at once.

    Starts where enable is high and reset_ray_caster low; row, column_offset and the scene then hold still until done,
    which stays high, as colors does, until reset_ray_caster. colors: unit 0's pixel in the lowest bits.
    """
    steps = Steps()
    finishing_rect = Rect()
    current_plane = Plane()
    current_plane.axis = rects.rect.axis
    current_plane.position = rects.rect.position
    bases = [constant(unit, unit_bits(config)) for unit in range(config.units)]
    pixels = [unsigned(pixel_bits(config)) for _ in range(config.units)]
    together = ConcatSignal(*reversed(pixels)) if config.units > 1 else pixels[0]

    control = ray_control(clk, reset_ray_caster, enable, reflections, rects, steps, finishing_rect, done, config)
    units = [
        ray_unit(
            clk,
            steps,
            row,
            bases[unit],
            column_offset,
            camera,
            current_plane,
            finishing_rect,
            background,
            reflections,
            pixels[unit],
            config,
        )
        for unit in range(config.units)
    ]

    # All pixels leave side by side.
    @always_comb
    def join():
        colors.next = together

    return control, units, join
