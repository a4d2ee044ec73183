# SPDX-License-Identifier: MIT
"""The renderer with a line buffer, which renders each row just ahead of the monitor."""

from collections.abc import Callable

from myhdl import always_seq, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, derived_clock, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.buffered.ray_caster import ray_caster
from raycaster.rtl.common.clock_gate import clock_gate
from raycaster.rtl.common.interfaces import Place, Scan
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.common.widths import CYCLE_BITS, pixel_bits, unit_bits
from raycaster.rtl.video.line_buffer import line_buffer
from raycaster.rtl.video.video_generator import video_generator


@block
def ray_caster_renderer(
    clk, reset, picture, camera, rects, progress, vga, config: Configuration, control: Callable, unit: Callable
):
    """Render the live scene into the double line buffer, and show it.

    While a row is shown the next one is rendered, in `config.groups` groups of `config.units` columns. The live scene
    may change only in the cycle after progress.start_screen. A row that is not complete at the end of its time is
    abandoned, and columns that were not written keep the old pixels of that half of the buffer.

    Args:
        picture: `Picture` of the live scene.
        camera: `Camera` of the live scene.
        rects: `Rects`; drives index and fetch, reads usable and rect.
        progress: `Progress`; output. underrun comes at the end of a row's time if the row is not complete; row_cycles
            and group_cycles saturate.
        vga: `Vga`; output.
        control: the engine's block that operates all units.
        unit: the engine's block of one unit.
    """
    units, groups, rows = config.units, config.groups, config.screen_geometry.rows
    width = pixel_bits(config)
    last_unit = units - 1
    one_clock = config.screen_geometry.clocks_per_pixel == 1
    cycles_limit = (1 << CYCLE_BITS) - 1

    place, scan, pixel = Place(config), Scan(), Pixel(config.colour_bits)
    line_buf_sel, enable, done, rendering, handed_over = (bit() for _ in range(5))
    restart, reset_delay, reset_ray_caster = bit(), bit(), bit()
    caster_awake, caster_clk = bit(), derived_clock(clk)
    pixels = unsigned(units * width)
    read_offset, read_unit = unsigned(bits_for(groups)), unsigned(unit_bits(config))
    sections = [unsigned(width) for _ in range(units)]
    shown_unit = unsigned(unit_bits(config)) if one_clock else read_unit

    # The line buffer takes one clock. If a pixel also takes only one, columns are announced one clock earlier.
    video = video_generator(
        clk=clk, reset=reset, scan=scan, pixel=pixel, vga=vga, screen=config.screen_geometry, lead=int(one_clock)
    )  # fmt: skip
    caster = ray_caster(
        clk=caster_clk, reset_ray_caster=reset_ray_caster, enable=enable, place=place, camera=camera, picture=picture,
        rects=rects, done=done, pixels=pixels, config=config, control=control, unit=unit,
    )  # fmt: skip
    gate = clock_gate(clk, reset, awake=caster_awake, gated_clk=caster_clk)
    buffers = [
        line_buffer(
            clk=clk, write=done, line_buf_sel=line_buf_sel, write_offset=place.column_offset,
            pixel_in=pixels((unit + 1) * width, unit * width), read_offset=read_offset, pixel_out=sections[unit],
            config=config,
        )
        for unit in range(units)
    ]  # fmt: skip

    # The row counter's lowest bit chooses the half of the line buffer that is written.
    select_line_buffer = assign(line_buf_sel, lambda: place.row[0])

    # Max comparison: the ray caster runs while the row has columns left.
    compare_max = assign(enable, lambda: rendering and picture.run and (place.column_offset != groups))
    report = assign(
        (progress.start_screen, progress.busy, progress.underrun),
        lambda: (scan.start_screen, enable, scan.start_row and enable),
    )

    # When done, the group is written, the next one takes its place, and the ray caster restarts.
    finish_group = assign(restart, lambda: reset or scan.start_screen or scan.start_row or done)

    # The seed's reset delay: in the second cycle of a reset, the comparison with Max sees the new column offset.
    delay_reset = register(clk, reset_delay, lambda: restart)

    join_resets = assign(reset_ray_caster, lambda: restart or reset_delay)

    # The ray caster is idle between rows, and each row begins with its reset.
    wake = assign(caster_awake, lambda: enable or reset_ray_caster)

    # Rows are rendered from StartScreen to the last row's handover.
    @always_seq(clk.posedge, reset=reset)
    def count_rows():
        if scan.start_screen:
            place.row.next = 0
            rendering.next = True
            handed_over.next = False
        elif scan.start_row and rendering:
            place.row.next = place.row + 1
            handed_over.next = picture.run
            if place.row == rows - 1:
                rendering.next = False

    @always_seq(clk.posedge, reset=reset)
    def count_columns():
        if scan.start_screen or scan.start_row:
            place.column_offset.next = 0
        elif done:
            place.column_offset.next = place.column_offset + 1

    @always_seq(clk.posedge, reset=reset)
    def measure():
        if scan.start_screen or scan.start_row:
            progress.row_cycles.next = progress.group_cycles.next = 1
        elif enable:
            if progress.row_cycles != cycles_limit:
                progress.row_cycles.next = progress.row_cycles + 1
            if done:
                progress.group_cycles.next = 1
            elif progress.group_cycles != cycles_limit:
                progress.group_cycles.next = progress.group_cycles + 1

    # The monitor's column, as a unit's section and the offset in it.
    @always_seq(clk.posedge, reset=reset)
    def follow_columns():
        if not scan.visible_line:
            read_offset.next = read_unit.next = 0
        elif scan.next_column:
            if read_unit != last_unit:
                read_unit.next = read_unit + 1
            else:
                read_unit.next = 0
                if read_offset != groups - 1:
                    read_offset.next = read_offset + 1

    if one_clock:
        # Delayed as much as the pixels that the line buffer reads.
        follow_unit = register(clk, shown_unit, lambda: read_unit)

    # Black until the first row is handed over.
    show = assign(pixel.word, lambda: sections[shown_unit] if handed_over else 0)

    return instances()
