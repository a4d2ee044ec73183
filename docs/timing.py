# SPDX-License-Identifier: MIT
"""Timing diagrams, drawn from a simulation of the converted Verilog: WaveJSON, which WaveDrom renders.

The design is small, and its frame is compared with the golden model before it is drawn. Omitted cycles appear as a gap;
the lane `cycle` shows their number.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from pathlib import Path
from string import ascii_uppercase
from typing import Any

import wavedrom

from raycaster.configuration import Configuration, configure
from raycaster.debug.probes.ray import fields
from raycaster.debug.waves import Waves, signed
from raycaster.errors import UserError
from raycaster.hdl.records import Record
from raycaster.options import command_line
from raycaster.rtl.common.records import Origin, Ray
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

RENDERER = "bench.dut.ray_caster_renderer_i."
CASTER = RENDERER + "ray_caster_i."
VIDEO = RENDERER + "video_generator_i."
UNIT = CASTER + "ray_unit_0_i."


@dataclass(frozen=True)
class Lane:
    """A line of a diagram: its signals, and the text for their values."""

    name: str
    signals: tuple[str, ...]
    text: Callable[..., str] | None = None
    """Formatter of the values; None for a single signal of one bit."""

    is_signed: bool = False


@dataclass(frozen=True)
class Arrow:
    """An arrow from a rising edge of one lane to one of another, labelled with the cycles between them.

    Edges are counted from 0.
    """

    start: str
    start_edge: int
    end: str
    end_edge: int


@dataclass(frozen=True)
class Diagram:
    """A drawing: groups of lanes, and the first cycle and the end of each drawn range of cycles."""

    name: str
    groups: dict[str, Sequence[Lane]]
    windows: Callable[[Frame], list[tuple[int, int]]]
    arrows: Sequence[Arrow] = ()


class Frame:
    """The first frame with a live scene; its cycles are counted from StartScreen."""

    def __init__(self, waves: Waves, configuration: Configuration):
        self._waves = waves
        self._groups = configuration.groups
        samples = waves.sample([VIDEO + "scan_start_screen", RENDERER + "picture_run"])
        starts = [i for i, value in enumerate(samples.values[VIDEO + "scan_start_screen"]) if value]
        # Committed registers go live at StartScreen, and change in the cycle after it.
        live = [i for i in starts if samples.values[RENDERER + "picture_run"][i + 1]]
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

    def strobe(self, signal: str, number: int) -> int:
        """Return the cycle of a strobe by its number, counted from 0."""
        cycles = [i - 1 for i, value in enumerate(self.values(signal)) if value]
        if number >= len(cycles):
            raise UserError(f"{self._waves.path}: {signal} is high {len(cycles)} times in a frame, not {number + 1}")
        return cycles[number]

    def done(self, row: int, group: int) -> int:
        """Return the cycle in which a group of pixels is complete; negative groups count from the end of the row."""
        return self.strobe(RENDERER + "done", row * self._groups + group % self._groups)

    def texts(self, lane: Lane, cycles: range) -> list[str]:
        """Return the text of a lane for each cycle, "x" if a bit is unknown."""
        columns = [self.values(signal, lane.is_signed)[cycles.start + 1 : cycles.stop + 1] for signal in lane.signals]
        show = lane.text or str
        return ["x" if None in values else show(*values) for values in zip(*columns, strict=True)]


def _bits(prefix: str, *names: str) -> list[Lane]:
    """Return lanes for signals of one bit."""
    return [Lane(name, (prefix + name,)) for name in names]


def _strobes(*names: str) -> list[Lane]:
    """Return lanes for strobes of the scan."""
    return [Lane(name, (f"{VIDEO}scan_{name}",)) for name in names]


def _number(prefix: str, name: str, is_signed: bool = False) -> Lane:
    return Lane(name, (prefix + name,), str, is_signed)


def _colour(prefix: str, name: str) -> Lane:
    return Lane(name, (prefix + name,), "#{:06x}".format)


def _word(name: str) -> Lane:
    """Return a lane for a unit's colour record."""
    return Lane(name, (f"{UNIT}{name}_word",), "#{:06x}".format)


def _place(name: str) -> Lane:
    """Return a lane for a coordinate of the group."""
    return Lane(name, (f"{RENDERER}place_{name}",), str)


