# SPDX-License-Identifier: MIT
"""Probes for the span engine: the steps in which a unit draws the pixel's row, and the run's way to the pins.

The model takes the steps of the hardware in its order, so the first chain, span or cell that the hardware finds for the
column is compared with the first one of the model, and so on. Values of lines and divisions are compared wherever a
unit asks for them.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache
from typing import Any, NamedTuple

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.debug.probes import AXES, DUT, fields, numbered
from raycaster.debug.probes.ray import Description, Event, Place, Probe, Ray, Value, packed
from raycaster.debug.probes.units import indexed, monitor_probes, rect_probe, scene_probes, shown_events
from raycaster.debug.waves import Samples
from raycaster.golden.frames import model_for
from raycaster.golden.spans import (
    Cells,
    Chain,
    Drawing,
    Entry,
    Line,
    Rays,
    Rect,
    Surface,
    combined,
    first_change,
    folded,
)  # fmt: skip
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.records import Rect as RectRecord
from raycaster.rtl.span import records
from raycaster.rtl.span.first_change import division_cycles
from raycaster.rtl.span.line_eval import LATENCY
from raycaster.rtl.span.lists import ListEntry

RENDERER = f"{DUT}.span_renderer_i"
VIDEO = f"{RENDERER}.video_generator_i"
LIST = f"{RENDERER}.frame_list_i"
DEALER, COLLECTOR, PLAYER = (f"{LIST}.{name}_i" for name in ("row_dealer", "row_collector", "list_player"))

NONE = "none"
"""Value of the model for something that the hardware should not do."""

LINE = ("left", "right", "growth")
"""A line's values at two columns, and its growth."""

AIM = [f"{end}_{axis}" for end in LINE for axis in (*AXES, "e")]
"""The slope from the light, and e, as in `records.Aim`."""

COLOURED = ("plain", "bright", "colour", "pixel")
"""Values that are colours."""

Values = Mapping[str, Value]


class Fan(NamedTuple):
    """The rays of a chain; or those from the light to a surface, with the surface's e as a fourth component."""

    chain: Chain
    slope: Rays
    entries: Mapping[int, Entry]

    @property
    def lit(self) -> bool:
        """True for rays from the light."""
        return len(self.slope) > len(AXES)

    @property
    def aim(self) -> Values:
        """The slope at both ends, and its growth."""
        ends = [line.at(column) for column in (self.chain.start, self.chain.stop - 1) for line in self.slope]
        return dict(zip(AIM, [*ends, *(line.growth for line in self.slope)], strict=True))


@dataclass
class Level:
    """What the model finds for a column's ray after a number of mirrors."""

    chain: Chain
    weight: int
    entries: Mapping[int, Entry] = field(default_factory=dict)
    """The rectangles that the chain's rays meet, by index."""
    winner: Entry | None = None
    """The entry that the ray meets."""
    fans: list[Fan] = field(default_factory=list)
    """Rays from the light."""
    found: defaultdict[str, list[Values]] = field(default_factory=lambda: defaultdict(list))
    """Results in the order of the hardware, by kind of event."""


