# SPDX-License-Identifier: MIT
"""Row after row of rays, just ahead of the monitor."""

from myhdl import always, always_comb, always_seq, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import (
    CYCLE_BITS,
    bit,
    bits_for,
    offset_bits,
    pixel_bits,
    row_bits,
    unit_bits,
    unsigned,
)
from raycaster.rtl.engine.engines import ENGINES
from raycaster.rtl.video.line_buffer import line_buffer
from raycaster.rtl.video.video_generator import video_generator


@block
def ray_caster_renderer(
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
    """Render the live scene into the double line buffer, and show it.

    While a row is shown the next one is rendered, in config.groups groups of config.units columns. The live scene may
    change in the cycle after start_screen only. underrun: strobe at the end of a row's time when the row is not
    complete; it is abandoned, and columns that were not written keep what that half of the buffer held.
    row_cycles, group_cycles: cycles since the row's, and the group's, start, with the present one; they mean something
    while busy, which is high up to the row's last cycle.
    run: 0 renders nothing and shows black.
    """
    units, groups, rows = config.units, config.groups, config.screen_geometry.rows
    width = pixel_bits(config)
    channel = config.colour_bits
    last_unit = units - 1
    cycles_limit = (1 << CYCLE_BITS) - 1

    row = unsigned(row_bits(config))
    column_offset = unsigned(offset_bits(config))
    line_buf_sel = bit()
    enable, done = bit(), bit()
    restart, reset_delay, reset_ray_caster = bit(), bit(), bit()
    rendering = bit()
    handed_over = bit()
    start_row, visible_line, next_column = bit(), bit(), bit()
    colours = unsigned(units * width)
    read_offset = unsigned(bits_for(groups))
    read_unit = unsigned(unit_bits(config))
    sections = [unsigned(width) for _ in range(units)]
    shown = unsigned(width)
    red, green, blue = (unsigned(channel) for _ in range(3))
    pixels = [colours((unit + 1) * width, unit * width) for unit in range(units)]

    video = video_generator(
        clk, reset, start_screen, start_row, visible_line, next_column, red, green, blue,
        vga_r, vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk, config.screen_geometry,
    )  # fmt: skip
    caster = ENGINES[config.engine](
        clk, reset_ray_caster, enable, row, column_offset, camera, background, reflections, rects, done, colours, config
    )
    buffers = [
        line_buffer(clk, done, line_buf_sel, column_offset, pixels[unit], read_offset, sections[unit], config)
        for unit in range(units)
    ]

    # The row counter's lowest bit chooses the half of the line buffer that is written.
    @always_comb
    def select_line_buffer():
        line_buf_sel.next = row[0]

    # Max comparison: the ray caster runs while the row has columns left.
    @always_comb
    def compare_max():
        enable.next = rendering and run and (column_offset != groups)

    # What software sees of it.
    @always_comb
    def tell_busy():
        busy.next = enable

    # When done, the group is written, the next one takes its place, and the ray caster starts anew.
    @always_comb
    def finish_group():
        restart.next = reset or start_screen or start_row or done

    # The seed's reset delay: the second cycle lets the comparison see the new column offset.
    @always(clk.posedge)
    def delay_reset():
        reset_delay.next = restart

    # Either cycle resets.
    @always_comb
    def join_resets():
        reset_ray_caster.next = restart or reset_delay

    # Which rows are rendered, from StartScreen to the last row's handover.
    @always_seq(clk.posedge, reset=reset)
    def count_rows():
        if start_screen:
            row.next = 0
            rendering.next = True
            handed_over.next = False
        elif start_row and rendering:
            row.next = row + 1
            handed_over.next = run
            if row == rows - 1:
                rendering.next = False

    # Which group of columns, up to Max.
    @always_seq(clk.posedge, reset=reset)
    def count_columns():
        if start_screen or start_row:
            column_offset.next = 0
        elif done:
            column_offset.next = column_offset + 1

    # A row's time is over before its columns are.
    @always_comb
    def watch_budget():
        underrun.next = start_row and enable

    # How long this row and this group have taken, the present cycle included; they saturate.
    @always_seq(clk.posedge, reset=reset)
    def measure():
        if start_screen or start_row:
            row_cycles.next = 1
            group_cycles.next = 1
        elif enable:
            if row_cycles != cycles_limit:
                row_cycles.next = row_cycles + 1
            if done:
                group_cycles.next = 1
            elif group_cycles != cycles_limit:
                group_cycles.next = group_cycles + 1

    # The monitor's column as the section and the place in it.
    @always_seq(clk.posedge, reset=reset)
    def follow_columns():
        if not visible_line:
            read_offset.next = 0
            read_unit.next = 0
        elif next_column:
            if read_unit != last_unit:
                read_unit.next = read_unit + 1
            else:
                read_unit.next = 0
                if read_offset != groups - 1:
                    read_offset.next = read_offset + 1

    # The section's pixel.
    @always_comb
    def choose_section():
        shown.next = sections[read_unit]

    # Black until the first row is handed over.
    @always_comb
    def split_channels():
        red.next = 0
        green.next = 0
        blue.next = 0
        if handed_over:
            red.next = shown[3 * channel : 2 * channel]
            green.next = shown[2 * channel : channel]
            blue.next = shown[channel:]

    return (
        video, caster, buffers, select_line_buffer, compare_max, tell_busy, finish_group, delay_reset, join_resets,
        count_rows, count_columns, watch_budget, measure, follow_columns, choose_section, split_channels,
    )  # fmt: skip
