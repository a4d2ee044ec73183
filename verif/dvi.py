# SPDX-License-Identifier: MIT
"""A DVI monitor in Python: from what a simulated board sends to pictures, everything held against the standard."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from raycaster.configuration import Screen
from raycaster.golden.tmds import CONTROL_SYMBOLS, decode
from raycaster.verif.monitor import Line, VideoError, decode_frame
from raycaster.verif.simulator import SimulationError, find_tool

SYMBOL_BITS = 10
HERE = Path(__file__).parent
BENCH, MODELS = HERE / "dvi_bench.v", HERE / "ecp5_models.v"
_CHANNELS = ("blue", "green", "red", "clock")


def record(sources: Sequence[Path], bits: int, directory: Path) -> np.ndarray:
    """Simulate the board in Verilator and record its DVI connector.

    Args:
        sources: the board's Verilog, the design's included.
        bits: bit times to record, from some time in reset on.
        directory: for the model and the recording.

    Returns:
        bool (4, bits): blue, green, red and clock.

    Raises:
        SimulationError: the simulation could not be built or run.
    """
    tool = find_tool("verilator")
    directory.mkdir(parents=True, exist_ok=True)
    files = [str(path.resolve()) for path in (*sources, MODELS, BENCH)]
    command = [
        "verilator", "--binary", "--timing", "-Wno-fatal", "-O3", "--top-module", "dvi_bench", f"-GBITS={bits}",
        "--output-split", "20000", "-CFLAGS", "-fcoroutines -std=gnu++20 -O2", "-j", "2", "-Mdir", "model", *files,
    ]  # fmt: skip
    for stage, call in (("built", command), ("run", ["model/Vdvi_bench"])):
        done = subprocess.run(
            call, cwd=directory, env=os.environ | dict(tool.environment), capture_output=True, text=True, check=False
        )
        if done.returncode:
            (directory / "dvi.log").write_text(done.stdout + done.stderr)
            raise SimulationError(f"the board could not be {stage}; the log is {directory / 'dvi.log'}")
    digits = np.frombuffer((directory / "gpdi.txt").read_bytes(), np.uint8)
    shutil.rmtree(directory / "model")
    values = np.where(digits > ord("9"), digits - ord("a") + 10, digits - ord("0")).astype(np.uint8)
    return np.stack([values >> channel & 1 for channel in range(len(_CHANNELS))]).astype(bool)


def symbols(wires: np.ndarray) -> np.ndarray:
    """Cut wires into symbols, where the three channels' control symbols say.

    Args:
        wires: bool (4, bits), from some time on at which the link runs.

    Returns:
        int64 (3, pixels): blue, green, red; bit 0 was sent first.

    Raises:
        VideoError: the channels have no common place to cut, or the link's clock is not a tenth of the bits' rate.
    """
    starts = [_alignment(wires[channel]) for channel in range(3)]
    if len(set(starts)) != 1:
        raise VideoError(f"the channels' symbols start at different bits: {', '.join(map(str, starts))}")
    whole = (wires.shape[1] - starts[0]) // SYMBOL_BITS * SYMBOL_BITS
    cut = wires[:, starts[0] : starts[0] + whole].reshape(len(_CHANNELS), -1, SYMBOL_BITS)
    if (cut[3] != (np.arange(SYMBOL_BITS) < SYMBOL_BITS // 2)).any():
        raise VideoError("the link's clock is not five ones and five zeros a symbol")
    return cut[:3] @ (1 << np.arange(SYMBOL_BITS))


def _alignment(wire: np.ndarray) -> int:
    """The only place, 0 to 9, from which control symbols are found one right after the other."""
    found = []
    for start in range(SYMBOL_BITS):
        whole = (len(wire) - start) // SYMBOL_BITS * SYMBOL_BITS
        words = wire[start : start + whole].reshape(-1, SYMBOL_BITS) @ (1 << np.arange(SYMBOL_BITS))
        control = np.isin(words, CONTROL_SYMBOLS)
        if (control[1:] & control[:-1]).mean() > 0.05:
            found.append(start)
    if len(found) != 1:
        raise VideoError(f"control symbols are found from {len(found)} places on, expected 1")
    return found[0]


def pictures(words: np.ndarray, screen: Screen) -> list[np.ndarray]:
    """Decode symbols, hold every pixel's syncs and blanking against the standard, and return all whole frames.

    Args:
        words: of `symbols`.
        screen: the standard.

    Returns:
        Of each frame uint8 (visible lines, visible pixels, 3).

    Raises:
        VideoError: a symbol that stands for nothing, channels that disagree, or a departure from the standard.
    """
    table = np.full((1 << SYMBOL_BITS, 3), -1, dtype=np.int64)
    for symbol in range(1 << SYMBOL_BITS):
        try:
            table[symbol] = decode(symbol)
        except ValueError:
            continue
    visible, data, control = np.moveaxis(table[words], -1, 0)
    if (visible < 0).any():
        channel, pixel = np.argwhere(visible < 0)[0]
        raise VideoError(f"{_CHANNELS[channel]}, pixel {pixel}: {words[channel, pixel]:010b} is no symbol")
    if (visible != visible[0]).any():
        raise VideoError("the channels are not in blanking together")
    if control[1:].any():
        raise VideoError("green or red carries control bits")
    hs, vs = _held(control[0] & 1, visible[0]), _held(control[0] >> 1, visible[0])
    samples = np.stack([hs, vs, visible[0], np.zeros_like(hs)])
    colours = np.unpackbits(data[::-1].astype(np.uint8)[..., None], axis=-1)  # red, green, blue
    bits = np.concatenate([samples.T, np.moveaxis(colours, 0, 1).reshape(len(hs), -1)], axis=1)
    line_starts = _leading_edges(hs, screen.horizontal.active_high)
    frame_starts = _leading_edges(vs, screen.vertical.active_high)
    lines = [_line(bits[start:end]) for start, end in pairwise(line_starts)]
    found = []
    for start in frame_starts:
        [first] = np.flatnonzero(line_starts == start)
        frame = lines[first : first + screen.vertical.total]
        if len(frame) == screen.vertical.total:
            found.append(decode_frame(frame, screen, 8))
    return found


def _held(levels: np.ndarray, visible: np.ndarray) -> np.ndarray:
    """A sync where it is sent, and its last level where a picture is sent instead."""
    last = np.maximum.accumulate(np.where(visible == 0, np.arange(len(levels)), 0))
    return levels[last]


def _leading_edges(levels: np.ndarray, active_high: bool) -> np.ndarray:
    active = levels == int(active_high)
    return np.flatnonzero(active[1:] & ~active[:-1]) + 1


def _line(bits: np.ndarray) -> Line:
    """As the bench of the VGA output hands lines over: the last sample first."""
    return Line("".join(map(str, bits[::-1].reshape(-1))), len(bits), 0)