class Sight(Drawing):
    """A row that the model draws, and all that it finds for a column."""

    def __init__(self, ray: Ray):
        first, second = ray.row_slopes[:2].tolist()
        slope = tuple(Line(one, after - one) for one, after in zip(first, second, strict=True))
        super().__init__(model_for(ray.scene, ray.config, ray.reflections), slope)
        self.column, self.levels = ray.column, list[Level]()
        self.rects = {rect.index: rect for rect in self.model.table}
        self.surfaces: list[Values] = []
        """The surface of each level."""
        self.mixed: Values = {}
        """The run before neighbours are joined."""
        self.draw()
        runs = self.result.runs
        place = next(place for place, (end, _) in enumerate(runs) if self.column < end)
        end, colour = runs[place]
        self.joined = {"end": end, "colour": packed(colour, CHANNEL_BITS)}
        self.listed = {"end": end, "pixel": ray.pixel}
        rows = self.model.rows(ray.config.screen_geometry, ray.scene.camera.basis)
        self.place = place + sum(len(row.runs) for row, _ in zip(rows, range(ray.row), strict=False))
        """Number of the run in the list."""

    @property
    def last(self) -> int:
        """Number of mirrors on the ray's way."""
        return len(self.levels) - 1

    def sees(self, start: int, stop: int) -> bool:
        """Return True if columns include the pixel's."""
        return start <= self.column < stop

    def lines(self, rays: Fan, index: int) -> dict[int, Line]:
        """Return a rectangle's half-lines; none if it has none."""
        if index not in self.rects:
            return {}
        slope, surface = (rays.slope, rays.slope[3]) if rays.lit else (None, None)
        return self.half_lines(rays.chain, self.rects[index], slope, surface)

    def plane(self, chain: Chain, rect: Rect) -> Values:
        """Return how a chain's rays meet a rectangle's plane: the fields of its entry without columns."""
        far = rect.plane - chain.eye[rect.axis]
        return {"axis": rect.axis, "back": int(chain.back[rect.axis] != (far < 0)), "distance": abs(far)}

    def chain_values(self, number: int) -> Values:
        """Return the fields of the chain after a number of mirrors."""
        level, before = self.levels[number], self.levels[max(0, number - 1)]
        chain, mirror = level.chain, before.winner
        vectors = {"eye": chain.eye, "back": chain.back, "met": [axis in chain.met for axis in range(len(AXES))]}
        return {
            **{f"{name}_{axis}": int(vector[i]) for name, vector in vectors.items() for i, axis in enumerate(AXES)},
            **(self.plane(before.chain, mirror.rect) if number and mirror else {}),
            "start": chain.start, "stop": chain.stop, "weight": level.weight, "mirrored": int(number > 0),
        }  # fmt: skip

    def chain(self, chain: Chain, weight: int) -> None:
        """Draw a chain."""
        if self.sees(chain.start, chain.stop):
            self.levels.append(Level(chain, weight))
        super().chain(chain, weight)

    def set_up(self, chain: Chain, rays: Rays | None = None, ahead: Line | None = None) -> list[Entry]:
        """Find the entries of a chain, or the shadows on a surface."""
        entries = super().set_up(chain, rays, ahead)
        if self.sees(chain.start, chain.stop):
            level, found = self.levels[len(self.shown)], {entry.rect.index: entry for entry in entries}
            if rays and ahead:
                level.fans.append(Fan(chain, (*rays, ahead), found))
            else:
                level.entries = found
        return entries

    def sweep(
        self, entries: Sequence[Entry], chain: Chain, column: int, winner: Entry | None
    ) -> tuple[int, Entry | None]:
        """Find a span."""
        stop, heir = super().sweep(entries, chain, column, winner)
        if self.sees(chain.start, chain.stop) and column <= self.column:
            self.levels[len(self.shown)].winner = winner
            found = {"column": column, "gap": int(winner is None), "stop": stop, "inherited": int(heir is not None)}
            self._note("span", found | {"winner": winner and winner.rect.index, "heir": heir and heir.rect.index})
        return stop, heir

    def corner(self, chain: Chain, column: int, stop: int, winner: Entry) -> tuple[int, bool]:
        """Apply the corner rule."""
        part_stop, corner = super().corner(chain, column, stop, winner)
        if self.sees(column, stop):
            self._note("corner", {"stop": part_stop, "corner": int(corner)})
        return part_stop, corner

    def follow(self, cells: Cells, column: int, stop: int) -> None:
        """Find the next cell."""
        super().follow(cells, column, stop)
        if self.sees(column, stop):
            rises = None if cells.next == stop else int(cells.rises)
            values = {"cell": cells.cell, "next": cells.next, "rises": rises}
            self._note("cell", values, lambda surface: any(one is cells for one in surface.cells))

    def look(self, surface: Surface, column: int) -> None:
        """Find the light at a column."""
        super().look(surface, column)
        if self.sees(column, surface.stop):
            values = {"dark": int(surface.dark), "next": surface.next_dark}
            self._note("light", values, lambda other: other is surface)

    def run(self, end: int) -> None:
        """Append a run."""
        runs = self.result.runs
        begin = runs[-1][0] if runs else 0
        super().run(end)
        if self.sees(begin, end):
            shade = self.model.light.quarters if self.model.light else 0
            self.mixed = {"end": end, "colour": packed(runs[-1][1], CHANNEL_BITS)}
            for one in self.shown:
                colours = {"plain": one.colours[0], "bright": one.colour(4), "colour": one.colour(shade)}
                values = {name: packed(colour, CHANNEL_BITS) for name, colour in colours.items()}
                self.surfaces.append({"share": one.weight, "dark": int(one.dark), **values})

    def _note(self, kind: str, values: Values, its: Callable[[Surface], bool] = lambda surface: False) -> None:
        """Keep a result, of the level of a surface that is shown or else of the present one."""
        level = next((number for number, surface in enumerate(self.shown) if its(surface)), len(self.shown))
        self.levels[level].found[kind].append(values)


