# SPDX-License-Identifier: MIT
"""What is looked through, and how a monitor shows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

COORDINATE_BITS = 9
"""World coordinates are unsigned: 0..511."""

VIEW_DISTANCE = 100
"""Slope along x of every primary ray: the distance of the viewing rectangle, in world units."""


@dataclass(frozen=True)
class Span:
    """One direction of a video timing, in pixels or lines, in the order in which a monitor sees it."""

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
    """What is looked through (columns x rows of rays) and how it is shown (each `doubling` x `doubling` pixels)."""

    columns: int
    rows: int
    horizon_row: int
    """The row whose rays have no z slope."""
    doubling: int
    horizontal: Span
    vertical: Span
    clocks_per_pixel: int = 2
    """System clocks a pixel of the monitor; two give the line-buffered engines twice the time."""
    pixel_hz: int = 25_000_000
    scale: int = 1
    """Samples a unit of slope: the resolution scale."""
    distance: int = VIEW_DISTANCE
    """Slope along x of every primary ray at scale 1; with half as many columns, half as much shows the same view."""
    pixels_per_clock: int = 1
    """Pixels of the monitor a system clock; two are side by side, the left one in an even column."""
    for_pairs: Screen | None = None
    """What takes its place where a clock has two pixels: as many of them, at scale 1."""
    finer: Screen | None = None
    """The monitor of those scales for which this one has no whole pixels."""

    @property
    def centre_column(self) -> int:
        """The column whose rays have no y slope."""
        return self.columns // 2

    @property
    def view_distance(self) -> int:
        """Slope along x of every primary ray."""
        return self.distance * self.scale

    @property
    def clock_hz(self) -> int:
        """Of the system clock."""
        return self.pixel_hz * self.clocks_per_pixel // self.pixels_per_clock

    @property
    def beats(self) -> Span:
        """The horizontal timing in steps of `pixels_per_clock` pixels, as the video timing counts."""
        one, pixels = self.horizontal, self.pixels_per_clock
        parts = (part // pixels for part in (one.visible, one.front, one.sync, one.back))
        return Span(*parts, active_high=one.active_high)

    @property
    def line_cycles(self) -> int:
        """System cycles of a line of the monitor, blanking included."""
        return self.beats.total * self.clocks_per_pixel

    @property
    def row_cycles(self) -> int:
        """System cycles in which one row of rays is shown, and the next must be ready."""
        return self.doubling * self.line_cycles

    @property
    def frame_cycles(self) -> int:
        """System cycles of a frame, blanking included."""
        return self.line_cycles * self.vertical.total

    @property
    def scales(self) -> list[int]:
        """Those at which a sample is a whole number of the monitor's pixels, or of the finer one's."""
        own = [scale for scale in range(1, self.doubling + 1) if self.doubling % scale == 0]
        return sorted({*own, *(self.finer.scales if self.finer else ())})

    def scaled(self, scale: int) -> Screen:
        """The same view, sampled `scale` times finer in both directions: one of `scales`."""
        if scale == 1:
            return self
        if self.doubling % scale:
            if self.finer is None:
                raise ValueError(f"scale: {scale} is none of {self.scales}")
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
        """The same with two pixels a clock, in half as many clocks."""
        screen = self.for_pairs.scaled(self.scale) if self.for_pairs else self
        return replace(screen, pixels_per_clock=2)


_VGA_LINE = Span(visible=640, front=16, sync=96, back=48, active_high=False)
_VGA_240 = Screen(320, 240, 190, 2, _VGA_LINE, Span(480, 10, 2, 33, active_high=False))
_VGA_200 = Screen(320, 200, 150, 2, _VGA_LINE, Span(400, 12, 2, 35, active_high=True))
_FULL_HD_60 = Screen(
    320, 180, 130, 6, Span(1920, 88, 44, 148, active_high=True), Span(1080, 4, 5, 36, active_high=True),
    clocks_per_pixel=1, pixel_hz=148_500_000,
)  # fmt: skip
# At one clock, two pixels in each make twice as many frames.
_FULL_HD_30 = replace(_FULL_HD_60, pixel_hz=74_250_000, for_pairs=_FULL_HD_60)
_HD_180 = Screen(
    320, 180, 130, 4, Span(1280, 110, 40, 220, active_high=True), Span(720, 5, 5, 20, active_high=True),
    pixel_hz=74_250_000, finer=_FULL_HD_30,
)  # fmt: skip
_TINY_LINES = Span(96, 2, 2, 4, active_high=False)
# The line is just long enough for 32 units to have the same 320 cycles a group as on the full screen.
_TINY_48 = Screen(64, 48, 38, 2, Span(128, 8, 16, 8, active_high=False), _TINY_LINES)
# And this one for the beam engine to take up to 32 rectangles in its blanking.
_TINY_BEAM_48 = replace(
    _TINY_48,
    horizontal=Span(128, 16, 32, 64, active_high=False),
    for_pairs=replace(_TINY_48, horizontal=Span(128, 32, 64, 192, active_high=False), clocks_per_pixel=1),
)

# A pixel a ray, for programs that are simulated, at 60 frames a second. The blanking is the shortest in which the beam
# engine takes two reflections and 32 rectangles, or 12 before a camera that turns.
_PLAY_240 = Screen(
    320, 240, 190, 1, Span(320, 2, 40, 58, active_high=False), Span(240, 1, 1, 1, active_high=False), pixel_hz=6_120_000
)

# The view of 240 rows in fewer, for small and slow chips: a pixel takes a clock, which has half the rate.
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
"""By screen name and rows, at scale 1, for the engines with a line buffer."""

BEAM_SCREENS: Mapping[tuple[str, int], Screen] = {
    place: replace(screen, clocks_per_pixel=1)
    for place, screen in {
        ("vga", 240): _VGA_240,
        ("vga", 200): _VGA_200,
        ("vga", 180): _HD_180,
        ("tiny", 48): _TINY_BEAM_48,
        ("play", 240): _PLAY_240,
    }.items()
}
"""By screen name and rows, at scale 1, for the beam engine, which takes a clock a pixel."""
