# SPDX-License-Identifier: MIT
"""The timing of the monitor, which drives the whole design."""

from myhdl import Signal, always_comb, always_seq, block, instances, intbv

from raycaster.hdl.signals import bit, bits_for, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.video.pixel_clock import pixel_clock
from raycaster.screens import Screen


@block
def video_generator(clk, reset, scan, pixel, vga, screen: Screen, lead: int = 0):
    """Generate the free-running timing of the monitor, and send it the pixels.

    A pixel takes `screen.clocks_per_pixel` clk cycle(s), and reaches the outputs one pixel after its coordinates. With
    two pixels per clock, pixel and column mean both of them here.

    Screen coordinates are signed: negative in blanking, which comes first, so that visible means >= 0. Lines and frames
    consist of front porch, sync, back porch and picture. VS changes together with HS.

    Args:
        reset: synchronous, active high; restarts at the first pixel of the first line of the vertical front porch.
        scan: `Scan`; output. start_screen: strobe one row of rays (`screen.doubling` lines) before the first visible
            line, in time to render row 0. start_row: strobe at the beginning of the first line of each row, when that
            row is handed over. visible_line: high in the visible part of a line, blanked lines included. next_column:
            strobe in the last clock of each column's last pixel there.
        pixel: `Pixel`; the column's colour, sampled at the end of each of its pixels.
        vga: `Vga`; output. Changes at the falling edge of vga.clk.
        screen: the screen and its timing.
        lead: number of pixels by which visible_line and next_column are early, if a pixel takes one clock; at most the
            horizontal blanking.
    """
    horizontal, vertical, doubling = screen.beats, screen.vertical, screen.doubling
    first_pixel, first_line = -horizontal.blank, -vertical.blank
    last_pixel, last_line = horizontal.visible - 1, vertical.visible - 1
    hsync_first = first_pixel + horizontal.front
    hsync_last = hsync_first + horizontal.sync - 1
    vsync_first = first_line + vertical.front
    vsync_last = vsync_first + vertical.sync - 1
    hsync_active, vsync_active = horizontal.active_high, vertical.active_high
    last_repeat = doubling - 1
    screen_first = first_line == -doubling
    line_before_screen = last_line if screen_first else -doubling - 1
    single = screen.clocks_per_pixel == 1
    first_ahead, end_ahead = (-lead, horizontal.visible - lead) if single else (0, horizontal.visible)
    one_clock, to_line_end = tied(single, 1), tied(end_ahead == horizontal.visible, 1)

    x = Signal(intbv(first_pixel, min=first_pixel, max=horizontal.visible))
    y = Signal(intbv(first_line, min=first_line, max=vertical.visible))
    hs, vs = Signal(bool(not hsync_active)), Signal(bool(not vsync_active))
    pixel_end = Signal(bool(single))
    pixel_start, line_end, line_start, in_columns = (bit() for _ in range(4))
    pixel_repeat, line_repeat = unsigned(bits_for(doubling)), unsigned(bits_for(doubling))

    if single:
        monitor_clock = pixel_clock(clk, vga.clk)

    else:
        drive_clock = assign(vga.clk, lambda: pixel_end)

    @always_seq(clk.posedge, reset=reset)
    def divide_clock():
        pixel_end.next = pixel_start

    @always_comb
    def find_edges():
        pixel_start.next = one_clock or not pixel_end
        line_start.next = pixel_start and (x == first_pixel)
        line_end.next = pixel_end and (x == last_pixel)
        in_columns.next = (x >= first_ahead) and (to_line_end or x < end_ahead)

    @always_seq(clk.posedge, reset=reset)
    def step():
        if pixel_end:
            if x == last_pixel:
                x.next = first_pixel
                if y == last_line:
                    y.next = first_line
                else:
                    y.next = y + 1
            else:
                x.next = x + 1

    # The number of the line within its row, and of the pixel within the announced column.
    @always_seq(clk.posedge, reset=reset)
    def count_repeats():
        if line_end:
            if y < 0 or line_repeat == last_repeat:
                line_repeat.next = 0
            else:
                line_repeat.next = line_repeat + 1
        if pixel_end:
            if (not in_columns) or pixel_repeat == last_repeat:
                pixel_repeat.next = 0
            else:
                pixel_repeat.next = pixel_repeat + 1

    @always_comb
    def announce():
        scan.start_row.next = line_start and (y >= 0) and (line_repeat == 0)
        scan.visible_line.next = in_columns
        scan.next_column.next = pixel_end and in_columns and (pixel_repeat == last_repeat)

    # A register, since the whole scene changes with it.
    announce_screen = register(
        clk, scan.start_screen, lambda: screen_first if reset else line_end and (y == line_before_screen)
    )

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
            vga.blank_n.next = (x >= 0) and (y >= 0)

    # In reset sync is at its inactive level, whatever level the ports start from.
    drive_sync = assign((vga.hs, vga.vs, vga.sync_n), lambda: (hs, vs, False))

    # Black in blanking, when the monitor measures its black level.
    @always_seq(clk.posedge, reset=reset)
    def colour():
        if pixel_end:
            if (x >= 0) and (y >= 0):
                vga.r.next, vga.g.next, vga.b.next = pixel.red, pixel.green, pixel.blue
            else:
                vga.r.next = vga.g.next = vga.b.next = 0

    return instances()
