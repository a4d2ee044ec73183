# SPDX-License-Identifier: MIT
"""A monitor in Python: takes the bench's lines, holds every sample against the video standard, yields pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject
from cocotb.queue import Queue
from cocotb.simtime import get_sim_time
from cocotb.triggers import Timer

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.screens import Screen, Span

CLOCK_NS = 20
"""Period of the bench's clock, whatever the design's is; only cycles count here."""

_CONTROL_BITS = 4
"""Bits of a sample before its colour: HS, VS, BLANK_N, SYNC_N."""


class VideoError(AssertionError):
    """A sample that departs from the video standard; says which, and what was expected."""


@dataclass(frozen=True)
class Line:
    """What the monitor saw from one leading edge of HS to the next."""

    bits: str
    """One character a bit, the last sample first; a sample is HS, VS, BLANK_N, SYNC_N, red, green, blue of a pixel."""

    samples: int
    """Pixels."""

    end_ns: int
    """Simulation time at which the line ended."""


class Monitor:
    """Collects lines in the background, and makes frames of them."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration, *, blanking: bool = True):
        """Watch a bench's line sink.

        Args:
            bench: it has a `sink`.
            configuration: the design in it.
            blanking: whether its pins tell of blanking; see `decode_frame`.
        """
        self._sink: Any = bench.sink
        self._blanking = blanking
        self._screen = configuration.screen_geometry
        self._colour_bits = configuration.colour_bits
        self._patience_ns = 3 * self._screen.line_cycles * CLOCK_NS
        self._lines: Queue[Line | None] = Queue()
        self._waiting_since: int | None = None
        self._synchronised = False
        self.frame_lines: list[Line] = []
        """The lines of the last frame, from VS's leading edge on."""
        cocotb.start_soon(self._collect())
        cocotb.start_soon(self._watch())

    async def _collect(self) -> None:
        sink = self._sink
        while True:
            await sink.line_event.value_change
            line = Line(str(sink.line.value), int(sink.line_samples.value), int(get_sim_time("ns")))
            self._lines.put_nowait(line)

    async def _watch(self) -> None:
        """Give up a line that somebody has waited for too long. A timeout for each would take as long as the lines."""
        while True:
            await Timer(self._patience_ns, "ns")
            since = self._waiting_since
            if since is not None and get_sim_time("ns") - since >= self._patience_ns:
                self._lines.put_nowait(None)

    def forget(self) -> None:
        """Drop what was seen so far and look for VS anew, as after a reset."""
        while not self._lines.empty():
            self._lines.get_nowait()
        self._synchronised = False

    async def line(self) -> Line:
        """The next line.

        Raises:
            VideoError: HS did not come in three line times.
        """
        self._waiting_since = int(get_sim_time("ns"))
        try:
            line = await self._lines.get()
        finally:
            self._waiting_since = None
        if line is None:
            raise VideoError(f"no leading edge of HS in three line times ({self._patience_ns} ns)")
        return line

    async def frame(self, on_row: Callable[[int], None] | None = None) -> np.ndarray:
        """The next whole frame, from VS's leading edge on; a frame follows the last one without a gap.

        Args:
            on_row: called with the number of visible lines seen so far, as each comes.

        Returns:
            Visible lines x visible pixels x 3, uint8; a channel of fewer bits stands in the top bits.

        Raises:
            VideoError: a sample of the frame departs from the standard.
        """
        lines = [await self.line() if self._synchronised else await self._first_line()]
        self._synchronised = True
        vertical = self._screen.vertical
        while len(lines) < vertical.total:
            lines.append(await self.line())
            visible = len(lines) - vertical.sync - vertical.back
            if on_row is not None and 0 < visible <= vertical.visible:
                on_row(visible)
        self.frame_lines = lines
        return decode_frame(lines, self._screen, self._colour_bits, blanking=self._blanking)

    async def _first_line(self) -> Line:
        """The first line in which VS is active after one in which it was not."""
        vertical = self._screen.vertical
        active = str(int(vertical.active_high))
        was_active = True
        for _ in range(2 * vertical.total):
            line = await self.line()
            is_active = line.bits[-(_CONTROL_BITS + 3 * self._colour_bits) + 1] == active
            if is_active and not was_active:
                return line
            was_active = is_active
        raise VideoError(f"no leading edge of VS in two frames ({2 * vertical.total} lines)")

    def check_pins(self) -> None:
        """Check what the bench has watched at every clock.

        Raises:
            VideoError: data changed at a rising edge of VGA_CLK, or that was not the halved system clock.
        """
        unstable = int(self._sink.unstable_samples.value)
        faults = int(self._sink.clock_faults.value)
        if unstable:
            raise VideoError(f"video data changed at {unstable} rising edges of vga_clk")
        if faults:
            raise VideoError(f"vga_clk did not change at {faults} clocks; it must be clk halved, or inverted")


