# SPDX-License-Identifier: MIT
"""The timing of the monitor, which drives the whole design."""

from myhdl import Signal, always_comb, always_seq, block, intbv

from raycaster.rtl.common.widths import bit, bits_for, unsigned
from raycaster.screens import Screen


@block
def video_generator(
    clk,
    reset,
    start_screen,
    start_row,
    visible_line,
    next_column,
    red,
    green,
    blue,
    vga_r,
    vga_g,
    vga_b,
    vga_hs,
    vga_vs,
    vga_blank_n,
    vga_sync_n,
    vga_clk,
    screen: Screen,
    lead: int = 0,
):
    """Free-running sync, whatever the inputs; a pixel takes two clocks, and reaches the outputs a pixel after its turn.

    Screen coordinates are signed: negative in the blanking, which comes first, so that visible means >= 0. Lines and
    frames are front porch, sync, back porch, picture. VS changes together with HS. Reset restarts at the first pixel
    of the first line of the vertical front porch.

    start_screen: strobe, two VGA lines (one row of rays) before the first visible line, time to render row 0.
    start_row: strobe at the beginning of the first line of each row, which is then handed over.
    visible_line: high in the visible part of a line, blanked ones included; next_column: strobe in the last clock of
    each column there. red, green, blue: the column's colour, sampled at the end of each of its pixels.
    Outputs change at the falling edge of vga_clk.
    """
    horizontal, vertical, doubling = screen.horizontal, screen.vertical, screen.doubling
    first_pixel, first_line = -horizontal.blank, -vertical.blank
    last_pixel, last_line = horizontal.visible - 1, vertical.visible - 1
    hsync_first = first_pixel + horizontal.front
    hsync_last = hsync_first + horizontal.sync - 1
    vsync_first = first_line + vertical.front
    vsync_last = vsync_first + vertical.sync - 1
    hsync_active, vsync_active = horizontal.active_high, vertical.active_high
    last_repeat = doubling - 1

    x = Signal(intbv(first_pixel, min=first_pixel, max=horizontal.visible))
    y = Signal(intbv(first_line, min=first_line, max=vertical.visible))
    hs, vs = Signal(bool(not hsync_active)), Signal(bool(not vsync_active))
    pixel_end = Signal(bool(screen.clocks_per_pixel == 1))
    line_end, line_start = bit(), bit()
    pixel_repeat, line_repeat = unsigned(bits_for(doubling)), unsigned(bits_for(doubling))

    # With a clock a pixel vga_clk is clk inverted.
    if screen.clocks_per_pixel == 1:
        # Each clock is a pixel's first and last.
        @always_seq(clk.posedge, reset=reset)
        def divide_clock():
            pixel_end.next = True

        # The monitor's clock: low in a pixel's first half.
        @always_comb
        def drive_clock():
            vga_clk.next = not clk
            vga_sync_n.next = False

        # The line's last clock and first.
        @always_comb
        def find_line_ends():
            line_end.next = pixel_end and (x == last_pixel)
            line_start.next = pixel_end and (x == first_pixel)

    else:
        # Two clocks a pixel; the second half is the high one.
        @always_seq(clk.posedge, reset=reset)
        def divide_clock():
            pixel_end.next = not pixel_end

        # The monitor's clock: low in a pixel's first half.
        @always_comb
        def drive_clock():
            vga_clk.next = pixel_end
            vga_sync_n.next = False

        # The line's last clock and first.
        @always_comb
        def find_line_ends():
            line_end.next = pixel_end and (x == last_pixel)
            line_start.next = (not pixel_end) and (x == first_pixel)

    # The position on the screen.
    @always_seq(clk.posedge, reset=reset)
    def scan():
        if pixel_end:
            if x == last_pixel:
                x.next = first_pixel
                if y == last_line:
                    y.next = first_line
                else:
                    y.next = y + 1
            else:
                x.next = x + 1

    # With a clock a pixel columns are announced lead pixels early, at most the horizontal blanking.
    if screen.clocks_per_pixel == 1:
        first_ahead, end_ahead = -lead, horizontal.visible - lead
        in_columns = bit()

        # Where the columns are announced.
        @always_comb
        def look_ahead():
            in_columns.next = (x >= first_ahead) and (x < end_ahead)

        # Which of a row's lines, and of the announced column's pixels, this is.
        @always_seq(clk.posedge, reset=reset)
        def count_repeats():
            if line_end:
                if y < 0 or line_repeat == last_repeat:
                    line_repeat.next = 0
                else:
                    line_repeat.next = line_repeat + 1
            if (not in_columns) or pixel_repeat == last_repeat:
                pixel_repeat.next = 0
            else:
                pixel_repeat.next = pixel_repeat + 1

        # Tell the renderer where the monitor is, and will be.
        @always_comb
        def announce():
            start_screen.next = line_start and (y == -doubling)
            start_row.next = line_start and (y >= 0) and (line_repeat == 0)
            visible_line.next = in_columns
            next_column.next = in_columns and (pixel_repeat == last_repeat)

        follow = look_ahead, count_repeats, announce

    else:
        # Which of a row's lines, and of a column's pixels, this is.
        @always_seq(clk.posedge, reset=reset)
        def count_repeats():
            if line_end:
                if y < 0 or line_repeat == last_repeat:
                    line_repeat.next = 0
                else:
                    line_repeat.next = line_repeat + 1
            if pixel_end:
                if x < 0 or pixel_repeat == last_repeat:
                    pixel_repeat.next = 0
                else:
                    pixel_repeat.next = pixel_repeat + 1

        # Tell the renderer where the monitor is.
        @always_comb
        def announce():
            start_screen.next = line_start and (y == -doubling)
            start_row.next = line_start and (y >= 0) and (line_repeat == 0)
            visible_line.next = x >= 0
            next_column.next = pixel_end and (x >= 0) and (pixel_repeat == last_repeat)

        follow = count_repeats, announce

    # Sync and blanking for the pixel that now ends.
    @always_seq(clk.posedge, reset=reset)
    def synchronise():
        if pixel_end:
            if (x >= hsync_first) and (x <= hsync_last):
                hs.next = hsync_active
            else:
                hs.next = not hsync_active
            if x == hsync_first:
                if (y >= vsync_first) and (y <= vsync_last):
                    vs.next = vsync_active
                else:
                    vs.next = not vsync_active
            vga_blank_n.next = (x >= 0) and (y >= 0)

    # Sync idles at its inactive level in reset, whatever level the ports start from.
    @always_comb
    def drive_sync():
        vga_hs.next = hs
        vga_vs.next = vs

    # Its colour: black where the monitor measures its black level.
    @always_seq(clk.posedge, reset=reset)
    def colour():
        if pixel_end:
            if (x >= 0) and (y >= 0):
                vga_r.next = red
                vga_g.next = green
                vga_b.next = blue
            else:
                vga_r.next = 0
                vga_g.next = 0
                vga_b.next = 0

    return divide_clock, drive_clock, find_line_ends, scan, follow, synchronise, drive_sync, colour
