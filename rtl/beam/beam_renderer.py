# SPDX-License-Identifier: MIT
"""The renderer without a line buffer, which computes each pixel just in time for the monitor."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, signed, unsigned
from raycaster.rtl.beam.beam_caster import beam_caster
from raycaster.rtl.beam.latencies import beam_latency
from raycaster.rtl.common.interfaces import Scan
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.common.widths import CYCLE_BITS, factor_bits, row_bits
from raycaster.rtl.video.video_generator import video_generator


@block
def beam_renderer(clk, reset, picture, camera, rects, progress, vga, config: Configuration):
    """Show the live scene, and compute each pixel just in time for the monitor.

    Every line is computed while it is shown, again for each line of a doubled row, so nothing can be late: underrun
    stays low. The video generator announces each column `beam_latency` cycles before its pixel is due.

    Args:
        clk: the monitor's clock.
        reset: synchronous, active high.
        picture: `Picture` of the live scene.
        camera: `Camera` of the live scene.
        rects: `Rects`; drives index and fetch, reads usable and rect.
        progress: `Progress`; output. row_cycles: cycles since the line's first column, including the present one; it
            saturates. group_cycles: cycles of a pixel or a pair of pixels, which is 1. underrun: low.
        vga: `Vga`; output.
        config: the design.
    """
    screen = config.screen_geometry
    rows, horizon_row, hs_active = screen.rows, screen.horizon_row, screen.horizontal.active_high
    last_repeat = screen.doubling - 1
    cycles_limit = (1 << CYCLE_BITS) - 1

    scan, pixel, shown = Scan(start_screen=progress.start_screen), Pixel(config.port_bits), Pixel(config.port_bits)
    start_line, hs_before = bit(), bit()
    first_row, first_line, in_picture, drawing = bit(), bit(), bit(), bit()
    row = unsigned(row_bits(config))
    lines_left = unsigned(bits_for(last_repeat + 1))
    row_slope = signed(factor_bits(config))

    video = video_generator(
        clk, reset, scan, shown, vga=vga, screen=screen, lead=beam_latency(config), at_start=True
    )  # fmt: skip
    caster = beam_caster(
        clk, reset, start_line=start_line, next_column=scan.next_column, row_slope=row_slope, camera=camera,
        picture=picture, rects=rects, pixel=pixel, config=config,
    )  # fmt: skip

    # start_screen comes before the first row; the rows before it are not shown.
    @always_seq(clk.posedge, reset=reset)
    def count_rows():
        if scan.start_screen:
            first_row.next = True
        elif scan.start_row:
            first_row.next = False
            if first_row:
                row.next = 0
            elif row != rows:
                row.next = row + 1

    @always_seq(clk.posedge, reset=reset)
    def aim():
        row_slope.next = horizon_row - row

    # The setup of a line starts at the leading edge of its horizontal sync; its row has been counted by then.
    @always_seq(clk.posedge, reset=reset)
    def remember_sync():
        hs_before.next = vga.hs

    @always_comb
    def find_line():
        start_line.next = (vga.hs == hs_active) and (hs_before != hs_active)

    # in_picture: the line shows a row; each row has `config.screen_geometry.doubling` lines.
    @always_seq(clk.posedge, reset=reset)
    def count_lines():
        if scan.start_row:
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

    @always_comb
    def draw():
        drawing.next = picture.run and in_picture and scan.visible_line

    @always_comb
    def report():
        progress.busy.next = drawing
        progress.underrun.next = False

    # row_cycles saturates.
    @always_seq(clk.posedge, reset=reset)
    def measure():
        progress.group_cycles.next = 1
        if start_line:
            progress.row_cycles.next = 1
        elif drawing and (progress.row_cycles != cycles_limit):
            progress.row_cycles.next = progress.row_cycles + 1

    @always_comb
    def blank():
        shown.word.next = 0
        if picture.run:
            shown.word.next = pixel.word

    return instances()
