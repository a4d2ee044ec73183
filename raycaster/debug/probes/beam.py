# SPDX-License-Identifier: MIT
"""Probes for the beam engine: a pipeline through which each column passes.

A straight ray folds back into the room at each mirror, so values are compared as seen from the camera. The latencies
that the hardware's own blocks declare say when a column reaches each stage.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.debug.probes import AXES, COLOURS, DUT, fields, numbered
from raycaster.debug.probes.exact import fraction
from raycaster.debug.probes.ray import Description, Event, Place, Probe, Ray, Read, Value, channels_of
from raycaster.debug.probes.units import indexed, monitor_probes, rect_probe, scene_probes, shown_events
from raycaster.debug.waves import Samples, signed
from raycaster.rtl.beam import latencies as beam
from raycaster.rtl.common import records
from raycaster.rtl.common.widths import factor_bits

RENDERER = f"{DUT}.beam_renderer_i"
CASTER = f"{RENDERER}.beam_caster_i"
SETUP = f"{CASTER}.rect_setup_i"
LANE = f"{CASTER}.beam_lane_i"
BLEND = f"{LANE}.colour_blend_i"
VIDEO = f"{RENDERER}.video_generator_i"

EXTENT = ((1, 2), (0, 2), (1, 0))
"""Axes p and q by the plane's axis: p is y unless y is the plane's axis, so that only p changes along a row."""

BOUNDS = ("low_p", "high_p", "low_q", "high_q")

Slope = Callable[[Ray], Sequence[int]]
"""Function for a slope that a row's products are computed with."""


def products(ray: Ray, rectangle: int, slopes: Sequence[int]) -> tuple[int, int, list[int]]:
    """Compute the products of a camera ray's slope: the ways along p and q, and the ways to the four bounds."""
    axis, eye = int(ray.rectangles.axes[rectangle]), ray.scene.camera.position
    p, q = EXTENT[axis]
    away = distance(ray, rectangle)
    bounds = (bound[rectangle] for side in (p, q) for bound in (ray.rectangles.low, ray.rectangles.high))
    ends = [(int(bound[side]) - eye[side]) * slopes[axis] for side, bound in zip((p, p, q, q), bounds, strict=True)]
    return away * slopes[p], away * slopes[q], ends


def distance(ray: Ray, rectangle: int) -> int:
    """Distance from the camera to a rectangle's plane."""
    axis, position, _ = ray.plane(Place(0, rectangle))
    return position - ray.scene.camera.position[axis]


def setup_facet(ray: Ray, place: Place) -> Mapping[str, Value]:
    """Facet fields that `Ray.rect_fields` lacks, shared by all columns of the row."""
    _, way_q, _ = products(ray, place.index, ray.of_ray(0, "slopes"))
    return {"usable": 1, "distance": distance(ray, place.index), "way_q": way_q}


def walk_of(slope: Slope) -> Read:
    """Make a reader of a rectangle's products with a slope, as `Walk` lays them out."""

    def read(ray: Ray, place: Place) -> Sequence[Value]:
        way_p, way_q, ends = products(ray, place.index, slope(ray))
        return way_p, *(way_q,) * ray.config.turn, *ends

    return read


def first_slope(ray: Ray) -> Sequence[int]:
    """Slope of the row's first column."""
    return ray.row_slopes[0].tolist()


def growth_of_slope(ray: Ray) -> Sequence[int]:
    """Change of the slope per column."""
    return (ray.row_slopes[1] - ray.row_slopes[0]).tolist()


def ways(ray: Ray, place: Place) -> Sequence[Value]:
    """The column's ways along p and, if the camera turns, along q."""
    way_p, way_q, _ = products(ray, place.index, ray.of_ray(0, "slopes"))
    return (way_p, way_q) if ray.config.turn else (way_p,)


