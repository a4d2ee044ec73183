# SPDX-License-Identifier: MIT
"""Write a viewer's files for a waveform: GTKWave's save file, and the names of states for it."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from vcd.gtkw import GTKWFlag, GTKWSave, make_translation_filter

from raycaster.debug.probes import module_of
from raycaster.debug.waves import RANGE, Waves
from raycaster.errors import UserError

GTKWAVE_FILE = "view.gtkw"

FORMATS = {"": "dec", "signed": "signed", "hex": "hex"}
"""GTKWave's names of number formats, by the suffix of a signal's name."""

WINDOW_SIZE = 1500, 1000
NAMES_WIDTH = 360
WAVES_WIDTH = 1050
"""Sizes in pixels of GTKWave's window, of its names, and roughly of its waveforms."""

PIXELS_A_FRAME = 200
"""Pixels that span 2^zoom units of time in GTKWave."""


@dataclass(frozen=True)
class View:
    """Contents of a viewer's window.

    Attributes:
        groups: signals by group; see `raycaster.debug.probes.ray.Description`.
        states: names of an enumerated signal's values, by module and signal.
        cursor_ns: time of the cursor, where the visible time begins.
        end_ns: end of the time that is visible at first.
    """

    groups: Mapping[str, Sequence[str]]
    states: Mapping[tuple[str, str], Mapping[int, str]]
    cursor_ns: float
    end_ns: float


def write_files(waves: Waves, view: View) -> Path:
    """Write all files next to a waveform, each atomically; return the one that GTKWave opens.

    Raises:
        UserError: the waveform lacks a signal.
    """
    directory = waves.path.resolve().parent
    filters = {place: directory / f"{'.'.join(place)}.txt" for place in view.states}
    # Before the first file is written, as a signal may be missing.
    text = _gtkwave(waves, view, filters)
    for place, names in view.states.items():
        bits = max(names).bit_length()
        _write(filters[place], make_translation_filter(list(names.items()), "bin", bits) + "\n")
    return _write(directory / GTKWAVE_FILE, text)


def _write(path: Path, text: str) -> Path:
    partial = path.with_name(f".{path.name}.partial")
    partial.write_text(text)
    return partial.replace(path)


def _parts(name: str) -> tuple[str, str, tuple[str, str]]:
    """Split a name into the signal's full name, its number format, and its module and own name."""
    signal, _, kind = name.rpartition(":")
    # The last colon may be that of a range of bits.
    if not signal or kind.endswith("]"):
        signal, kind = name, ""
    if kind not in FORMATS:
        raise UserError(f"{name}: unknown number format: {kind}")
    return signal, kind, (module_of(signal), signal.rpartition(".")[2])


def _gtkwave(waves: Waves, view: View, filters: Mapping[tuple[str, str], Path]) -> str:
    text = io.StringIO()
    save = GTKWSave(text)
    save.dumpfile(str(waves.path.resolve()))
    # GTKWave counts single units of time even if a tick of the file is 10 or 100 of them.
    begin, end = (waves.ticks(time) * waves.tick_units for time in (view.cursor_ns, view.end_ns))
    zoom = math.log2(max(1, end - begin) * 1.2 / WAVES_WIDTH * PIXELS_A_FRAME)
    save.timestart(begin - (end - begin) // 20)
    save.size(*WINDOW_SIZE)
    save.zoom_markers(-zoom, begin)
    save.signals_width(NAMES_WIDTH)
    save.sst_expanded(False)
    labels = iter(_labels([_parts(name)[0] for names in view.groups.values() for name in names]))
    for group, names in view.groups.items():
        with save.group(group):
            for name in names:
                label = next(labels)
                signal, kind, place = _parts(name)
                width = waves.width(signal)
                if RANGE.fullmatch(signal):
                    signal, high, low = waves.bits(signal)
                    count = waves.width(signal)
                    # GTKWave numbers a signal's bits from the left.
                    bits = " ".join(f"({count - 1 - bit}){signal}[{count - 1}:0]" for bit in range(high, low - 1, -1))
                    shown = FORMATS[kind] if width > 1 else "bin"
                    # As trace_combined of pyvcd 0.5 writes it; Amaranth 0.5 needs an older pyvcd.
                    with save.trace_bits(f"#{{{label}}} {bits}", datafmt=shown, extraflags=GTKWFlag.grp_begin):
                        continue
                whole = f"{signal}[{width - 1}:0]" if width > 1 else signal
                if place in filters:
                    save.trace(whole, label, datafmt="bin", translate_filter_file=str(filters[place]))
                else:
                    save.trace(whole, label, datafmt=FORMATS[kind] if width > 1 else "bin")
    return text.getvalue()


def _labels(signals: Sequence[str]) -> list[str]:
    """Shorten names as far as they stay distinct; like names get an instance in front.

    GTKWave shows only what follows the last dot, so labels have no dots.
    """
    labels = []
    for signal in signals:
        path = [part.removesuffix("_i") for part in signal.split(".")]
        ends = [other for other in signals if other.endswith(f".{path[-1]}")]
        depth = next((n for n in range(1, len(path)) if len({end.split(".")[-n] for end in ends}) == len(ends)), 1)
        labels.append(":".join([path[-depth], path[-1]] if depth > 1 else path[-1:]))
    return labels
