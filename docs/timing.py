# SPDX-License-Identifier: MIT
"""Timing diagrams, drawn from a simulation of the converted Verilog: WaveJSON, which WaveDrom renders.

The design is small, and its frame is compared with the golden model before it is drawn. Omitted cycles appear as a gap;
the lane `cycle` shows their number.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from pathlib import Path
from string import ascii_uppercase
from typing import Any

from raycaster.configuration import Configuration
from raycaster.debug.probes.engines import description_of
from raycaster.debug.waves import Waves, signed
from raycaster.design.decide import configure
from raycaster.design.options import command_line
from raycaster.errors import UserError
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, run_bench

HERE = Path(__file__).parent
SOURCES = HERE / "timing"
"""Directory of the stored drawings, as WaveJSON."""

SCENE = HERE / "three_rectangles.toml"
CONFIGURATION = configure(screen="tiny", units=8, rectangles=3, reflections=1, culling=False)
"""Configuration of the simulated design: few units, and three rectangles that all rays test."""

ROW, GROUP = 44, 6
"""Row and group of the followed rays: the first ray hits wall and post, and its reflection hits the wall."""

SEED = description_of(CONFIGURATION, 0)
"""Description of the signals of the first unit."""


@dataclass(frozen=True)
class Lane:
    """A line of a diagram: its name, its signals by their names in the description, and the text for their values.

    The default signal is the one with the lane's own name.
    """

    name: str
    of: tuple[str, ...] = ()
    text: Callable[..., str] = str
    is_signed: bool = False

    @property
    def signals(self) -> tuple[str, ...]:
        """Full names of the signals."""
        return tuple(chain.from_iterable(map(SEED.signals, self.of or (self.name,))))


@dataclass(frozen=True)
class Diagram:
    """A drawing: groups of lanes, the first cycle and the end of each drawn range of cycles, and arrows.

    An arrow runs from a rising edge of one lane to one of another, labelled with the cycles between them: lane, number
    of the edge, counted from 0, and the same for its end.
    """

    name: str
    groups: Mapping[str, str]
    windows: Callable[[Frame], list[tuple[int, int]]]
    arrows: Sequence[tuple[str, int, str, int]] = ()

    def lanes(self, group: str) -> list[Lane]:
        """Return the lanes of a group."""
        return [LANES.get(name) or Lane(PREFIX.sub("", name), (name,)) for name in self.groups[group].split()]


class Frame:
    """The first frame with a live scene; its cycles are counted from StartScreen."""

    def __init__(self, waves: Waves, configuration: Configuration):
        self._waves = waves
        self._groups = configuration.groups
        start_screen, run = (SEED.signals(name)[0] for name in ("scan_start_screen", "picture_run"))
        samples = waves.sample([start_screen, run])
        starts = [i for i, value in enumerate(samples.values[start_screen]) if value]
        # Committed registers go live at StartScreen, and change in the cycle after it.
        live = [i for i in starts if samples.values[run][i + 1]]
        if not live:
            raise UserError(f"{waves.path}: expected a frame with a live scene, got none")
        self._start_ns = samples.times_ns[live[0] - 1]
        self._values: dict[str, list[int | None]] = {}

    def values(self, signal: str, is_signed: bool = False) -> list[int | None]:
        """Return the values of a signal, from the cycle before StartScreen on."""
        if signal not in self._values:
            self._values[signal] = self._waves.sample([signal], self._start_ns).values[signal]
        values = self._values[signal]
        return [signed(value, self._waves.width(signal)) for value in values] if is_signed else values

    def has_data(self, lane: Lane) -> bool:
        """True if a lane shows texts, instead of the level of a signal of one bit."""
        return sum(map(self._waves.width, lane.signals)) > 1

    def strobe(self, name: str, number: int) -> int:
        """Return the cycle of a strobe by its number, counted from 0."""
        (signal,) = SEED.signals(name)
        cycles = [i - 1 for i, value in enumerate(self.values(signal)) if value]
        if number >= len(cycles):
            raise UserError(f"{self._waves.path}: {signal} is high {len(cycles)} times in a frame, not {number + 1}")
        return cycles[number]

    def done(self, row: int, group: int) -> int:
        """Return the cycle in which a group of pixels is complete; negative groups count from the end of the row."""
        return self.strobe("done", row * self._groups + group % self._groups)

    def texts(self, lane: Lane, cycles: range) -> list[str]:
        """Return the text of a lane for each cycle, "x" if a bit is unknown."""
        columns = [self.values(signal, lane.is_signed)[cycles.start + 1 : cycles.stop + 1] for signal in lane.signals]
        return ["x" if None in values else lane.text(*values) for values in zip(*columns, strict=True)]


def _slope(x: int, y: int, z: int, *negative: int) -> str:
    """Format the slope of the traced ray, from its magnitudes and signs."""
    return " ".join(f"{'-' if sign else ''}{size}" for size, sign in zip((x, y, z), negative, strict=True))


def _followed(frame: Frame) -> list[tuple[int, int]]:
    """Return the range from the end of the group before the followed one to the end of the followed one."""
    return [(frame.done(ROW, GROUP - 1), frame.done(ROW, GROUP) + 5)]


PREFIX = re.compile("^(steps|scan|place)_")
"""Beginnings of signals that lanes omit."""

LANES = {
    lane.name: lane
    for lane in (
        Lane("y", is_signed=True),
        Lane("slope", ("slope, magnitudes", "signs"), _slope),
        Lane("origin", text="{} {} {}".format),
        Lane("hit", ("inside",)),
        Lane("found_colour", ("its colour",), "#{:06x}".format),
        Lane("found_point", ("nearest point",), "{} {} {}".format),
        Lane("pixel", text="#{:06x}".format),
    )
}
"""Lanes of quantities and of signed numbers; others are signals of the control."""

DIAGRAMS = (
    Diagram(
        "video_and_counters",
        {
            "video": "y scan_start_screen scan_start_row",
            "counters": "place_row line_buf_sel place_column_offset",
            "caster": "enable done",
        },
        lambda frame: [
            (cycle - 1, cycle + 5)
            for cycle in (
                frame.strobe("scan_start_screen", 0), frame.done(0, 0), frame.done(0, 1), frame.done(0, -1),
                frame.strobe("scan_start_row", 0), frame.done(1, 0),
            )
        ],
        [("start_screen", 0, "start_row", 0)],
    ),
    Diagram(
        "enable_and_reset",
        {"renderer": "done restart reset_delay reset_ray_caster place_column_offset enable steps_screen_to_ray"},
        lambda frame: [(cycle - 2, cycle + 8) for cycle in (frame.done(0, 0), frame.done(0, -1))],
        [("done", 0, "screen_to_ray", 0)],
    ),
    Diagram(
        "renderer_and_ray_unit",
        {
            "renderer": "reset_ray_caster enable place_row place_column_offset",
            "ray_unit": "steps_screen_to_ray slope pixel",
            "buffer": "done line_buf_sel write_address",
        },
        lambda frame: [
            (frame.done(ROW, GROUP - 1) - 3, frame.done(ROW, GROUP - 1) + 12),
            (frame.done(ROW, GROUP) - 6, frame.done(ROW, GROUP) + 10),
        ],
        [("done", 0, "done", 1)],
    ),
    Diagram(
        "ray_control_and_ray_unit",
        {
            "memory": "rects_fetch rects_index",
            "ray_control": "reset_ray_caster steps_screen_to_ray steps_initial_ray steps_reset_colour "
            "steps_reset_z_buf steps_find_intersection steps_load_divider steps_store_quotient steps_write_z_buf "
            "steps_add_colour steps_store_ray done",
        },
        _followed,
        [
            ("find_intersection", 0, "load_divider", 0), ("load_divider", 0, "store_quotient", 0),
            ("store_quotient", 0, "write_z_buf", 0), ("find_intersection", 0, "find_intersection", 1),
            ("screen_to_ray", 0, "add_colour", 0), ("add_colour", 0, "add_colour", 1),
        ],
    ),
    Diagram(
        "ray_unit_and_output",
        {
            "ray": "origin slope",
            "intersection": "steps_find_intersection hit depth",
            "z_buffer": "steps_reset_z_buf steps_write_z_buf found found_colour found_point",
            "output": "steps_add_colour pixel done",
        },
        _followed,
    ),
)  # fmt: skip


def simulate(build: Path, verilog: Sequence[Path] | None = None) -> Iterator[tuple[str, str]]:
    """Simulate the design and yield each diagram's name and WaveJSON; the arguments are those of `build_model`.

    Raises:
        UserError: Icarus Verilog is missing, or an event of a diagram no longer occurs in the simulation.
        SimulationError: the design's picture is wrong.
    """
    model = build_model(CONFIGURATION, "icarus", waves=True, build=build, verilog=verilog)
    with tempfile.TemporaryDirectory(dir=build, prefix=".timing-") as scratch:
        job = Job(CONFIGURATION, scene=str(SCENE.resolve()), output=str(Path(scratch).resolve()))
        waves = run_bench(model, "raycaster.sim.frame_bench", job, Path(scratch))
        if waves is None:
            raise ValueError("the model writes no waveform")
        frame = Frame(Waves(waves), CONFIGURATION)
        for diagram in DIAGRAMS:
            yield diagram.name, wave_json(diagram, frame)


def wave_json(diagram: Diagram, frame: Frame) -> str:
    """Return a diagram as WaveJSON, one lane per line."""
    columns: list[int | None] = []  # None marks a gap
    texts: dict[str, dict[int, str]] = defaultdict(dict)
    lanes = list(chain.from_iterable(map(diagram.lanes, diagram.groups)))
    for start, end in diagram.windows(frame):
        cycles = range(start, end)
        columns += [*([None] if columns else []), *cycles]
        for lane in lanes:
            texts[lane.name].update(zip(cycles, frame.texts(lane, cycles), strict=True))
    nodes, edges = _place_arrows(diagram.arrows, columns, texts)

    def draw(lane: Lane) -> dict[str, Any]:
        shown = [None if cycle is None else texts[lane.name][cycle] for cycle in columns]
        drawn = _wave(lane.name, shown, frame.has_data(lane))
        return drawn | ({"node": nodes[lane.name]} if lane.name in nodes else {})

    clock = "".join("|" if cycle is None else "." for cycle in columns)
    signals = [{"name": "clk", "wave": "p" + clock[1:]}, _count(columns), {}]
    lines = [*map(json.dumps, signals)]
    for name in diagram.groups:
        members = ",\n    ".join(json.dumps(draw(lane)) for lane in diagram.lanes(name))
        lines.append(f"[{json.dumps(name)},\n    {members}\n  ]")
    signal = ",\n  ".join(lines)
    return f'{{"signal": [\n  {signal}\n],\n"edge": {json.dumps(edges)},\n"config": {{"skin": "narrow"}}}}\n'


def _wave(name: str, texts: Sequence[str | None], has_data: bool) -> dict[str, Any]:
    """Return a lane as WaveJSON; a text of None is a gap."""
    wave, data, before = "", [], None
    for text in texts:
        if text is None:
            wave += "|"
            continue
        if text == before:
            wave += "."
        elif text == "x" or not has_data:
            wave += text
        else:
            wave += "5"
            data.append(text)
        before = text
    return {"name": name, "wave": wave} | ({"data": data} if data else {})


def _count(columns: Sequence[int | None]) -> dict[str, Any]:
    """Return the lane that numbers the first cycle, and the first cycle after each gap."""
    pairs = pairwise([None, *columns])
    wave = "".join("|" if cycle is None else "2" if before is None else "." for before, cycle in pairs)
    data = [str(cycle) for cycle, symbol in zip(columns, wave, strict=True) if symbol == "2"]
    return {"name": "cycle", "wave": wave, "data": data}


def _place_arrows(
    arrows: Sequence[tuple[str, int, str, int]], columns: Sequence[int | None], texts: dict[str, dict[int, str]]
) -> tuple[dict[str, str], list[str]]:
    """Return the nodes of each lane and the arrows between them, in WaveDrom's notation."""
    letters: dict[tuple[str, int], str] = {}
    edges = []
    cycles = {i: cycle for i, cycle in enumerate(columns) if cycle is not None}

    def column(name: str, number: int) -> int:
        drawn = [(i, texts[name][cycle]) for i, cycle in cycles.items()]
        rising = [i for (_, before), (i, text) in pairwise(drawn) if (before, text) == ("0", "1")]
        if number >= len(rising):
            raise UserError(f"{name} rises {len(rising)} times in the diagram, not {number + 1}")
        return rising[number]

    for first, first_edge, last, last_edge in arrows:
        ends = [(first, column(first, first_edge)), (last, column(last, last_edge))]
        for end in ends:
            letters.setdefault(end, ascii_uppercase[len(letters)])
        start, end = (letters[end] for end in ends)
        edges.append(f"{start}~>{end} {cycles[ends[1][1]] - cycles[ends[0][1]]}")
    nodes = {name: "".join(letters.get((name, i), ".") for i in range(len(columns))).rstrip(".") for name, _ in letters}
    return nodes, edges


def kept(name: str) -> str:
    """Return the stored drawing of this name.

    Raises:
        UserError: it cannot be read.
    """
    path = SOURCES / f"{name}.json"
    try:
        return path.read_text()
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}; {command_line('docs')} draws it") from None
