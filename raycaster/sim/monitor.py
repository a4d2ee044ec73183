# SPDX-License-Identifier: MIT
"""A monitor in Python: takes the bench's lines, checks every sample against the video standard, yields pictures."""

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
from raycaster.golden.picture import WRONG
from raycaster.screens import Screen, Span

CLOCK_NS = 20
"""Period of the bench's clock, for any design; only cycles count here."""

PULSE = (30, 40, 110)
"""Colour of a sync pulse in a `raster`."""

_CONTROL_BITS = 4
"""Bits of a sample before its colour: HS, VS, BLANK_N, SYNC_N."""


class VideoError(AssertionError):
    """A sample that departs from the video standard; says which, and what was expected.

    Attributes:
        picture: the frame with its blanking, uint8 (lines, samples, 3); None if there was no whole frame. See `raster`.
    """

    picture: np.ndarray | None = None


@dataclass(frozen=True)
class Line:
    """Samples from one leading edge of HS to the next."""

    bits: str
    """One character per bit, last sample first; a sample is HS, VS, BLANK_N, SYNC_N, red, green, blue of a pixel."""

    samples: int
    """Number of pixels."""

    end_ns: int
    """Simulation time at which the line ended."""


class Monitor:
    """Collects lines in the background, and makes frames of them."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        """Watch a bench's line sink.

        Args:
            bench: a bench with a `sink`.
            configuration: the design in it.
        """
        self._sink: Any = bench.sink
        self._screen = configuration.screen_geometry
        self._colour_bits = configuration.colour_bits
        self._patience_ns = 3 * self._screen.line_cycles * CLOCK_NS
        self._lines: Queue[Line | None] = Queue()
        self._waiting_since: int | None = None
        self._synchronised = self._rests = False
        self.frame_lines: list[Line] = []
        """The lines of the last frame, from VS's leading edge on."""
        cocotb.start_soon(self._collect())
        cocotb.start_soon(self._watch())

    async def _collect(self) -> None:
        sink = self._sink
        while True:
            await sink.line_event.value_change
            if self._rests:
                continue
            line = Line(str(sink.line.value), int(sink.line_samples.value), int(get_sim_time("ns")))
            self._lines.put_nowait(line)

    async def _watch(self) -> None:
        """Give up on a line that is overdue. A timeout for each line would take as long as simulating the lines."""
        while True:
            await Timer(self._patience_ns, "ns")
            since = self._waiting_since
            if since is not None and get_sim_time("ns") - since >= self._patience_ns:
                self._lines.put_nowait(None)

    def rest(self) -> None:
        """Look at no line until `forget`, as reading them takes long."""
        self._rests = True

    def forget(self) -> None:
        """Drop all that was seen so far and search for VS again, as after a reset."""
        self._rests = False
        while not self._lines.empty():
            self._lines.get_nowait()
        self._synchronised = False

    async def line(self) -> Line:
        """Wait for the next line.

        Raises:
            VideoError: HS did not come within three line times.
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
        """Wait for the next whole frame, from VS's leading edge on; frames follow each other without a gap.

        Args:
            on_row: called after each visible line, with the number of visible lines so far.

        Returns:
            Visible lines x visible pixels x 3, uint8; a channel of fewer than 8 bits is in the top bits.

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
        return decode_frame(lines, self._screen, self._colour_bits)

    async def _first_line(self) -> Line:
        """Return the first line in which VS is active after a line in which it was inactive."""
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
        """Check the faults that the bench counted at every clock.

        Raises:
            VideoError: data changed at a rising edge of VGA_CLK, or VGA_CLK has a wrong waveform.
        """
        unstable = int(self._sink.unstable_samples.value)
        faults = int(self._sink.clock_faults.value)
        if unstable:
            raise VideoError(f"video data changed at {unstable} rising edges of vga_clk")
        if faults:
            raise VideoError(f"vga_clk did not change at {faults} clocks; it must be clk halved, or inverted")


def decode_frame(lines: Sequence[Line], screen: Screen, colour_bits: int) -> np.ndarray:
    """Check every sample of a frame against the standard and return its visible part.

    Args:
        lines: one frame from VS's leading edge on, `screen.vertical.total` lines.
        screen: the standard.
        colour_bits: bits per channel.

    Returns:
        Visible lines x visible pixels x 3, uint8; a channel of fewer than 8 bits is in the top bits, the others are 0.

    Raises:
        VideoError: a sample is wrong; names the line (from VS's leading edge), the sample (from HS's leading edge) and
            what was expected, and has a picture.
    """
    try:
        return _decode(lines, screen, colour_bits)
    except VideoError as error:
        error.picture = raster(lines, screen, colour_bits)
        raise