def mirrored(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Offset that mirrors add to a point, by axis: from the camera to its image."""
    eyes = zip(ray.of_ray(place.bounce, "origins"), ray.scene.camera.position, strict=True)
    return [image - coordinate for image, coordinate in eyes] if place.bounce else None


def turned(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Flags of the axes along which the folded ray runs backwards; None for an axis along which it does not move."""
    slopes = zip(ray.of_ray(place.bounce, "slopes"), ray.of_ray(0, "slopes"), strict=True)
    return [int(slope != before) if before else None for slope, before in slopes] if place.bounce else None


def of_camera(read: Read, *, reflected: bool = False) -> Read:
    """Restrict a reader to rays from the camera, or to reflected ones."""
    return lambda ray, place: read(ray, place) if bool(place.bounce) == reflected else None


def met(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Axis and plane distance of the rectangle that a ray hit."""
    winner = ray.winner(place.bounce)
    return (int(ray.rectangles.axes[winner]), distance(ray, winner)) if winner >= 0 else None


def seen_channels(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Channels of the colour that a ray sees; None if the golden model has no expectation."""
    seen = ray.seen_colour(place)
    return channels_of(*seen, CHANNEL_BITS) if seen else None


def nearest_of(size: int) -> Read:
    """Make a reader of whether any of `size` neighbours (all for 0) is hit, and of the nearest one."""

    def read(ray: Ray, place: Place) -> Sequence[Value]:
        first = place.rectangle or 0
        nearest = ray.nearest_of(place.bounce, range(first, first + size) if size else range(len(ray.rectangles)))
        return (1, nearest) if nearest >= 0 else (0, None)

    return read


def of_mirrors(passes: int, read: Read) -> Read:
    """Restrict a reader to passes that leave a mirror: all but the last."""
    return lambda ray, place: read(ray, place) if place.bounce < passes - 1 else None


class BeamProbes(Description):
    """The beam engine's description; see `raycaster.debug.probes.ray.Description`."""

    video = VIDEO
    event_names: Mapping[str, tuple[str, str]] = {
        "column": ("column announced", f"{RENDERER}.scan_next_column"),
        "load": ("rectangle set up", f"{SETUP}.load"),
        "grow": ("change per column set up", f"{SETUP}.load"),
        "shown": ("pixel shown", f"{VIDEO}.y"),
    }

    def __init__(self, config: Configuration, unit: int):
        self.config = config
        passes = config.reflections + 1
        self.starts = [beam.ENTRY_LATENCY + number * beam.pass_latency(config) for number in range(passes)]

    def named(self, signal: str, place: Place) -> str:
        """Return the full name of a signal in the instances of a place."""
        config, bounce, rectangle = self.config, place.bounce, place.rectangle or 0
        passes, count = len(self.starts), config.rectangles
        one = f"{LANE}.{numbered('beam_pass', bounce, passes)}"
        delays = [number for number in range(passes) for _ in range(number + 1, passes)]
        late = max((i for i, number in enumerate(delays) if number == bounce), default=0)
        return signal.format(
            beam=one,
            walker=f"{one}.{numbered('rect_walker', rectangle, count)}",
            tester=f"{one}.{numbered('fold_tester' if bounce else 'ray_tester', rectangle, count)}",
            fold=f"{LANE}.{numbered('ray_fold', max(0, bounce - 1), passes - 1)}",
            # With patterns the rays' images are delayed too.
            kept=f"{LANE}.{numbered('delay_line', late, len(delays) + (passes - 1) * config.patterns)}",
            look=f"{LANE}.{numbered('look_up', bounce, passes)}",
            seen=f"{BLEND}.{numbered('colour_seen', bounce, passes)}",
            mirror=f"{LANE}.{numbered('mirror_look_up', min(bounce, passes - 2), passes - 1)}",
            **{f"round_{turn}": self._contest(turn, rectangle) for turn in range(beam.rounds(config))},
        )

    def _contest(self, turn: int, rectangle: int) -> str:
        """Name, within a pass, the winner of the contest that covers a rectangle in a round."""
        left, number = -(-self.config.rectangles >> turn), rectangle >> turn + 1
        one = (
            f"{numbered('nearest_of_two', number, left // 2)}.nearest" if 2 * number + 1 < left else "delay_line_i.late"
        )
        return ".".join([*["nearest_of_i"] * (turn + 1), one])

    def _joined(self) -> Probe:
        """Probe the first mirror's channels, with their reflections: mixed in registers, or a mean before them."""
        mirrors, mixes = self.config.reflections, beam.mixes(self.config)
        block, port, low = ("colour_mix", "mixed", 2 * mirrors) if mixes else ("colour_mean", "mean", mirrors)
        low += CHANNEL_BITS - self.config.colour_bits
        names = [numbered(block, 3 * (mirrors - 1) + channel, 3 * mirrors) for channel in range(3)]
        return Probe(
            "channels, joined", tuple(f"{BLEND}.{name}.{port}" for name in names), "done" if mixes else "blend",
            lambda ray, place: ray.channels(place) if mixes or not place.bounce else None,
            late=0 if mixes else 1, decode=lambda ray, place, *sums: [one >> low for one in sums], parts=COLOURS,
            narrow=True,
        )  # fmt: skip

    def controls(self) -> Iterable[str]:
        """List the signals that `events` reads."""
        names = ("start_line", "scan_next_column", "row_slope", "in_picture", "rects_fetch", "rects_index")
        video = (f"{VIDEO}.{name}" for name in ("x", "y", "pixel_end"))
        return [*(f"{RENDERER}.{name}" for name in names), f"{SETUP}.load", *video]

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """List the events that the golden model says must happen."""
        yield "column", Place(0)
        for rectangle in range(len(ray.rectangles)):
            yield "load", Place(0, rectangle)
            if self.config.turn:
                yield "grow", Place(0, rectangle)
        yield "shown", Place(ray.reflections)

    def events(self, samples: Samples, ray: Ray) -> list[Event]:
        """List what the hardware did for the pixel, in the first line that shows it."""
        values, screen = samples.values, ray.config.screen_geometry
        bits = factor_bits(self.config)
        line, passed, column = 0, 0, None
        for cycle in range(len(samples.times_ns)):
            if values[f"{RENDERER}.start_line"][cycle]:
                line, passed = cycle, 0
            if not values[f"{RENDERER}.scan_next_column"][cycle] or not values[f"{RENDERER}.in_picture"][cycle]:
                continue
            slope = signed(values[f"{RENDERER}.row_slope"][cycle], bits)
            if slope == screen.horizon_row - ray.row and passed == ray.column:
                column = cycle
                break
            passed += 1
        if column is None:
            return shown_events(samples, ray, VIDEO, 0)
        events = [Event("column", column, Place(0)), Event("line", line, Place(0))]
        count = len(ray.rectangles)
        loaded: set[int] = set()
        for cycle in range(line, column):
            index, load = values[f"{RENDERER}.rects_index"][cycle], values[f"{SETUP}.load"][cycle] or 0
            if values[f"{RENDERER}.rects_fetch"][cycle] and index in range(count):
                events.append(Event("fetch", cycle, Place(0, index)))
            for i in range(count):
                if load >> i & 1:
                    # If the camera turns, a second sweep computes the changes per column.
                    events.append(Event("grow" if i in loaded else "load", cycle, Place(0, i)))
                    loaded.add(i)
        end = column + self.starts[-1] + beam.winner_latency(self.config) + beam.cell_latency(self.config)
        for bounce, start in enumerate(self.starts[: ray.reflections + 1]):
            entered = column + start
            events.append(Event("ray", entered, Place(bounce)))
            events += [Event("test", entered, Place(bounce, i)) for i in range(count)]
            for turn in range(beam.rounds(self.config)):
                cycle = entered + beam.TESTER_LATENCY + (turn + 1) * beam.contest_latency(self.config)
                events += [Event(f"round {turn}", cycle, Place(bounce, i)) for i in range(0, count, 2 << turn)]
            events.append(Event("winner", entered + beam.winner_latency(self.config), Place(bounce)))
            events.append(Event("kept", end, Place(bounce)))
            events.append(Event("blend", end + beam.LOOK_UP_LATENCY, Place(bounce)))
        events.append(Event("done", column + beam.beam_latency(self.config), Place(ray.reflections)))
        return events + shown_events(samples, ray, VIDEO, column)

    @property
    def probes(self) -> list[Probe]:
        """Probes in the order in which values depend on each other."""
        config = self.config
        facet, walk = records.Facet(config), records.Walk(config)
        sight = (records.Sight if config.patterns else records.Winner)(config)
        last, passes = beam.rounds(config) - 1, len(self.starts)
        start, lead = fields(SETUP, "start", walk.layout, walk), -beam.fold_lead(config)
        moving = AXES if config.turn else "y"
        way = "way p, q" if config.turn else "way p"
        along = tuple(f"{{walker}}.way_{side}" for side in "pq"[: 1 + config.turn])
        candidate, fold, reflector = records.Candidate(config), records.Fold(config), records.Reflector()
        look = records.Look(config)
        rounds = [
            Probe("nearest of some", fields("{beam}", f"{{round_{turn}}}", ("valid", "index"), candidate),
                f"round {turn}", nearest_of(2 << turn), shown=False)
            for turn in range(last)
        ]  # fmt: skip
        reflected = [
            Probe("shifted by", fields("{fold}", "fold", [f"shift_{axis}" for axis in AXES], fold), "ray", mirrored,
                late=lead, signed=True, parts=AXES),
            Probe("runs back", fields("{fold}", "fold", [f"back_{axis}" for axis in AXES], fold), "ray", turned,
                late=lead, parts=AXES),
            Probe("last mirror", fields("{fold}", "fold", ("axis", "distance"), fold), "ray",
                lambda ray, place: met(ray, Place(place.bounce - 1)) if place.bounce else None, late=lead,
                signed=(1,), shown=False, parts=("axis", "distance")),
        ]  # fmt: skip
        kept = [
            Probe("mirror", fields("{mirror}", "last", ("axis", "distance"), reflector), "winner",
                of_mirrors(passes, met), late=1, signed=(1,), shown=False, parts=("axis", "distance")),
            Probe("kept", fields("{kept}", "late", ("valid", "index"), sight), "kept",
                of_mirrors(passes, nearest_of(0)), shown=False),
        ]  # fmt: skip
        return [
            *scene_probes("line", self.config),
            rect_probe("rectangle", f"{DUT}.rect_mem_i", "rects_rect", records.Rect(config), "fetch", indexed,
                late=2),
            *(self._aim_probes() if config.turn else []),
            rect_probe("set up", SETUP, "facet", facet, "load", indexed, more=setup_facet),
            Probe("products of the first column", start, "load", walk_of(first_slope), signed=True, shown=False,
                parts=tuple(walk.layout)),
            Probe("in the pipeline", (f"{LANE}.steps",), "ray", lambda ray, place: (1,), shown=False,
                decode=lambda ray, place, steps: (steps >> (self.starts[place.bounce] - 1) & 1,)),
            Probe(f"slope along {', '.join(moving)}", fields("{beam}.slope_walker_i", "slope", moving), "ray",
                lambda ray, _: [ray.of_ray(0, "slopes")[AXES.index(axis)] for axis in moving], signed=True),
            *(reflected if passes > 1 else []),
            Probe(way, along, "test", of_camera(ways), late=1, signed=True),
            Probe(way, along, "test", of_camera(ways, reflected=True), signed=True),
            Probe("bounds p, q", tuple(f"{{walker}}.{name}" for name in BOUNDS), "test",
                lambda ray, place: products(ray, place.index, ray.of_ray(0, "slopes"))[2], late=1, signed=True),
            Probe("inside", fields("{tester}", "hit", ("valid",), candidate), "test", Ray.hit,
                late=beam.TESTER_LATENCY),
            Probe("t", fields("{tester}", "hit", ("numerator", "denominator"), candidate), "test", fraction,
                late=beam.TESTER_LATENCY),
            *rounds,
            Probe("nearest", fields("{beam}", f"{{round_{last}}}", ("valid", "index"), candidate), "winner",
                nearest_of(0)),
            *(kept if passes > 1 else []),
            Probe("found", ("{look}.found",), "blend", Ray.found),
            Probe("its colour", fields("{look}", "look", ("colour",), look), "blend",
                Ray.found_colour, colour=True),
            *(self._pattern_probes() if config.patterns else []),
            Probe("colour seen", fields("{seen}", "shade", COLOURS, records.Shade(config)), "blend",
                seen_channels, late=1, parts=COLOURS),
            *([self._joined()] if passes > 1 else []),
            Probe("pixel", fields(BLEND, "pixel", COLOURS, records.Pixel(config.colour_bits)), "done", Ray.channels,
                parts=COLOURS, narrow=True),
            *monitor_probes(RENDERER, "shown", VIDEO, config),
        ]  # fmt: skip

    def _aim_probes(self) -> list[Probe]:
        """Probes of a turned camera's line: its first ray, the change per column, and the products with that."""
        aim = tuple(f"{CASTER}.line_starter_i.aim_{axis}" for axis in AXES)
        walk = records.Walk(self.config)
        return [
            Probe("first ray of the row", aim, "load", lambda ray, _: first_slope(ray), signed=True, shown=False,
                parts=AXES),
            Probe("change per column", aim, "grow", lambda ray, _: growth_of_slope(ray), signed=True, shown=False,
                parts=AXES),
            Probe("products of the change", fields(SETUP, "start", walk.layout, walk), "grow",
                walk_of(growth_of_slope), signed=True, shown=False, parts=tuple(walk.layout)),
        ]  # fmt: skip

    def _pattern_probes(self) -> list[Probe]:
        """Probes of the hit point's cell and colour."""
        painter = "{look}.pattern_colour_i"
        return [
            Probe("odd cell u, v", (f"{painter}.odd_u", f"{painter}.odd_v"), "blend", Ray.cell_seen, shown=False,
                module="hit_cells"),
            Probe("colour there", (f"{painter}.colour",), "blend", Ray.own_colour, colour=True, shown=False),
        ]  # fmt: skip
