# SPDX-License-Identifier: MIT
"""The start of a line, for a camera that turns: its first ray, and then the change per column."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.beam.latencies import AIM_LATENCY
from raycaster.rtl.common.widths import BASIS_BITS, exact_slope_bits, factor_bits


@block
def line_starter(clk, reset, start_line, camera, row_slope, loaded, aim, start_sweep, enter, config: Configuration):
    """Run rect_setup through the rectangles twice: with the first ray's slope, and with its change per column.

    With two pixels per clock there are three sweeps: with the first ray's slope, the second ray's slope, and the change
    per two columns.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        start_line: strobe; begins a line.
        camera: `Camera` of the live scene, with its basis.
        row_slope: signed, `factor_bits` bits; rows above the horizon. Constant from the third cycle after start_line
            on.
        loaded: strobe; rect_setup's last load of a sweep.
        aim: `Vector`; output, D = view distance * forward - centre column * right + row_slope * up of the line's
            first ray and, from the second cycle after enter, right. With two pixels per clock, aim advances with each
            bit of enter: to D of the second ray, and then to twice right.
        start_sweep: strobe; output, rect_setup starts.
        enter: `config.pixels` bits, output; bit i is high with loaded of sweep i, so that in the next cycle everything
            that walks along the row in lane i takes its start.
        config: the design.
    """
    slope_bits = exact_slope_bits(config) + 1
    view_distance, first_column = config.screen_geometry.view_distance, -config.screen_geometry.centre_column

    last, pixels = config.pixels - 1, config.pixels
    ages = unsigned(AIM_LATENCY - 1)
    sweeps, entered, later = unsigned(pixels), unsigned(pixels), unsigned(pixels + 1)
    factor = signed(factor_bits(config))
    x, y, z = (signed(BASIS_BITS) for _ in range(3))
    x_product, y_product, z_product = (signed(slope_bits) for _ in range(3))

    @always_comb
    def shift():
        later.next = sweeps << 1

    # ages, bit i: the line started i + 1 cycles ago; sweeps, bit i: sweep i, which enters lane i, is next or in
    # progress.
    @always(clk.posedge)
    def follow():
        ages.next = concat(ages[AIM_LATENCY - 2 :], start_line)
        entered.next = enter
        if reset:
            ages.next = 0
            sweeps.next = 0
        elif start_line:
            sweeps.next = 1
        elif loaded:
            sweeps.next = later[pixels:]

    @always_comb
    def sweep():
        enter.next = 0
        if loaded:
            enter.next = sweeps
        start_sweep.next = ages[AIM_LATENCY - 4] or (loaded and sweeps != 0)

    @always_comb
    def choose():
        if ages[0]:
            factor.next = view_distance
            x.next = camera.forward_x
            y.next = camera.forward_y
            z.next = camera.forward_z
        elif ages[1]:
            factor.next = first_column
            x.next = camera.right_x
            y.next = camera.right_y
            z.next = camera.right_z
        else:
            factor.next = row_slope
            x.next = camera.up_x
            y.next = camera.up_y
            z.next = camera.up_z

    @always(clk.posedge)
    def multiply():
        x_product.next = factor * x
        y_product.next = factor * y
        z_product.next = factor * z

    # aim advances by one column before each further lane's sweep, and in the end it is the change per step of all
    # lanes.
    @always(clk.posedge)
    def accumulate():
        if ages[0]:
            aim.x.next = 0
            aim.y.next = 0
            aim.z.next = 0
        elif ages[AIM_LATENCY - 1 : 1] != 0:
            aim.x.next = aim.x + x_product
            aim.y.next = aim.y + y_product
            aim.z.next = aim.z + z_product
        elif entered[last]:
            aim.x.next = camera.right_x << last
            aim.y.next = camera.right_y << last
            aim.z.next = camera.right_z << last
        elif entered != 0:
            aim.x.next = aim.x + camera.right_x
            aim.y.next = aim.y + camera.right_y
            aim.z.next = aim.z + camera.right_z

    return instances()
