# SPDX-License-Identifier: MIT
"""The ray casting engine: one control, many units."""

from myhdl import always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Outlook, Plane, Rect, Steps
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import pixel_bits, side_by_side, unit_bits, unsigned
from raycaster.rtl.cull.group_culler import group_culler, prospects_of
from raycaster.rtl.engine.ray_sequencer import impatient
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.rtl.seed.ray_unit import ray_unit


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
    colours,
    config: Configuration,
):
    """Compute the colours of config.units neighbouring pixels at once.

    Starts where enable is high and reset_ray_caster low; row, column_offset and the scene then hold still until done,
    which stays high, as colours does, until reset_ray_caster. colours: unit 0's pixel in the lowest bits.
    """
    steps = Steps()
    finishing_rect = Rect()
    current_plane = Plane()
    current_plane.axis = rects.rect.axis
    current_plane.position = rects.rect.position
    bases = [tied(unit, unit_bits(config)) for unit in range(config.units)]
    pixels = [unsigned(pixel_bits(config)) for _ in range(config.units)]
    together = side_by_side(pixels)

    outlooks = [Outlook() for _ in range(config.units)]
    prospects = prospects_of(config)

    control = ray_control(
        clk, reset_ray_caster, enable, reflections, rects, steps, prospects, finishing_rect, done, config
    )
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
            outlooks[unit],
            config,
        )
        for unit in range(config.units)
    ]

    # All pixels leave side by side.
    @always_comb
    def join():
        colours.next = together

    common = control, units, join
    if not config.culling:
        return common

    alives = side_by_side([outlook.alive for outlook in outlooks])
    culler = group_culler(
        clk, reset_ray_caster, steps.screen_to_ray, done, row, column_offset, camera, rects, prospects.possible, config
    )

    # One unit is enough.
    @always_comb
    def judge():
        prospects.alive.next = alives != 0

    if not impatient(config):
        return common, culler, judge

    aheads = side_by_side([outlook.ahead for outlook in outlooks])

    # And here.
    @always_comb
    def look_ahead():
        prospects.ahead.next = aheads != 0

    return common, culler, judge, look_ahead
