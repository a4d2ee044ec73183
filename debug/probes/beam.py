# SPDX-License-Identifier: MIT
"""Probes for the beam engine: a pipeline through which each column passes.

A straight ray folds back into the room at each mirror, so values are compared as seen from the camera. The latencies
that the hardware's own blocks declare say when a column reaches each stage.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.debug.probes import AXES, COLOURS, DUT, fields, numbered
from raycaster.debug.probes.exact import fraction
from raycaster.debug.probes.ray import Description, Event, Place, Probe, Ray, Read, Value, channels_of
from raycaster.debug.probes.units import RECT_FIELDS, monitor_probes, scene_probes, shown_events
from raycaster.debug.waves import Samples, signed
from raycaster.engines import beam
from raycaster.golden.rays import primary_slopes
from raycaster.rtl.common import records
from raycaster.rtl.common.widths import factor_bits, index_bits, walk_bits

RENDERER = f"{DUT}.beam_renderer_i"
CASTER = f"{RENDERER}.beam_caster_i"
SETUP = f"{CASTER}.rect_setup_i"
LANE = f"{CASTER}.beam_lane_i"
BLEND = f"{LANE}.colour_blend_i"
VIDEO = f"{RENDERER}.video_generator_i"

EXTENT = ((1, 2), (0, 2), (1, 0))
"""Axes p and q by the plane's axis: p is y unless y is the plane's axis, so that only p changes along a row."""

BOUNDS = ("low_p", "high_p", "low_q", "high_q")


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


def setup_facet(ray: Ray, place: Place) -> Sequence[Value]:
    """Facet fields, shared by all columns of the row."""
    _, way_q, _ = products(ray, place.index, ray.of_ray(0, "slopes"))
    axis = int(ray.rectangles.axes[place.index])
    return 1, axis, distance(ray, place.index), way_q, ray.colour(place.index)


def setup_start(ray: Ray, place: Place) -> Sequence[Value]:
    """The products of the row's first column."""
    first = primary_slopes(ray.config.screen_geometry)[ray.row, 0].tolist()
    way_p, _, ends = products(ray, place.index, first)
    return way_p, *ends


def way_p(ray: Ray, place: Place) -> Sequence[Value]:
    """The column's way along p; for the camera ray it is read a cycle later, with the bounds."""
    return products(ray, place.index, ray.of_ray(0, "slopes"))[:1]


def mirrored(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Offset that mirrors add to a point, by axis: from the camera to its image."""
    eyes = zip(ray.of_ray(place.bounce, "origins"), ray.scene.camera.position, strict=True)
    return [image - coordinate for image, coordinate in eyes] if place.bounce else None


def turned(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Flags of the axes along which the folded ray runs backwards; None for an axis along which it does not move."""
    slopes = zip(ray.of_ray(place.bounce, "slopes"), ray.of_ray(0, "slopes"), strict=True)
    return [int(slope != before) if before else None for slope, before in slopes] if place.bounce else None


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
            late=0 if mixes else 1, decode=lambda ray, place, *sums: [one >> low for one in sums], parts=COLOURS
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
        events = [Event("column", column, Place(0))]
        count = len(ray.rectangles)
        for cycle in range(line, column):
            index, load = values[f"{RENDERER}.rects_index"][cycle], values[f"{SETUP}.load"][cycle] or 0
            if values[f"{RENDERER}.rects_fetch"][cycle] and index in range(count):
                events.append(Event("fetch", cycle, Place(0, index)))
            events += [Event("load", cycle, Place(0, i)) for i in range(count) if load >> i & 1]
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
        facet, walk = records.facet_of(config), records.Walk(walk_bits(config))
        sight = (records.Sight if config.patterns else records.Winner)(index_bits(config))
        plain = [name for name in facet.layout if name not in ("mirror", "kind", "cell", "colour_2")]
        last, passes = beam.rounds(config) - 1, len(self.starts)
        candidate, fold, reflector = records.candidate_of(config), records.fold_of(config), records.Reflector()
        look = records.Look(config.materials, config.patterns)
        rounds = [
            Probe("nearest of some", fields("{beam}", f"{{round_{turn}}}", ("valid", "index"), candidate),
                f"round {turn}", nearest_of(2 << turn), shown=False)
            for turn in range(last)
        ]  # fmt: skip
        reflected = [
            Probe("shifted by", fields("{fold}", "fold", [f"shift_{axis}" for axis in AXES], fold), "ray", mirrored,
                signed=True, parts=AXES),
            Probe("runs back", fields("{fold}", "fold", [f"back_{axis}" for axis in AXES], fold), "ray", turned,
                parts=AXES),
            Probe("last mirror", fields("{fold}", "fold", ("axis", "distance"), fold), "ray",
                lambda ray, place: met(ray, Place(place.bounce - 1)) if place.bounce else None, signed=(1,),
                shown=False),
        ]  # fmt: skip
        kept = [
            Probe("mirror", fields("{mirror}", "last", ("axis", "distance"), reflector), "winner",
                of_mirrors(passes, met), late=1, signed=(1,), shown=False),
            Probe("kept", fields("{kept}", "late", ("valid", "index"), sight), "kept",
                of_mirrors(passes, nearest_of(0)), shown=False),
        ]  # fmt: skip
        return [
            *scene_probes("column", self.config),
            Probe("rectangle", fields(f"{DUT}.rect_mem_i", "rects_rect", RECT_FIELDS, records.rect_of(config)), "fetch",
                Ray.sorted_rect, late=2, colour=(6,), shown=False),
            Probe("set up", fields(SETUP, "facet", plain, facet), "load", setup_facet, signed=(2, 3),
                shown=False),
            Probe("products of the first column", fields(SETUP, "start", walk.layout, walk), "load", setup_start,
                signed=True, shown=False),
            Probe("in the pipeline", (f"{LANE}.steps",), "ray", lambda ray, place: (1,), shown=False,
                decode=lambda ray, place, steps: (steps >> (self.starts[place.bounce] - 1) & 1,)),
            Probe("slope along y", ("{beam}.straight_y",), "ray", lambda ray, _: ray.of_ray(0, "slopes")[1:2],
                signed=True),
            *(reflected if passes > 1 else []),
            Probe("way p", ("{walker}.way_p",), "test",
                lambda ray, place: None if place.bounce else way_p(ray, place), late=1, signed=True),
            Probe("way p", ("{walker}.way_p",), "test",
                lambda ray, place: way_p(ray, place) if place.bounce else None, signed=True),
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
            Probe("colour seen", fields("{seen}", "shade", COLOURS, records.shade_of(config)), "blend",
                seen_channels, late=1, parts=COLOURS),
            *([self._joined()] if passes > 1 else []),
            Probe("pixel", fields(BLEND, "pixel", COLOURS, records.Pixel(config.colour_bits)), "done", Ray.channels,
                parts=COLOURS),
            *monitor_probes(RENDERER, "shown", VIDEO, config),
        ]  # fmt: skip