@lru_cache(maxsize=4)
def sight_of(ray: Ray) -> Sight:
    """Return what the model finds for a pixel."""
    return Sight(ray)


def extent(entry: Entry | None) -> Values:
    """Return an entry's rectangle and columns."""
    return {"index": entry.rect.index, "start": entry.start, "stop": entry.stop} if entry else {"start": NONE}


@cache
def places(record: Record) -> list[tuple[str, int, int, bool]]:
    """Return each field's name, lowest bit and width, and whether it is signed."""
    return [(name, record.slice(name)[1], bits, isinstance(bits, Signed)) for name, bits in record.layout.items()]


def cut(record: Record, word: int) -> dict[str, int]:
    """Return the fields of a record's word."""
    parts = ((name, word >> low & (1 << bits) - 1, bits, sign) for name, low, bits, sign in places(record))
    return {name: value - (value >> bits - 1 << bits if sign else 0) for name, value, bits, sign in parts}


def asked(query: Mapping[str, int], slope: Rays) -> tuple[int, int, int]:
    """Return the values of a query's line, as in `LINE`, with the golden slope."""
    x, y = (folded(slope, query[f"axis_{side}"], bool(query[f"back_{side}"])) for side in "12")
    line = combined(query["factor_1"], x, query["factor_2"], y, query["strict"])
    return line.at(query["left"]), line.at(query["right"]), line.growth


