# SPDX-License-Identifier: MIT
"""An encoder from the VGA output to the symbols of a DVI link."""

from myhdl import block, concat, instances

from raycaster.hdl.signals import bit, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.dvi.tmds_encoder import tmds_encoder


@block
def dvi_encoder(clk, pixel_end, vga, blue, green, red, pixel):
    """Encode a VGA output for a DVI link.

    Channel 0 carries blue and the syncs, 1 green, 2 red, as in DVI 1.0, section 2.2.3.

    A pixel's colours and syncs are read at its pixel_end. Their symbols appear in the cycle after the next pixel_end,
    and stay for one pixel.

    Args:
        pixel_end: flag; high in the last cycle of a pixel, which takes one or two cycles of clk.
        vga: `Vga` of ray_caster_module, 8 bits per colour; r, g, b, hs, vs and blank_n are read.
        blue: unsigned output, 10 bits; the symbol of channel 0, stable for a pixel.
        green: unsigned output, 10 bits; the symbol of channel 1, stable for a pixel.
        red: unsigned output, 10 bits; the symbol of channel 2, stable for a pixel.
        pixel: output flag; changes with the symbols, once per pixel.
    """
    syncs, none = unsigned(2), tied(0, 2)
    marked = bit()

    blue_channel = tmds_encoder(clk, pixel_end, data=vga.b, control=syncs, visible=vga.blank_n, symbol=blue)
    green_channel = tmds_encoder(clk, pixel_end, data=vga.g, control=none, visible=vga.blank_n, symbol=green)
    red_channel = tmds_encoder(clk, pixel_end, data=vga.r, control=none, visible=vga.blank_n, symbol=red)

    mark = register(clk, marked, lambda: not marked, pixel_end)
    join = assign((syncs, pixel), lambda: (concat(vga.vs, vga.hs), marked))

    return instances()