def _point(name: str, record: str, layout: Record) -> Lane:
    """Return a lane for the coordinates in one of a unit's records."""
    return Lane(name, fields(UNIT.rstrip("."), record, "xyz", layout), "{} {} {}".format)


def _slope() -> Lane:
    """Return a lane for the slope of the traced ray, from its magnitudes and signs."""
    components = ("dx", "dy", "dz")
    unit = UNIT.rstrip(".")
    signals = (*fields(unit, "slope", components), *fields(unit, "ray", components, Ray(CONFIGURATION)))

    def text(x: int, y: int, z: int, *negative: int) -> str:
        return " ".join(f"{'-' if sign else ''}{size}" for size, sign in zip((x, y, z), negative, strict=True))

    return Lane("slope", signals, text)


def _followed(frame: Frame) -> list[tuple[int, int]]:
    """Return the range from the end of the group before the followed one to the end of the followed one."""
    return [(frame.done(ROW, GROUP - 1), frame.done(ROW, GROUP) + 5)]


STEPS = CASTER + "steps_"
DIAGRAMS = (
    Diagram(
        "video_and_counters",
        {
            "video": [_number(VIDEO, "y", is_signed=True), *_strobes("start_screen", "start_row")],
            "counters": [
                _place("row"), *_bits(RENDERER, "line_buf_sel"), _place("column_offset"),
            ],
            "caster": _bits(RENDERER, "enable", "done"),
        },
        lambda frame: [
            (cycle - 1, cycle + 5)
            for cycle in (
                frame.strobe(VIDEO + "scan_start_screen", 0), frame.done(0, 0), frame.done(0, 1), frame.done(0, -1),
                frame.strobe(VIDEO + "scan_start_row", 0), frame.done(1, 0),
            )
        ],
        [Arrow("start_screen", 0, "start_row", 0)],
    ),
    Diagram(
        "enable_and_reset",
        {
            "renderer": [
                *_bits(RENDERER, "done", "restart", "reset_delay", "reset_ray_caster"),
                _place("column_offset"), *_bits(RENDERER, "enable"), *_bits(STEPS, "screen_to_ray"),
            ],
        },
        lambda frame: [(cycle - 2, cycle + 8) for cycle in (frame.done(0, 0), frame.done(0, -1))],
        [Arrow("done", 0, "screen_to_ray", 0)],
    ),
    Diagram(
        "renderer_and_ray_unit",
        {
            "renderer": [
                *_bits(RENDERER, "reset_ray_caster", "enable"), _place("row"), _place("column_offset"),
            ],
            "ray_unit": [*_bits(STEPS, "screen_to_ray"), _slope(), _word("pixel")],
            "buffer": [
                *_bits(RENDERER, "done", "line_buf_sel"), _number(RENDERER + "line_buffer_0_i.", "write_address"),
            ],
        },
        lambda frame: [
            (frame.done(ROW, GROUP - 1) - 3, frame.done(ROW, GROUP - 1) + 12),
            (frame.done(ROW, GROUP) - 6, frame.done(ROW, GROUP) + 10),
        ],
        [Arrow("done", 0, "done", 1)],
    ),
    Diagram(
        "ray_control_and_ray_unit",
        {
            "memory": [*_bits(CASTER, "rects_fetch"), _number(CASTER, "rects_index")],
            "ray_control": [
                *_bits(RENDERER, "reset_ray_caster"),
                *_bits(STEPS, "screen_to_ray", "initial_ray", "reset_colour", "reset_z_buf", "find_intersection"),
                *_bits(STEPS, "load_divider", "store_quotient", "write_z_buf", "add_colour", "store_ray"),
                *_bits(RENDERER, "done"),
            ],
        },
        _followed,
        [
            Arrow("find_intersection", 0, "load_divider", 0), Arrow("load_divider", 0, "store_quotient", 0),
            Arrow("store_quotient", 0, "write_z_buf", 0), Arrow("find_intersection", 0, "find_intersection", 1),
            Arrow("screen_to_ray", 0, "add_colour", 0), Arrow("add_colour", 0, "add_colour", 1),
        ],
    ),
    Diagram(
        "ray_unit_and_output",
        {
            "ray": [_point("origin", "ray", Ray(CONFIGURATION)), _slope()],
            "intersection": [
                *_bits(STEPS, "find_intersection"), *_bits(UNIT, "hit"), _number(UNIT, "depth"),
            ],
            "z_buffer": [
                *_bits(STEPS, "reset_z_buf", "write_z_buf"), *_bits(UNIT, "found"), _colour(UNIT, "found_colour"),
                _point("found_point", "found_point", Origin(CONFIGURATION)),
            ],
            "output": [*_bits(STEPS, "add_colour"), _word("pixel"), *_bits(RENDERER, "done")],
        },
        _followed,
    ),
)  # fmt: skip