class SpanProbes(Description):
    """The span engine's description; see `raycaster.debug.probes.ray.Description`."""

    video = VIDEO

    def __init__(self, config: Configuration, unit: int):
        self.config, units = config, config.units
        self._chain, self._entry, self._query = (one(config) for one in (records.Chain, records.Entry, records.Query))
        self._division, self._grid = records.Division(config), records.Grid(config)
        self._listed = ListEntry(config.screen_geometry.columns, 3 * config.colour_bits)
        self.unit = f"{RENDERER}.{numbered('span_unit', unit, units)}"
        self.rects = f"{DUT}.{'rect_rom' if config.fixed else 'rect_mem'}_i", "rects_rect"
        if units > 1:
            self.rects = f"{RENDERER}.{numbered('rect_table', unit, units)}", "walk_rect"
        self.queue = f"{LIST}.{numbered('run_queue', unit, units)}"
        self.states = [f"{self.unit}.{name}_i.state" for name in ("span_control", "sweep", "painter")]
        blocks = "span_control set_up sweep painter run_joiner entry_table corner_finder fold surfaces line_desk"
        self.blocks = {name: f"{self.unit}.{name}_i" for name in blocks.split()}
        self.blocks |= {name: f"{self.blocks['set_up']}.{name}_i" for name in ("half_lines", "clipper")}
        self.blocks |= {name: f"{self.blocks['line_desk']}.{name}_i" for name in ("line_eval", "first_change")}
        self.blocks |= {name: f"{self.blocks['surfaces']}.{name}_i" for name in ("surface_cells", "surface_light")}
        self.blocks |= {
            "cell_walker": f"{self.blocks['surface_cells']}.cell_walker_i",
            "shadow_finder": f"{self.blocks['surface_light']}.shadow_finder_i",
            "shadow_scan": f"{self.blocks['surface_light']}.shadow_scan_i",
            "dealer": DEALER, "collector": COLLECTOR, "player": PLAYER, "video": VIDEO, "unit": self.unit,
        }  # fmt: skip
        shown = {
            "start": ("row started", "dealer.next_row"), "chain": ("chain begun", "span_control.begin_set_up"),
            "entry": ("entry found", "clipper.append"), "shadow": ("shadow found", "clipper.append"),
            "span": ("span found", "sweep.done"), "paint": ("surface painted", "span_control.begin_paint"),
            "fold": ("chain folded", "span_control.push"), "mixed": ("run mixed", "painter.run_valid"),
            "done": ("run joined", "run_joiner.run_valid"), "listed": ("run listed", "collector.write"),
            "shown": ("pixel shown", "video.y"),
        }  # fmt: skip
        self.event_names = {kind: (text, self._named(signal)) for kind, (text, signal) in shown.items()}

    def _named(self, signal: str) -> str:
        """Return the full name of a block's signal."""
        block, _, name = signal.partition(".")
        return f"{self.blocks[block]}.{name}"

    @cached_property
    def names(self) -> Mapping[str, str]:
        """Full names of the signals that `events` reads, by block and name."""
        config, mirrors = self.config, self.config.most_reflections > 0
        listed = {
            "dealer": "next_row left", "collector": "take head_word rows_left", "player": "view_run",
            "video": "x y pixel_end", "unit": "rects_fetch rects_index done",
            "span_control": "begin_set_up begin_paint chain_word column stop" + " level push" * mirrors,
            "half_lines": "opened entry_word asks_ask asks_query_word entry_1_word",
            "set_up": "append entry_word" + " from_light" * config.light, "entry_table": "read place",
            "sweep": "done", "line_eval": "ask query_word", "first_change": "start division_word",
            "painter": "run_valid run_end", "run_joiner": "run_valid run_ready run_end",
            "corner_finder": "start needed done part_stop" * mirrors,
            "surface_light": "begin_set_up looked" * config.light, "shadow_scan": "done column stop" * config.light,
            "surface_cells": "looked grid_word" * config.patterns, "cell_walker": "done column" * config.patterns,
        }  # fmt: skip
        signals = (f"{block}.{name}" for block, names in listed.items() for name in names.split())
        return {signal: self._named(signal) for signal in signals}

    def controls(self) -> Iterable[str]:
        """List the signals that `events` reads."""
        return self.names.values()

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """List the events that the golden model says must happen."""
        sight = sight_of(ray)
        yield "start", Place(0)
        for number, level in enumerate(sight.levels):
            yield from (
                (kind, Place(number)) for kind in ("fold", "chain", "span", "paint") if number or kind != "fold"
            )
            yield from (("entry", Place(number, index)) for index in level.entries)
            yield from (("shadow", Place(number, index)) for fan in level.fans for index in fan.entries)
        yield from ((kind, Place(sight.last)) for kind in ("mixed", "done", "listed"))
        yield "shown", Place(ray.reflections)

    def events(self, samples: Samples, ray: Ray) -> list[Event]:
        """List what the hardware did for the pixel, in the first frame of the scene."""
        sight, cycles = sight_of(ray), range(len(samples.times_ns))
        series = {key: samples.values[name] for key, name in self.names.items()}
        viewed = next((cycle for cycle in cycles if series["player.view_run"][cycle]), len(cycles))
        rows_left = ray.config.screen_geometry.rows - ray.row
        starts = zip(series["dealer.next_row"], series["dealer.left"], strict=True)
        start = next((cycle for cycle, one in enumerate(starts) if one == (1, rows_left - 1)), viewed)
        # A chain is there from the cycle after the strobe on, the first one from the cycle after the row's start.
        events, counts, begin = [Event("start", start, Place(0))] if start < viewed else [], Counter[Any](chains=1), 0
        for cycle in cycles[start + 1 : viewed]:
            now = {key: values[cycle] or 0 for key, values in series.items()}
            events += self._steps(now, cycle, sight, counts)
            if now["painter.run_valid"] and not series["painter.run_valid"][cycle - 1]:
                end = now["painter.run_end"]
                if sight.sees(begin, end):
                    # Each level was read in a cycle before, and the sum of all went into the register.
                    first = cycle - 1 - len(sight.surfaces) - self.config.varied
                    levels = enumerate(sight.surfaces, first)
                    events += [Event("seen", at, Place(i), values) for i, (at, values) in enumerate(levels)]
                    events.append(Event("mixed", cycle, Place(sight.last), sight.mixed))
                begin = end
            if now["unit.done"]:
                break
        for cycle in cycles[start:viewed]:
            in_row = series["collector.take"][cycle] and series["collector.rows_left"][cycle] == rows_left
            if in_row and cut(self._listed, series["collector.head_word"][cycle] or 0)["end"] > ray.column:
                events.append(Event("listed", cycle, Place(sight.last), sight.listed))
                break
        return events + shown_events(samples, ray, VIDEO, viewed)

    def _steps(self, now: Mapping[str, int], cycle: int, sight: Sight, counts: Counter) -> Iterable[Event]:
        """List what the unit does for the pixel in a cycle; unknown signals are 0."""
        number, column = now.get("span_control.level", 0), now["span_control.column"]
        chain = cut(self._chain, now["span_control.chain_word"])
        here = number <= sight.last and sight.sees(chain["start"], chain["stop"])
        level = sight.levels[number if here else 0]
        begun = here and column <= sight.column
        in_span = begun and sight.column < now["span_control.stop"]
        shading = now.get("set_up.from_light", 0)
        fans = level.fans[: counts["aim", number]] if shading and in_span else []
        rays = fans[-1] if fans else Fan(level.chain, sight.slope, level.entries)

        def event(kind: str, values: Values, rectangle: int | None = None, at: int = number) -> Event:
            return Event(kind, cycle, Place(at, rectangle), values)

        def next_of(kind: str, at: int = number) -> Iterable[Event]:
            """Compare with the next result of the model, if there is one."""
            listed = sight.levels[at].found[kind] if at <= sight.last else []
            counts[kind, at] += 1
            yield from (event(kind, values, at=at) for values in listed[counts[kind, at] - 1 : counts[kind, at]])

        if now["unit.rects_fetch"] and now["unit.rects_index"] in sight.rects:
            yield event("fetch", {}, now["unit.rects_index"])
        if counts["chains"] and here:
            yield event("chain", sight.chain_values(number))
        counts["chains"] = now["span_control.begin_set_up"]
        if now["line_eval.ask"]:
            query = cut(self._query, now["line_eval.query_word"])
            from_light = query.get("from_light")
            if rays.lit or not from_light:
                slope = rays.slope if from_light else sight.slope
                yield event("answer", dict(zip(LINE, asked(query, slope), strict=True)))
        if now["first_change.start"]:
            line = cut(self._division, now["first_change.division_word"])
            columns = first_change(line["value"], line["growth"]) if line["growth"] else 0
            # A set-up divides lines whose sign does not change, too.
            yield event("division", {"columns": columns if 0 < columns <= sight.model.columns else None})
        if here and (rays.lit or not shading):
            yield from self._set_up(now, sight, rays, event)
        place, entries = now["entry_table.place"], [*level.entries.values()]
        if now["entry_table.read"] and begun and not shading and place < len(entries):
            yield event("read", extent(entries[place]))
        if now["sweep.done"] and here:
            yield from next_of("span")
        if now.get("corner_finder.done" if counts["cornered"] else "corner_finder.start"):
            counts["cornered"] = int(now["corner_finder.start"] and now["corner_finder.needed"])
            if in_span and not counts["cornered"]:
                yield from next_of("corner")
        folds = now.get("span_control.push") and begun and sight.column < now["corner_finder.part_stop"]
        if folds and number < sight.last:
            yield event("fold", sight.chain_values(number + 1), at=number + 1)
        if now["span_control.begin_paint"] and in_span:
            passed_on = sight.levels[number + 1].weight if number < sight.last else None
            yield event("paint", {**sight.surfaces[number], "weight": passed_on})
        if now.get("surface_light.begin_set_up") and in_span:
            counts["aim", number] += 1
            if counts["aim", number] <= len(level.fans):
                yield event("aim", level.fans[counts["aim", number] - 1].aim)
        if now.get("shadow_scan.done") and sight.sees(now["shadow_scan.column"], now["shadow_scan.stop"]):
            yield from next_of("light", now["surface_light.looked"])
        ends = cut(self._grid, now.get("surface_cells.grid_word", 0))["stop"]
        if now.get("cell_walker.done") and sight.sees(now["cell_walker.column"], ends):
            yield from next_of("cell", now["surface_cells.looked"])
        leaves = now["run_joiner.run_valid"] and now["run_joiner.run_ready"]
        if leaves and now["run_joiner.run_end"] > sight.column and not counts["run"]:
            counts["run"] = 1
            yield event("done", sight.joined, at=sight.last)

    def _set_up(self, now: Mapping[str, int], sight: Sight, rays: Fan, event: Callable[..., Event]) -> Iterable[Event]:
        """List what `set_up` does for the rays of a chain, or from the light."""
        chain, light = rays.chain, "shadow " if rays.lit else ""
        if now["half_lines.opened"]:
            index = cut(self._entry, now["half_lines.entry_word"])["index"]
            met = sight.lines(rays, index)
            yield event(f"{light}plane", sight.plane(chain, sight.rects[index]) if met else {"distance": NONE}, index)
        query = cut(self._query, now["half_lines.asks_query_word"])
        if now["half_lines.asks_ask"] and query["half_line"]:
            index, number = cut(self._entry, now["half_lines.entry_1_word"])["index"], query["number"]
            lines = sight.lines(rays, index)
            values: dict[str, Value] = {"number": NONE}
            if line := lines.get(number):
                values = {"number": number, "last": int(number == max(lines)), "growth": line.growth}
                values |= {"left": line.at(chain.start), "right": line.at(chain.stop - 1)}
            yield event(f"{light}line", values, index)
        if now["set_up.append"]:
            index = cut(self._entry, now["set_up.entry_word"])["index"]
            yield event("shadow" if rays.lit else "entry", extent(rays.entries.get(index)), index)

    def _line_asked(self, ray: Ray, place: Place, *values: int) -> Sequence[int]:
        """Return the number of a half-line that is asked, whether it is the last one, and its values."""
        query, sight = dict(zip(self._query.layout, values, strict=True)), sight_of(ray)
        fans = sight.levels[place.bounce].fans if query.get("from_light") else []
        return query["number"], query["last"], *asked(query, fans[0].slope if fans else sight.slope)

    def _probe(self, quantity: str, event: str, scope: str, names: str, layout: Record | None = None, group: str = "",
               **options: Any) -> Probe:  # fmt: skip
        """Make a probe of a block's signals, each a part or part=signal, or of fields of a record."""
        pairs = [(part, name or part) for part, _, name in (one.partition("=") for one in names.split())]
        pairs = [(part, name) for part, name in pairs if not layout or layout.has(name)]
        parts, signals = [part for part, _ in pairs], [name for _, name in pairs]
        scope = self.blocks.get(scope, scope)
        given: dict[str, Any] = {
            "parts": parts, "colour": tuple(i for i, part in enumerate(parts) if part in COLOURED),
            "narrow": "pixel" in parts,
        }  # fmt: skip
        if layout:
            given["signed"] = tuple(i for i, name in enumerate(signals) if isinstance(layout.layout[name], Signed))
        full = fields(scope, group, signals, layout) if layout else tuple(f"{scope}.{name}" for name in signals)
        return Probe(quantity, full, event, **(given | options))

    @cached_property
    def probes(self) -> list[Probe]:
        """Probes in the order in which values depend on each other."""
        config, make, late = self.config, self._probe, division_cycles(self.config)
        mirrors, light, patterns = config.most_reflections > 0, config.light, config.patterns
        eye, back, met = (" ".join(f"{name}_{axis}" for axis in AXES) for name in ("eye", "back", "met"))
        way, hidden = f"{back} {met} mirrored axis back distance", dict[str, Any](shown=False)
        line: dict[str, Any] = {"parts": ("number", "last", *LINE), "decode": self._line_asked, **hidden}
        query, quarters = " ".join(self._query.layout), f"{self.blocks['span_control']}.quarters_of"
        slope = [f"{RENDERER}.row_slope_i.slope_{axis}" for axis in AXES]
        if config.turn:
            slope = [f"{RENDERER}.row_slope_i.slope_start_{number}_i.component" for number in range(len(AXES))]
        table = f"{self.blocks['surfaces'] if patterns or light else self.unit}.surface_table_i"

        def in_list(ray: Ray, place: Place) -> Sequence[Value]:
            # The right one of two pixels may see the next entry.
            return (None if ray.lane else sight_of(ray).place,)

        def of_lane(ray: Ray, place: Place, pixels: int) -> Sequence[int]:
            bits = 3 * config.colour_bits
            return (pixels >> ray.lane * bits & (1 << bits) - 1,)

        return [
            *(() if config.fixed and config.fixed.camera else scene_probes("start", config)),
            Probe("slope of the first column", tuple(slope), "start",
                lambda ray, _: ray.row_slopes[0].tolist(), signed=True, parts=AXES, shown=False),
            rect_probe("rectangle", *self.rects, RectRecord(config), "fetch", indexed, late=1),
            *([make("folded chain", "fold", "fold", f"start stop {eye} {way}", self._chain, "folded", **hidden),
                make("weight passed on", "paint", f"{quarters}_1_i", "weight=share", **hidden)] if mirrors else ()),
            make("columns", "chain", "span_control", "start stop", self._chain, "chain"),
            make("eye", "chain", "span_control", eye, self._chain, "chain"),
            *([make("mirrors", "chain", "span_control", f"{way} weight", self._chain, "chain", **hidden)]
                if mirrors else ()),
            make("plane", "plane", "half_lines", "axis back distance", self._entry, "entry"),
            make("half-line", "line", "half_lines", query, self._query, "asks_query", **line),
            *([make("slope from the light", "aim", "shadow_finder", " ".join(f"{name}=aim_{name}" for name in AIM),
                    signed=True, **hidden),
                make("plane from the light", "shadow plane", "half_lines", "axis back distance", self._entry, "entry",
                    **hidden),
                make("half-line from the light", "shadow line", "half_lines", query, self._query, "asks_query", **line),
            ] if light else ()),
            make("values of a line", "answer", "line_eval", " ".join(f"{name}=answer_{name}" for name in LINE),
                signed=True, late=LATENCY, **hidden),
            make("division", "division", "first_change", "columns", late=late, **hidden),
            make("met", "entry", "clipper", "start stop", self._entry, "entry"),
            make("entry read", "read", "entry_table", "index start stop", self._entry, "stored", late=1, **hidden),
            make("span begins", "span", "span_control", "column gap"),
            make("seen", "span", "span_control", "winner=index", self._entry, "winner"),
            make("span ends", "span", "sweep", "stop inherited"),
            make("heir", "span", "sweep", "heir=index", self._entry, "heir"),
            *([make("corner", "corner", "corner_finder", "stop=part_stop corner", late=1, **hidden)]
                if mirrors else ()),
            *([make("share", "paint", f"{quarters}_0_i", "share")] if mirrors else ()),
            make("colour", "paint", "span_control", "plain=colour"),
            *([make("cell", "cell", "cell_walker", "cell=found_cell next=next_column rises")] if patterns else ()),
            *([make("shadow", "shadow", "clipper", "start stop", self._entry, "entry"),
                make("light", "light", "shadow_scan", "dark next=next_dark"),
                make("dark", "seen", "surface_light", "dark", **hidden)] if light else ()),
            make("share and colour", "seen", table, "share plain=colour", records.Paint(config), "shown", **hidden),
            *([make("colour of the cell", "seen", f"{self.blocks['surfaces']}.pattern_colour_i", "bright=colour")]
                if patterns else ()),
            *([make("colour there", "seen", f"{self.blocks['surfaces']}.shade_colour_i", "colour=shaded")]
                if light else ()),
            make("run of the span", "mixed", "painter", "end=run_end colour=run_colour"),
            make("run", "done", "run_joiner", "end=run_end colour=run_colour"),
            *([make("run in the queue", "listed", self.queue, "end pixel", self._listed, "head")]
                if config.units > 1 else ()),
            make("entry of the list", "listed", COLLECTOR, "end pixel", self._listed, "entry", late=1),
            Probe("its place", (f"{COLLECTOR}.place",), "listed", lambda ray, _: (sight_of(ray).place,), late=1,
                **hidden),
            Probe("place shown", (f"{PLAYER}.row_place_i.place",), "shown", in_list, **hidden),
            Probe("pixel of the list", (f"{PLAYER}.shown",), "shown", lambda ray, _: (ray.pixel,), decode=of_lane,
                colour=True, narrow=True),
            *monitor_probes(RENDERER, "shown", VIDEO, config),
        ]  # fmt: skip