def decode_frame(lines: Sequence[Line], screen: Screen, colour_bits: int, *, blanking: bool = True) -> np.ndarray:
    """Check every sample of a frame against the standard and return its visible part.

    Args:
        lines: one frame from VS's leading edge on, `screen.vertical.total` lines.
        screen: the standard.
        colour_bits: bits a channel has.
        blanking: whether BLANK_N tells of the picture; it is low all the time otherwise.

    Returns:
        Visible lines x visible pixels x 3, uint8; a channel of fewer than 8 bits stands in the top bits, the others 0.

    Raises:
        VideoError: names the line (from VS's leading edge), the sample (from HS's) and what was expected.
    """
    horizontal, vertical = screen.horizontal, screen.vertical
    for number, line in enumerate(lines):
        if line.samples != horizontal.total:
            raise VideoError(
                f"line {number}: {line.samples} pixels between leading edges of HS, expected {horizontal.total}"
            )
    sample_bits = _CONTROL_BITS + 3 * colour_bits
    characters = np.frombuffer("".join(line.bits for line in lines).encode(), np.uint8)
    # A line's characters are those of its last sample first, after those of samples that never came.
    characters = characters.reshape(vertical.total, -1)[:, -horizontal.total * sample_bits :]
    bits = (characters ^ ord("0")).reshape(vertical.total, horizontal.total, sample_bits)
    if bits.max() > 1:
        unknown = (bits[:, ::-1] > 1).any(axis=-1)
        line, sample = np.argwhere(unknown)[0]
        raise VideoError(f"line {line}, sample {sample}: an output is neither 0 nor 1; {unknown.sum()} samples are so")

    column = np.arange(horizontal.total)
    row = np.arange(vertical.total)[:, None]
    in_picture = _visible(row, vertical) & _visible(column, horizontal)
    controls = bits[:, ::-1, :_CONTROL_BITS]
    _check("HS", controls[..., 0], (column < horizontal.sync) == horizontal.active_high)
    _check("VS", controls[..., 1], (row < vertical.sync) == vertical.active_high)
    _check("BLANK_N", controls[..., 2], in_picture & blanking)
    _check("SYNC_N", controls[..., 3], np.False_)
    # Along an axis of 8 numpy packs a tenth as fast as all at once.
    channels = np.zeros((*in_picture.shape, 3, CHANNEL_BITS), np.uint8)
    channels[..., :colour_bits] = bits[..., _CONTROL_BITS:].reshape(*in_picture.shape, 3, colour_bits)
    colours = np.packbits(channels).reshape(*in_picture.shape, 3)[:, ::-1]
    _check("any colour in blanking", colours.any(axis=-1) & ~in_picture, np.False_)
    return colours[in_picture].reshape(vertical.visible, horizontal.visible, 3)


def _visible(position: np.ndarray, span: Span) -> np.ndarray:
    """Where a position counted from the sync's leading edge is in the picture."""
    start = span.sync + span.back
    return (position >= start) & (position < start + span.visible)


def _check(what: str, seen: np.ndarray, expected: np.ndarray | np.bool) -> None:
    """Compare lines x samples with what the standard expects of them."""
    wrong = seen != expected
    if not wrong.any():
        return
    line, sample = np.unravel_index(np.argmax(wrong), wrong.shape)
    level = int(np.broadcast_to(expected, wrong.shape)[line, sample])
    raise VideoError(
        f"line {line}, sample {sample}: {what} is {1 - level}, expected {level}; {wrong.sum()} samples are wrong"
    )