def raster(lines: Sequence[Line], screen: Screen, colour_bits: int) -> np.ndarray:
    """Draw a frame with its blanking, for people to look at: each wrong sample is pink, a sync's pulse dark blue.

    Args: as in `decode_frame`.

    Returns:
        uint8 (lines, samples, 3), both counted as in the messages of `decode_frame`.
    """
    bits = _samples(lines, screen, colour_bits)
    controls, in_picture = bits[..., :_CONTROL_BITS], _in_picture(screen)
    wrong = (bits > 1).any(axis=-1) | (bits[..., _CONTROL_BITS:].any(axis=-1) & ~in_picture)
    for number, (_, expected, _) in enumerate(_standard(screen)):
        wrong |= controls[..., number] != expected
    pulse = np.zeros_like(wrong)
    for number, span in enumerate((screen.horizontal, screen.vertical)):
        pulse |= controls[..., number] == span.active_high
    picture = _colours(bits & 1, colour_bits)
    picture[pulse & ~in_picture] = PULSE
    picture[wrong] = WRONG
    return picture


def _decode(lines: Sequence[Line], screen: Screen, colour_bits: int) -> np.ndarray:
    horizontal, vertical = screen.horizontal, screen.vertical
    for number, line in enumerate(lines):
        if line.samples != horizontal.total:
            raise VideoError(
                f"line {number}: {line.samples} pixels between leading edges of HS, expected {horizontal.total}"
            )
    bits = _samples(lines, screen, colour_bits)
    if bits.max() > 1:
        unknown = (bits > 1).any(axis=-1)
        line, sample = np.argwhere(unknown)[0]
        raise VideoError(f"line {line}, sample {sample}: an output is neither 0 nor 1, in {unknown.sum()} samples")
    in_picture = _in_picture(screen)
    for number, (what, expected, rule) in enumerate(_standard(screen)):
        _check(what, bits[..., number], expected, rule)
    colours = _colours(bits, colour_bits)
    _check("any colour in blanking", colours.any(axis=-1) & ~in_picture, np.False_, "0")
    return colours[in_picture].reshape(vertical.visible, horizontal.visible, 3)


def _samples(lines: Sequence[Line], screen: Screen, colour_bits: int) -> np.ndarray:
    """Return the bits of a frame's samples, uint8 (lines, samples, bits), in order; more than 1 if unknown or missing.

    A sample's bits are HS, VS, BLANK_N and SYNC_N, then red, green and blue, each from its highest bit on.
    """
    total, sample_bits = screen.horizontal.total, _CONTROL_BITS + 3 * colour_bits
    # A line's characters begin with its last sample; before that are characters of samples that never came.
    kept = (line.bits[len(line.bits) - min(total, line.samples) * sample_bits :] for line in lines)
    texts = (text.rjust(total * sample_bits, "x") for text in kept)
    characters = np.frombuffer("".join(texts).encode(), np.uint8)
    return (characters ^ ord("0")).reshape(len(lines), total, sample_bits)[:, ::-1]


def _standard(screen: Screen) -> list[tuple[str, np.ndarray | np.bool, str]]:
    """List the controls of a sample: their names, values, bool (lines, samples) or broadcast, and rules in words."""
    horizontal, vertical = screen.horizontal, screen.vertical
    column, row = np.arange(horizontal.total), np.arange(vertical.total)[:, None]
    hs, vs = (f"{int(span.active_high)} in {what} 0 to {span.sync - 1} and {int(not span.active_high)} in all others"
        for what, span in (("samples", horizontal), ("lines", vertical)))  # fmt: skip
    return [
        ("HS", (column < horizontal.sync) == horizontal.active_high, hs),
        ("VS", (row < vertical.sync) == vertical.active_high, vs),
        ("BLANK_N", _in_picture(screen), "1 in the picture only"),
        ("SYNC_N", np.False_, "0"),
    ]


def _in_picture(screen: Screen) -> np.ndarray:
    """Bool (lines, samples): the sample is visible."""
    row, column = np.arange(screen.vertical.total)[:, None], np.arange(screen.horizontal.total)
    return _visible(row, screen.vertical) & _visible(column, screen.horizontal)


def _colours(bits: np.ndarray, colour_bits: int) -> np.ndarray:
    """Return the colours of samples, uint8 (lines, samples, 3), from their bits."""
    # Packing along an axis of 8 takes numpy ten times as long as packing everything at once.
    shape = bits.shape[:2]
    channels = np.zeros((*shape, 3, CHANNEL_BITS), np.uint8)
    channels[..., :colour_bits] = bits[..., _CONTROL_BITS:].reshape(*shape, 3, colour_bits)
    return np.packbits(channels).reshape(*shape, 3)


def _visible(position: np.ndarray, span: Span) -> np.ndarray:
    """True for positions, counted from the sync's leading edge, that are in the picture."""
    start = span.sync + span.back
    return (position >= start) & (position < start + span.visible)


def _check(what: str, seen: np.ndarray, expected: np.ndarray | np.bool, rule: str) -> None:
    """Compare lines x samples with what the standard expects; the rule says the same in words."""
    wrong = seen != expected
    if not wrong.any():
        return
    line, sample = np.unravel_index(np.argmax(wrong), wrong.shape)
    level = int(np.broadcast_to(expected, wrong.shape)[line, sample])
    (top, left), (bottom, right) = (ends(np.argwhere(wrong), axis=0) for ends in (np.min, np.max))
    raise VideoError(
        f"line {line}, sample {sample}: {what} is {1 - level}, expected {level}; {wrong.sum()} samples are wrong, in "
        f"lines {top} to {bottom} and samples {left} to {right} (counted from the leading edges of VS and HS); "
        f"{what} must be {rule}"
    )
