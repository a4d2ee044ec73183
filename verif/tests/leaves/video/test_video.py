# SPDX-License-Identifier: MIT
"""Leaf tests of the line buffer and of the monitor's timing."""

from dataclasses import replace
from itertools import product

import pytest
from vectors import by

from raycaster.design.decide import configure
from raycaster.hdl.signals import bits_for
from raycaster.rtl.common.interfaces import Scan, Vga
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.common.widths import offset_bits, pixel_bits
from raycaster.rtl.video.line_buffer import line_buffer
from raycaster.rtl.video.video_generator import video_generator
from raycaster.screens import LIST_SCREENS, SCREENS, Screen, Span


@pytest.mark.slow_sets("160", "5")
@by(units=[1, 5, 32, 64, 160, 320], colour_bits=[1, 4, 8])
def test_line_buffer(units, colour_bits, leaf_of, random):
    """Writes to one half while the other one is read, often at the same place."""
    config = configure(units=units, colour_bits=colour_bits, rectangles=1, allow_underrun=True)
    groups, width = config.groups, pixel_bits(config)
    widths = {"write_offset": offset_bits(config), "read_offset": bits_for(groups)}
    leaf = leaf_of(line_buffer, config, **widths, pixel_in=width, pixel_out=width)

    def pixel() -> int:
        return int(random.choice([0, 1, (1 << width) - 1, random.integers(1 << width)]))

    for half, offset in product((0, 1), range(groups)):
        leaf.case({"write": 1, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()})
    for _ in range(600):
        written = int(random.choice([0, groups - 1, random.integers(groups)]))
        # The renderer's counter stops at its maximum and does not write there.
        write, half = int(random.random() < 0.5), int(random.integers(2))
        offset = written if write or random.random() < 0.5 else groups
        leaf.case({"write": write, "line_buf_sel": half, "write_offset": offset, "pixel_in": pixel()})
        leaf.stimulus[-1]["read_offset"] = int(random.choice([written, random.integers(groups)]))
    halves = [{}, {}]
    for cycle, inputs in enumerate(leaf.stimulus[:-1]):
        shown = halves[1 - inputs["line_buf_sel"]]
        leaf.expected[cycle + 1]["pixel_out"] = shown.get(inputs.get("read_offset", 0))
        if inputs["write"]:
            halves[inputs["line_buf_sel"]][inputs["write_offset"]] = inputs["pixel_in"]
    leaf.check(settled=2 * groups + 1)


