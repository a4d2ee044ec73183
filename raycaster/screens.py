# SPDX-License-Identifier: MIT
"""Screens: grids of rays, and the video timings that show them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

COORDINATE_BITS = 9
"""Width of world coordinates, which are unsigned: 0..511."""

VIEW_DISTANCE = 100
"""Slope along x of every primary ray: the distance of the viewing rectangle, in world units."""


@dataclass(frozen=True)
class Span:
    """Video timing in one direction, in pixels or lines, in the order in which a monitor sees it."""

    visible: int
    front: int
    sync: int
    back: int
    active_high: bool

    @property
    def blank(self) -> int:
        """Front porch, sync and back porch together."""
        return self.front + self.sync + self.back

    @property
    def total(self) -> int:
        """The whole period."""
        return self.visible + self.blank


@dataclass(frozen=True)
class Screen:
    """A grid of columns x rows rays, each shown as `doubling` x `doubling` pixels of a monitor."""

    columns: int
    rows: int
    horizon_row: int
    """Row whose rays have no z slope."""
    doubling: int
    horizontal: Span
    vertical: Span
    clocks_per_pixel: int = 2
    """System clocks per pixel of the monitor; two give the line-buffered engines twice the time."""
    pixel_hz: int = 25_000_000
    """Pixel clock for which designs are made."""
    standard_hz: int | None = None
    """Pixel clock of the standard that has this timing; None if no standard has it."""
    scale: int = 1
    """Resolution scale: samples per unit of slope."""
    distance: int = VIEW_DISTANCE
    """Slope along x of every primary ray at scale 1; half of it shows the same view with half as many columns."""
    pixels_per_clock: int = 1
    """Pixels of the monitor per system clock; two are side by side, the left one in an even column."""
    for_pairs: Screen | None = None
    """Screen with as many pixels, at scale 1, that replaces this one for two pixels per clock."""
    finer: Screen | None = None
    """Screen for the scales at which a sample is not a whole number of this screen's pixels."""

    @property
    def centre_column(self) -> int:
        """Column whose rays have no y slope."""
        return self.columns // 2

    @property
    def view_distance(self) -> int:
        """Slope along x of every primary ray."""
        return self.distance * self.scale

    @property
    def clock_hz(self) -> int:
        """Frequency of the system clock, in Hz."""
        return self.pixel_hz * self.clocks_per_pixel // self.pixels_per_clock

    @property
    def monitor_hz(self) -> int:
        """Pixel clock to aim at with a PLL: that of the standard, if there is one."""
        return self.standard_hz or self.pixel_hz

    @property
    def beats(self) -> Span:
        """The horizontal timing in steps of `pixels_per_clock` pixels, as the video timing counts."""
        one, pixels = self.horizontal, self.pixels_per_clock
        parts = (part // pixels for part in (one.visible, one.front, one.sync, one.back))
        return Span(*parts, active_high=one.active_high)

    @property
    def line_cycles(self) -> int:
        """System cycles per line of the monitor, blanking included."""
        return self.beats.total * self.clocks_per_pixel

    @property
    def row_cycles(self) -> int:
        """System cycles in which one row of rays is shown, and the next must be ready."""
        return self.doubling * self.line_cycles

    @property
    def frame_cycles(self) -> int:
        """System cycles per frame, blanking included."""
        return self.line_cycles * self.vertical.total

    @property
    def scales(self) -> list[int]:
        """Scales at which a sample is a whole number of pixels on the monitor, or on the finer one."""
        own = [scale for scale in range(1, self.doubling + 1) if self.doubling % scale == 0]
        return sorted({*own, *(self.finer.scales if self.finer else ())})

    def scaled(self, scale: int) -> Screen:
        """Return the same view, sampled `scale` times finer in both directions; `scale` is one of `scales`."""
        if scale == 1:
            return self
        if self.doubling % scale:
            if self.finer is None:
                raise ValueError(f"scale: {scale} is not one of {self.scales}")
            return self.finer.scaled(scale)
        return replace(
            self,
            columns=self.columns * scale,
            rows=self.rows * scale,
            horizon_row=self.horizon_row * scale,
            doubling=self.doubling // scale,
            scale=scale,
        )

    def paired(self) -> Screen:
        """Return the same screen with two pixels per clock, in half as many clocks."""
        screen = self.for_pairs.scaled(self.scale) if self.for_pairs else self
        return replace(screen, pixels_per_clock=2)


# 25 MHz is half of the 50 MHz of most boards, 0.7 per cent below the standard.
_VGA_LINE = Span(visible=640, front=16, sync=96, back=48, active_high=False)
_VGA_240 = Screen(320, 240, 190, 2, _VGA_LINE, Span(480, 10, 2, 33, active_high=False), standard_hz=25_175_000)
_VGA_200 = Screen(320, 200, 150, 2, _VGA_LINE, Span(400, 12, 2, 35, active_high=True), standard_hz=25_175_000)
_FULL_HD_60 = Screen(
    320, 180, 130, 6, Span(1920, 88, 44, 148, active_high=True), Span(1080, 4, 5, 36, active_high=True),
    clocks_per_pixel=1, pixel_hz=148_500_000, standard_hz=148_500_000,
)  # fmt: skip
# At the same clock frequency, two pixels per clock double the frame rate.
_FULL_HD_30 = replace(_FULL_HD_60, pixel_hz=74_250_000, standard_hz=74_250_000, for_pairs=_FULL_HD_60)
_HD_180 = Screen(
    320, 180, 130, 4, Span(1280, 110, 40, 220, active_high=True), Span(720, 5, 5, 20, active_high=True),
    pixel_hz=74_250_000, standard_hz=74_250_000, finer=_FULL_HD_30,
)  # fmt: skip
_TINY_LINES = Span(96, 2, 2, 4, active_high=False)
# The line is just long enough for 32 units to have the same 320 cycles per group as on the full screen.
_TINY_48 = Screen(64, 48, 38, 2, Span(128, 8, 16, 8, active_high=False), _TINY_LINES)
_TINY_LIST_48 = replace(
    _TINY_48,
    horizontal=Span(128, 16, 32, 64, active_high=False),
    for_pairs=replace(_TINY_48, horizontal=Span(128, 32, 64, 192, active_high=False), clocks_per_pixel=1),
)

# One pixel per ray, for simulated programs, at 60 frames per second.
_PLAY_240 = Screen(
    320, 240, 190, 1, Span(320, 2, 40, 58, active_high=False), Span(240, 1, 1, 1, active_high=False), pixel_hz=6_120_000
)

# The view of 240 rows in fewer rows, for small and slow chips: one clock per pixel, at half the clock rate.
_COARSE = {
    rows: replace(
        _VGA_240, columns=rows * 4 // 3, rows=rows, horizon_row=190 * rows // 240, doubling=480 // rows,
        clocks_per_pixel=1, distance=VIEW_DISTANCE * rows // 240,
    )
    for rows in (120, 96, 60)
}  # fmt: skip

SCREENS: Mapping[tuple[str, int], Screen] = {
    ("vga", 240): _VGA_240,
    ("vga", 200): _VGA_200,
    **{("vga", rows): screen for rows, screen in _COARSE.items()},
    ("tiny", 48): _TINY_48,
}
"""Screens for the engines with a line buffer, at scale 1, by name and rows."""

LIST_SCREENS: Mapping[tuple[str, int], Screen] = {
    place: replace(screen, clocks_per_pixel=1)
    for place, screen in {
        ("vga", 240): _VGA_240,
        ("vga", 200): _VGA_200,
        ("vga", 180): _HD_180,
        ("tiny", 48): _TINY_LIST_48,
        ("play", 240): _PLAY_240,
    }.items()
}
"""Screens for engines that draw whole frames, which take one clock per pixel, at scale 1, by name and rows."""
