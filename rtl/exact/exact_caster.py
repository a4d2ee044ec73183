# SPDX-License-Identifier: MIT
"""The exact engine: one control, a few units, and never a wrong pixel."""

from myhdl import always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Outlook, RaySteps, Surface
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import pixel_bits, side_by_side, unit_bits, unsigned
from raycaster.rtl.cull.group_culler import group_culler, prospects_of
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.exact.exact_unit import exact_unit


@block
def exact_caster(
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
    """Compute the colours of config.units neighbouring pixels at once; the ports are ray_caster's."""
    steps = RaySteps()
    offered = Surface()
    bases = [tied(unit, unit_bits(config)) for unit in range(config.units)]
    pixels = [unsigned(pixel_bits(config)) for _ in range(config.units)]
    together = side_by_side(pixels)

    outlooks = [Outlook() for _ in range(config.units)]
    prospects = prospects_of(config)

    control = exact_control(clk, reset_ray_caster, enable, reflections, rects, steps, prospects, offered, done, config)
    units = [
        exact_unit(
            clk, steps, row, bases[unit], column_offset, camera, rects.rect, offered, background, reflections,
            pixels[unit], outlooks[unit], config,
        )
        for unit in range(config.units)
    ]  # fmt: skip

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

    return common, culler, judge
