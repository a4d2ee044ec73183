# SPDX-License-Identifier: MIT
"""The renderer of the span engine, which draws whole frames and shows the last one."""

from myhdl import ConcatSignal, always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, side_by_side, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import Picture, Rects, Scan, Vector
from raycaster.rtl.common.records import Camera, Pixel
from raycaster.rtl.common.widths import index_bits, pixel_bits, signed_slope_bits
from raycaster.rtl.span.frame_list import frame_list
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.records import Run
from raycaster.rtl.span.rect_copier import rect_copier
from raycaster.rtl.span.rect_table import rect_table
from raycaster.rtl.span.row_slope import row_slope
from raycaster.rtl.span.run_entry import run_entry
from raycaster.rtl.span.span_unit import span_unit
from raycaster.rtl.video.video_generator import video_generator


@block
def span_renderer(clk, reset, picture, camera, rects, progress, vga, config: Configuration):
    """Draw the live scene into one list of runs, and show the other list.

    A frame that is not whole at StartScreen leaves the last one standing. So what the monitor shows is always one whole
    frame of one scene, and a frame that is late is not wrong.

    Args:
        clk: the monitor's clock.
        picture: `Picture` of the live scene.
        camera: `Camera` of the live scene.
        rects: `Rects`; drives index and fetch, reads usable and rect.
        progress: `Progress`; output.
        vga: `Vga`; output.
    """
    screen, units, width = config.screen_geometry, config.units, pixel_bits(config)
    one_clock = screen.clocks_per_pixel == 1

    scan, shown = Scan(start_screen=progress.start_screen), Pixel(config.port_bits)
    slope = Vector(signed_slope_bits(config))
    stop, first_row, next_row = (bit() for _ in range(3))
    start, ready = unsigned(units), unsigned(units)
    dones = [bit() for _ in range(units)]
    runs = [Run(config) for _ in range(units)]
    valids = [run.valid for run in runs]
    done, valid = side_by_side(dones), side_by_side(valids)
    entries = [ListEntry(screen.columns, width) for _ in range(units)]
    pixels = unsigned(config.pixels * width)

    # A fixed scene is constant, but processes cannot read constants only.
    seen, view = picture, camera
    if config.fixed and config.fixed.camera:
        seen, view = Picture(run=picture.run), Camera(config)

        @always(clk.posedge)
        def copy_constants():
            view.word.next = camera.word
            seen.reflections.next = picture.reflections
            seen.background.next = picture.background

    # The lists take one clock. If a pixel also takes only one, columns are announced one clock earlier.
    video = video_generator(
        clk=clk, reset=reset, scan=scan, pixel=shown, vga=vga, screen=screen, lead=int(one_clock)
    )  # fmt: skip
    slopes = row_slope(clk=clk, first_row=first_row, next_row=next_row, camera=view, slope=slope, config=config)
    if units == 1:
        walks, hold = [rects], tied(0, 1)
    else:
        hold, store, number = bit(), bit(), unsigned(index_bits(config))
        walks = [Rects(config, usable=rects.usable) for _ in range(units)]
        copier = rect_copier(
            clk=clk, reset=reset, start=first_row, rects=rects, store=store, number=number, copying=hold, config=config
        )  # fmt: skip
        tables = [
            rect_table(clk=clk, store=store, number=number, rect=rects.rect, walk=walk, config=config)
            for walk in walks
        ]  # fmt: skip
    drawers = [
        span_unit(
            clk=clk, reset=stop, start=start(i), slope=slope, rects=walks[i], camera=view, picture=seen,
            run=runs[i], done=dones[i], config=config,
        )
        for i in range(units)
    ]  # fmt: skip
    entry_makers = [run_entry(run=runs[i], ready=ready(i), entry=entries[i], config=config) for i in range(units)]
    lists = frame_list(
        clk=clk, reset=reset, scan=scan, run=picture.run, hold=hold, take_scene=progress.take_scene, stop=stop,
        first_row=first_row, next_row=next_row, start=start, done=done, valid=valid,
        runs=side_by_side([entry.word for entry in entries]), ready=ready, busy=progress.busy, events=progress.frames,
        shown=pixels, columns=screen.columns, rows=screen.rows, entries=config.list, units=units, pixels=config.pixels,
        queue=2 * screen.columns,
    )  # fmt: skip

    if config.pixels == 1:
        show = assign(shown.word, lambda: pixels)

    else:
        left, right = (Pixel(config.colour_bits).cut(pixels, number) for number in range(2))
        pair = shown.joined(
            red=ConcatSignal(right.red, left.red), green=ConcatSignal(right.green, left.green),
            blue=ConcatSignal(right.blue, left.blue),
        )  # fmt: skip

        show = assign(shown.word, lambda: pair)

    return instances()