def simulate(build: Path, verilog: Sequence[Path] | None = None) -> Iterator[tuple[str, str]]:
    """Simulate the design and draw each diagram.

    Args:
        build: the directory that holds `model/`.
        verilog: as for `build_model`.

    Yields:
        A diagram's name, and its WaveJSON.

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
    texts: dict[str, dict[int, str]] = {}
    lanes = list(chain.from_iterable(diagram.groups.values()))
    for start, end in diagram.windows(frame):
        cycles = range(start, end)
        seen = {lane.name: dict(zip(cycles, frame.texts(lane, cycles), strict=True)) for lane in lanes}
        columns += [*([None] if columns else []), *cycles]
        for name, values in seen.items():
            texts.setdefault(name, {}).update(values)
    nodes, edges = _place_arrows(diagram.arrows, columns, texts)

    def draw(lane: Lane) -> dict[str, Any]:
        drawn = _wave(
            lane.name, [None if cycle is None else texts[lane.name][cycle] for cycle in columns], bool(lane.text)
        )
        return drawn | ({"node": nodes[lane.name]} if lane.name in nodes else {})

    clock = "".join("|" if cycle is None else "." for cycle in columns)
    signals = [{"name": "clk", "wave": "p" + clock[1:]}, _count(columns), {}]
    lines = [*map(json.dumps, signals)]
    for name, group in diagram.groups.items():
        members = ",\n    ".join(json.dumps(draw(lane)) for lane in group)
        lines.append(f"[{json.dumps(name)},\n    {members}\n  ]")
    signal = ",\n  ".join(lines)
    return f'{{"signal": [\n  {signal}\n],\n"edge": {json.dumps(edges)},\n"config": {{"skin": "narrow"}}}}\n'


def _wave(name: str, texts: Sequence[str | None], has_data: bool) -> dict[str, Any]:
    """Return a lane as WaveJSON; a text of None is a gap."""
    wave, data = "", []
    before = None
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
    wave = "".join(
        "|" if cycle is None else "2" if i == 0 or columns[i - 1] is None else "." for i, cycle in enumerate(columns)
    )
    data = [str(columns[i]) for i, symbol in enumerate(wave) if symbol == "2"]
    return {"name": "cycle", "wave": wave, "data": data}


def _place_arrows(
    arrows: Sequence[Arrow], columns: Sequence[int | None], texts: dict[str, dict[int, str]]
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

    for arrow in arrows:
        ends = [
            (name, column(name, edge)) for name, edge in ((arrow.start, arrow.start_edge), (arrow.end, arrow.end_edge))
        ]
        for end in ends:
            letters.setdefault(end, ascii_uppercase[len(letters)])
        start, end = (letters[end] for end in ends)
        edges.append(f"{start}~>{end} {cycles[ends[1][1]] - cycles[ends[0][1]]}")
    nodes = {name: "".join(letters.get((name, i), ".") for i in range(len(columns))).rstrip(".") for name, _ in letters}
    return nodes, edges


def render(source: str, path: Path) -> None:
    """Draw WaveJSON as an SVG."""
    drawing: Any = wavedrom.render(source)
    drawing.saveas(str(path))


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


def measured(diagram: Diagram, source: str) -> list[tuple[str, str, int]]:
    """Return the arrows of a drawing: start lane, end lane, and the cycles between them."""
    edges = json.loads(source)["edge"]
    return [(arrow.start, arrow.end, int(edge.split()[1])) for arrow, edge in zip(diagram.arrows, edges, strict=True)]
