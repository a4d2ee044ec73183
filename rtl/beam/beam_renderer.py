# SPDX-License-Identifier: MIT
"""Pixel after pixel, just as the monitor takes them: no line buffer."""

from myhdl import always_comb, always_seq, block

from raycaster.configuration import Configuration
from raycaster.rtl.beam.beam_caster import beam_caster, beam_latency
from raycaster.rtl.common.widths import CYCLE_BITS, bit, bits_for, exact_slope_bits, row_bits, signed, unsigned
from raycaster.rtl.video.video_generator import video_generator


@block
def beam_renderer(
    clk,
    reset,
    run,
    reflections,
    background,
    camera,
    rects,
    start_screen,
    busy,
    underrun,
    row_cycles,
    group_cycles,
    vga_r,
    vga_g,
    vga_b,
    vga_hs,
    vga_vs,
    vga_blank_n,
    vga_sync_n,
    vga_clk,
    config: Configuration,
):
    """Show the live scene; the ports are ray_caster_renderer's, and clk is the monitor's.

    Every line is computed while it is shown, again for each line of a doubled row, so nothing can be late: underrun
    stays low. The video generator announces each column beam_latency cycles before its pixel is due. row_cycles: cycles
    since the line's first column, with the present one; group_cycles: a pixel's; they mean something while busy.
    """
    rows = config.screen_geometry.rows
    horizon_row = config.screen_geometry.horizon_row
    hs_active = config.screen_geometry.horizontal.active_high
    last_repeat = config.screen_geometry.doubling - 1
    cycles_limit = (1 << CYCLE_BITS) - 1

    start_row, start_line, visible_line, next_column = bit(), bit(), bit(), bit()
    hs, hs_before = bit(), bit()
    first_row, first_line, in_picture = bit(), bit(), bit()
    row = unsigned(row_bits(config))
    lines_left = unsigned(bits_for(last_repeat + 1))
    row_slope = signed(exact_slope_bits(config) + 1)
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))
    shown_red, shown_green, shown_blue = (unsigned(config.colour_bits) for _ in range(3))
    drawing = bit()

    video = video_generator(
        clk, reset, start_screen, start_row, visible_line, next_column, shown_red, shown_green, shown_blue,
        vga_r, vga_g, vga_b, hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk, config.screen_geometry,
        beam_latency(config),
    )  # fmt: skip
    caster = beam_caster(
        clk, reset, start_line, next_column, row_slope, camera, background, reflections, rects, red, green, blue, config
    )

    # The row that is shown, from the first one after StartScreen.
    @always_seq(clk.posedge, reset=reset)
    def count_rows():
        if start_screen:
            first_row.next = True
        elif start_row:
            first_row.next = False
            if first_row:
                row.next = 0
            elif row != rows:
                row.next = row + 1

    # Its slope, long before the row's products are formed.
    @always_seq(clk.posedge, reset=reset)
    def aim():
        row_slope.next = horizon_row - row

    # The port cannot be read back.
    @always_comb
    def drive_sync():
        vga_hs.next = hs

    # Each line is set up from its horizontal sync on, which comes after the row has been counted.
    @always_seq(clk.posedge, reset=reset)
    def remember_sync():
        hs_before.next = hs

    # The sync's leading edge.
    @always_comb
    def find_line():
        start_line.next = (hs == hs_active) and (hs_before != hs_active)

    # The lines that show rows.
    @always_seq(clk.posedge, reset=reset)
    def count_lines():
        if start_row:
            first_line.next = True
        elif start_line:
            first_line.next = False
            if first_line:
                in_picture.next = True
                lines_left.next = last_repeat
            elif lines_left == 0:
                in_picture.next = False
            else:
                lines_left.next = lines_left - 1

    # A pixel is being computed.
    @always_comb
    def draw():
        drawing.next = run and in_picture and visible_line

    # What software sees of it; it is never late.
    @always_comb
    def tell_busy():
        busy.next = drawing
        underrun.next = False

    # How long this line has taken, the present cycle included; it saturates.
    @always_seq(clk.posedge, reset=reset)
    def measure():
        group_cycles.next = 1
        if start_line:
            row_cycles.next = 1
        elif drawing and (row_cycles != cycles_limit):
            row_cycles.next = row_cycles + 1

    # Black without a scene.
    @always_comb
    def split_channels():
        shown_red.next = 0
        shown_green.next = 0
        shown_blue.next = 0
        if run:
            shown_red.next = red
            shown_green.next = green
            shown_blue.next = blue

    return (
        video, caster, count_rows, aim, drive_sync, remember_sync, find_line, count_lines, draw, tell_busy, measure,
        split_channels,
    )  # fmt: skip
