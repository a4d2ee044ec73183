# SPDX-License-Identifier: MIT
"""From the VGA output to the symbols of a DVI link."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.dvi.tmds_encoder import tmds_encoder


@block
def dvi_encoder(clk, ready, pixel_end, vga, blue, green, red, pixel):
    """Channel 0 carries blue and the syncs, 1 green, 2 red, as DVI 1.0 has it, section 2.2.3.

    vga: as ray_caster_module has it, 8 bits a colour, one or two cycles of clk a pixel; pixel_end: high in the last of
    them; blue, green, red: symbols, 10 bits, each stable for a pixel, from the second end of a pixel after their own
    on; pixel: changes with them, and is low while ready is, which may change at any time.
    """
    syncs, none = unsigned(2), tied(0, 2)
    marked = bit()

    blue_channel = tmds_encoder(clk, pixel_end, data=vga.b, control=syncs, visible=vga.blank_n, symbol=blue)
    green_channel = tmds_encoder(clk, pixel_end, data=vga.g, control=none, visible=vga.blank_n, symbol=green)
    red_channel = tmds_encoder(clk, pixel_end, data=vga.r, control=none, visible=vga.blank_n, symbol=red)

    @always(clk.posedge)
    def mark():
        if not ready:
            marked.next = False
        elif pixel_end:
            marked.next = not marked

    @always_comb
    def join():
        syncs.next = concat(vga.vs, vga.hs)
        pixel.next = marked

    return instances()