def video_model(screen: Screen, lead: int, cycle: int, colours: list[list[int]]) -> dict[str, int]:
    """Compute every output from the number of cycles since reset; `colours` are the inputs so far."""
    pixels = screen.pixels_per_clock
    line = [part // pixels for part in (screen.horizontal.visible, screen.horizontal.front, screen.horizontal.sync)]
    horizontal = Span(*line, screen.horizontal.back // pixels, active_high=screen.horizontal.active_high)
    vertical, doubling = screen.vertical, screen.doubling

    def position(pixel: int) -> tuple[int, int]:
        line, x = divmod(pixel, horizontal.total)
        return x - horizontal.blank, line % vertical.total - vertical.blank

    clocks = screen.clocks_per_pixel
    pixel, clock = divmod(cycle, clocks)
    x, y = position(pixel)
    line_start = x == -horizontal.blank and clock == 0
    column = x + lead
    in_columns = 0 <= column < horizontal.visible
    outputs = {
        "scan_start_screen": line_start and y == -doubling,
        "scan_start_row": line_start and y >= 0 and y % doubling == 0,
        "scan_visible_line": in_columns,
        "scan_next_column": in_columns and clock == clocks - 1 and column % doubling == doubling - 1,
        # With one clock per pixel it is the inverted clock, and the bench samples while the clock is low.
        "vga_clk": clock == clocks - 1,
        "vga_sync_n": 0,
    }
    hs = vs = visible = False
    if pixel > 0:
        # The outputs are one pixel late.
        x, y = position(pixel - 1)
        hs = horizontal.front <= x + horizontal.blank < horizontal.front + horizontal.sync
        # Vertical sync waits for the next horizontal sync to begin.
        line = y + vertical.blank - (x + horizontal.blank < horizontal.front)
        vs = vertical.front <= line < vertical.front + vertical.sync
        visible = x >= 0 and y >= 0
    outputs |= {"vga_hs": hs == horizontal.active_high, "vga_vs": vs == vertical.active_high, "vga_blank_n": visible}
    shown = colours[clocks * pixel - 1] if visible else (0, 0, 0)
    outputs |= dict(zip(("vga_r", "vga_g", "vga_b"), shown, strict=True))
    return outputs


SMALL_SCREENS = {
    "both-low": Screen(4, 3, 1, 2, Span(8, 1, 2, 1, active_high=False), Span(6, 1, 1, 2, active_high=False)),
    "both-high": Screen(3, 4, 1, 2, Span(6, 3, 1, 2, active_high=True), Span(8, 2, 1, 1, active_high=True)),
    "mixed": Screen(5, 2, 1, 1, Span(5, 2, 3, 4, active_high=False), Span(2, 1, 2, 1, active_high=True)),
    "threefold": Screen(2, 2, 1, 3, Span(6, 1, 2, 2, active_high=True), Span(6, 1, 1, 3, active_high=False)),
    "tiny": SCREENS["tiny", 48],
}

PAIRS = Screen(10, 2, 1, 1, Span(10, 2, 4, 6, active_high=True), Span(2, 1, 2, 1, active_high=False), 1)

ONE_CLOCK = {
    "one-clock": (replace(SMALL_SCREENS["both-low"], clocks_per_pixel=1), 0),
    "a-clock-early": (replace(SMALL_SCREENS["threefold"], clocks_per_pixel=1), 1),
    "early": (replace(SMALL_SCREENS["mixed"], clocks_per_pixel=1), 9),
    "early-doubled": (replace(SMALL_SCREENS["both-high"], clocks_per_pixel=1), 5),
    "pairs": (PAIRS.paired(), 1),
}
"""Screens, and the number of pixel clocks by which columns are announced early."""


@by(name=[*SMALL_SCREENS, *ONE_CLOCK], colour_bits=[1, 8])
def test_video_generator(name, colour_bits, leaf_of, random):
    screen, lead = ONE_CLOCK.get(name) or (SMALL_SCREENS[name], 0)
    channels = ("pixel_red", "pixel_green", "pixel_blue")
    width = colour_bits * screen.pixels_per_clock
    ports = {"scan": Scan, "pixel": lambda: Pixel(width), "vga": lambda: Vga(width)}
    leaf = leaf_of(video_generator, **ports, screen=screen, lead=lead)
    large = screen.frame_cycles > 10_000
    # Three frames, then one that reset ends early in a pixel's second half, then a few lines; large screens: one frame.
    lengths = [screen.frame_cycles + 500] if large else [3 * screen.frame_cycles + 7, screen.frame_cycles // 2 | 1, 60]
    for length in lengths:
        shown = []
        for cycle in (None, None, *range(length)):
            colours = random.integers(1 << width, size=3).tolist()
            leaf.case({**dict(zip(channels, colours, strict=True)), "reset": int(cycle is None)})
            if cycle is not None:
                shown.append(colours)
                leaf.expect(video_model(screen, lead, cycle, shown))
    leaf.check(settled=1)


MODES = {
    (640, 480, 25_000_000): (25_175_000, (16, 96, 48), (10, 2, 33), (0, 0)),  # VESA DMT 04h, CTA-861 VIC 1
    (640, 400, 25_000_000): (25_175_000, (16, 96, 48), (12, 2, 35), (0, 1)),  # IBM's VGA, text mode at 70 Hz
    (1280, 720, 74_250_000): (74_250_000, (110, 40, 220), (5, 5, 20), (1, 1)),  # VESA DMT 55h, CTA-861 VIC 4
    (1920, 1080, 74_250_000): (74_250_000, (88, 44, 148), (4, 5, 36), (1, 1)),  # CTA-861 VIC 34
    (1920, 1080, 148_500_000): (148_500_000, (88, 44, 148), (4, 5, 36), (1, 1)),  # VESA DMT 52h, CTA-861 VIC 16
}
"""The standards' pixel clock; front porch, sync and back porch of lines and of frames; and the syncs' active levels, by
pixels, lines and the designs' pixel clock. Typed from the standards."""

OUR_OWN = {"tiny": (128, 96), "play": (320, 240)}
"""Screens with timings of no standard, for simulation: pixels and lines."""


@pytest.mark.parametrize("screens", [SCREENS, LIST_SCREENS], ids=["buffered", "lists"])
def test_the_timings_are_the_standards(screens):
    """Every screen, at every scale, with one pixel or two per clock."""
    seen = set()
    for (name, rows), screen in screens.items():
        for scaled in map(screen.scaled, screen.scales):
            for one in (scaled, scaled.paired()):
                h, v = one.horizontal, one.vertical
                if name in OUR_OWN:
                    assert (h.visible, v.visible, one.standard_hz) == (*OUR_OWN[name], None)
                    continue
                mode = (h.visible, v.visible, one.pixel_hz)
                timing = (h.front, h.sync, h.back), (v.front, v.sync, v.back), (h.active_high, v.active_high)
                assert (one.standard_hz, *timing) == MODES[mode], (name, rows, one.scale)
                seen.add(mode)
    assert seen == (set(MODES) if screens is LIST_SCREENS else {mode for mode in MODES if mode[0] == 640})
