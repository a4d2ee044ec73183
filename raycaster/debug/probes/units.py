# SPDX-License-Identifier: MIT
"""Probes of all engines with ray units and a line buffer: the units' life cycle, and a pixel's path to the pins."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import pairwise

from raycaster.configuration import Configuration
from raycaster.debug.probes import AXES, COLOURS, DUT, PINS, fields, numbered
from raycaster.debug.probes.ray import Description, Event, Place, Probe, Ray, Read, Value
from raycaster.debug.waves import Samples, signed
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.interfaces import AIM_CYCLES
from raycaster.rtl.common.records import Camera, Pixel, Rect, Signs

RENDERER = f"{DUT}.ray_caster_renderer_i"
SIGNS = ("dx", "dy", "dz")
VIDEO = f"{RENDERER}.video_generator_i"


def hit_mask(ray: Ray, place: Place) -> Sequence[int]:
    """Mask of the rectangles that the ray hits, and that must therefore be tested."""
    return (sum(1 << i for i, hit in enumerate(ray.golden.bounces[place.bounce].hits[:, 0]) if hit),)


def from_the_centre(ray: Ray, place: Place) -> Sequence[int]:
    """Columns to the right of the screen's centre, of the first unit's column, and rows above the horizon."""
    screen = ray.config.screen_geometry
    return ray.offset * ray.config.units - screen.centre_column, screen.horizon_row - ray.row


def rect_probe(
    quantity: str, scope: str, group: str, record: Record, event: str, which: Callable[[Ray, Place], int], *,
    late: int = 0, leave_out: Collection[str] = (), more: Callable[[Ray, Place], Mapping[str, Value]] | None = None,
) -> Probe:  # fmt: skip
    """Probe the fields of a record that describes a rectangle.

    Args:
        quantity: name of the quantity.
        scope: the instance.
        group: the record in it.
        record: a record with the group's layout.
        event: as in `Probe`.
        which: the rectangle that the record describes at a place, or -1 for don't care.
        late: as in `Probe`.
        leave_out: fields that are not compared.
        more: values of the fields that `Ray.rect_fields` lacks, by name.
    """
    names = [name for name in record.layout if name not in leave_out]

    def golden(ray: Ray, place: Place) -> Sequence[Value] | None:
        index = which(ray, place)
        if index < 0:
            return None
        known: dict[str, Value] = {**ray.rect_fields(index), **(more(ray, place) if more else {})}
        return [known[name] for name in names]

    def numbers(chosen: Callable[[str], bool]) -> tuple[int, ...]:
        return tuple(number for number, name in enumerate(names) if chosen(name))

    return Probe(
        quantity, fields(scope, group, names, record), event, golden, late=late, parts=names, shown=False,
        signed=numbers(lambda name: isinstance(record.layout[name], Signed)),
        colour=numbers(lambda name: name.startswith("colour")),
    )  # fmt: skip


def indexed(ray: Ray, place: Place) -> int:
    """Return the place's own rectangle."""
    return place.index


def share(ray: Ray, place: Place) -> Sequence[int]:
    """Weight of a ray's colour in its pixel, as colour_share codes it."""
    parts = 4 if ray.config.materials else 2
    weight = left = parts**ray.config.most_reflections
    for bounce in range(place.bounce + 1):
        winner = ray.winner(bounce)
        mirrored = int(ray.rectangles.mirrors[winner]) if winner >= 0 else 0
        # Without materials a ray that hits nothing also passes half on, as its reflection has its colour.
        passed_on = left * mirrored // 4 if ray.config.materials else left // 2
        weight, left = (left - passed_on, passed_on) if bounce < ray.reflections else (left, 0)
    return (weight,)


def scene_probes(event: str, config: Configuration) -> list[Probe]:
    """Probes of the scene's registers, from an event on."""
    bus = f"{DUT}.avalon_interface_i.picture"
    record = Camera(config)
    names = list(record.layout)

    def camera(ray: Ray, place: Place) -> Sequence[Value]:
        scene, light = ray.scene, ray.scene.light
        vectors = {"": scene.camera.position, "light_": light.position if light else (None, None, None)}
        vectors |= dict(zip(("forward_", "right_", "up_"), scene.camera.basis, strict=True))
        known = {prefix + axis: one for prefix, parts in vectors.items() for axis, one in zip(AXES, parts, strict=True)}
        known |= {"light_on": int(bool(light)), "light_shade": light.quarters if light else None}
        return [known[name] for name in names]

    return [
        Probe("camera", fields(f"{DUT}.camera_mem_i", "camera", names, record), event, camera, shown=False, parts=names,
            signed=tuple(number for number, name in enumerate(names) if isinstance(record.layout[name], Signed))),
        Probe("background", (f"{bus}_background",), event, lambda ray, _: (ray.colour(-1),), shown=False, colour=True),
        Probe("reflections", (f"{bus}_reflections",), event, lambda ray, _: (ray.reflections,), shown=False),
    ]  # fmt: skip


def sync_in_the_picture(ray: Ray, place: Place) -> Sequence[int]:
    """Levels of HS, VS and BLANK_N at a visible pixel."""
    screen = ray.config.screen_geometry
    return int(not screen.horizontal.active_high), int(not screen.vertical.active_high), 1


def monitor_probes(renderer: str, port: str, video: str, config: Configuration) -> list[Probe]:
    """Probes of the pixel's last steps."""
    channels, bits = fields(renderer, port, COLOURS, Pixel(config.port_bits)), config.colour_bits

    def of_lane(ray: Ray, place: Place, *pixels: int) -> Sequence[int]:
        return [pixel >> ray.lane * bits & (1 << bits) - 1 for pixel in pixels]

    return [
        Probe("pixel to the monitor", channels, "shown", Ray.channels, parts=COLOURS, narrow=True, decode=of_lane),
        Probe("pins", tuple(f"{video}.{name}" for name in PINS), "shown", Ray.channels, late=1, parts=COLOURS,
            narrow=True, decode=of_lane),
        Probe("sync at this pixel", tuple(f"{video}.vga_{name}" for name in ("hs", "vs", "blank_n")), "shown",
            sync_in_the_picture, late=1, shown=False, parts=("HS", "VS", "BLANK_N")),
    ]  # fmt: skip


def shown_events(samples: Samples, ray: Ray, video: str, after: int) -> list[Event]:
    """Find when the pixel first goes to the pins after a cycle."""
    screen = ray.config.screen_geometry
    x, y, ends = (samples.values[f"{video}.{name}"] for name in ("x", "y", "pixel_end"))
    place = ray.column * screen.doubling // screen.pixels_per_clock, ray.row * screen.doubling
    # The position is signed, and as wide as its range.
    bits = [max(span.visible - 1, span.blank - 1).bit_length() + 1 for span in (screen.beats, screen.vertical)]
    for cycle in range(after, len(samples.times_ns)):
        if ends[cycle] and (signed(x[cycle], bits[0]), signed(y[cycle], bits[1])) == place:
            return [Event("shown", cycle, Place(ray.reflections))]
    return []


class UnitProbes(Description):
    """The part of a description that does not depend on how a unit computes.

    Attributes:
        modules: module names of the control and of a unit.
        steps: steps of the control for each tested rectangle, in order, by kind of event.
    """

    video = VIDEO
    modules: tuple[str, str]
    steps: Mapping[str, str] = {"write": "write_z_buf"}

    def __init__(self, config: Configuration, unit: int):
        self.config = config
        control_module, unit_module = self.modules
        self.caster = f"{RENDERER}.ray_caster_i"
        self.control = f"{self.caster}.{control_module}_i"
        self.sequencer = f"{self.control}.ray_sequencer_i"
        self.unit = f"{self.caster}.{numbered(unit_module, unit, config.units)}"
        self.buffer = f"{RENDERER}.{numbered('line_buffer', unit, config.units)}"
        self.light_controls = ("from_light", "steps_aim", "steps_write_shadow") if config.light else ()
        self.states = [f"{self.sequencer}.{name}" for name in ("state", "bounce")]
        steps = f"{self.sequencer}.steps"
        names = ("enable", "restart", "reset_delay", "reset_ray_caster", "line_buf_sel", "picture_run")
        self.diagrams = [
            *(f"{RENDERER}.{name}" for name in names),
            *(f"{VIDEO}.scan_{name}" for name in ("start_screen", "start_row")),
            *(f"{steps}_{name}" for name in ("initial_ray", "reset_colour", "reset_z_buf")),
            f"{self.buffer}.write_address",
        ]
        self.event_names = {
            "start": ("group started", f"{steps}_screen_to_ray"),
            "ray": ("ray kept", f"{steps}_store_ray"),
            "find": ("rectangle tested", f"{self.sequencer}.rect_sequencer_i.starting"),
            "write": ("hit offered", f"{self.control}.steps_write_z_buf"),
            "aimed": ("shadow ray computed", f"{self.control}.steps_aim"),
            "light write": ("shadow tested", f"{self.control}.shadow_sequencer_i.from_light"),
            "blend": ("colour added", f"{steps}_add_colour"),
            "done": ("group done", f"{self.sequencer}.done"),
            "shown": ("pixel shown", f"{VIDEO}.y"),
        }

    def controls(self) -> Iterable[str]:
        """List the signals that `events` reads."""
        steps = ("screen_to_ray", "find_intersection", "add_colour", "store_ray")
        return [
            *(f"{RENDERER}.place_{name}" for name in ("row", "column_offset")),
            *(f"{self.sequencer}.{name}" for name in ("done", "rects_fetch", "rects_index")),
            *(f"{self.sequencer}.steps_{name}" for name in steps),
            *(f"{self.control}.steps_{name}" for name in self.steps.values()),
            *[f"{self.sequencer}.early_out"] * ("load" in self.steps),
            *(f"{self.control}.{name}" for name in self.light_controls),
            *(f"{VIDEO}.{name}" for name in ("x", "y", "pixel_end")),
        ]

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """List the events that the golden model says must happen."""
        yield "start", Place(0)
        for bounce in range(ray.reflections + 1):
            if ray.alive(bounce):
                yield "ray", Place(bounce)
                for rectangle in range(len(ray.rectangles)):
                    place = Place(bounce, rectangle)
                    if ray.of_rectangle(place, "hits") or not self.config.culling:
                        yield "find", place
                        yield "write", place
                if ray.winner(bounce) >= 0 and ray.golden.shadings:
                    yield "aimed", Place(bounce)
                    if (shades := int(ray.golden.shadings[bounce].shades[0])) >= 0:
                        yield "light write", Place(bounce, shades)
            yield "blend", Place(bounce)
        yield "done", Place(ray.reflections)
        yield "shown", Place(ray.reflections)

    def events(self, samples: Samples, ray: Ray) -> list[Event]:
        """List what the hardware did for the pixel."""
        values, step = samples.values, f"{self.sequencer}.steps"
        places = (values[f"{RENDERER}.place_{name}"] for name in ("row", "column_offset"))
        begun = zip(values[f"{step}_screen_to_ray"], *places, strict=True)
        start = next((cycle for cycle, now in enumerate(begun) if now == (1, ray.row, ray.offset)), None)
        shown = shown_events(samples, ray, VIDEO, start or 0)
        if start is None:
            return shown
        events = [Event("start", start, Place(0)), Event("ray", start, Place(0))]
        bounce, at_hand = 0, None
        # Tests of the shadow ray are not tests of the unit's own ray.
        tried: dict[int, int] = {}
        tried_from_light: dict[int, int] = {}
        from_light, aim = (
            values.get(f"{self.control}.{name}", [0] * len(samples.times_ns)) for name in ("from_light", "steps_aim")
        )
        for cycle in range(start, len(samples.times_ns)):
            ends = values[f"{step}_add_colour"][cycle] == 1
            if values[f"{step}_find_intersection"][cycle] and at_hand is not None:
                (tried_from_light if from_light[cycle] else tried)[cycle] = at_hand
            if aim[cycle] == 1 << AIM_CYCLES - 1:
                events.append(Event("aimed", cycle, Place(bounce)))
            if values[f"{self.sequencer}.rects_fetch"][cycle]:
                at_hand = values[f"{self.sequencer}.rects_index"][cycle]
                # The next ray's first rectangle is fetched in the cycle in which a ray ends.
                events.append(Event("fetch", cycle, Place(bounce + int(ends), at_hand)))
            if ends:
                events += self._tried(samples, tried, {"find": "", **self.steps}, bounce, cycle)
                from_light_steps = {"light find": "", "light write": "write_shadow"}
                events += self._tried(samples, tried_from_light, from_light_steps, bounce, cycle)
                events.append(Event("blend", cycle, Place(bounce)))
                if values[f"{step}_store_ray"][cycle]:
                    events.append(Event("ray", cycle, Place(bounce + 1)))
                bounce, tried, tried_from_light = bounce + 1, {}, {}
            if values[f"{self.sequencer}.done"][cycle]:
                events.append(Event("done", cycle, Place(max(0, bounce - 1))))
                break
        known = [
            event
            for event in events
            if event.place.bounce <= ray.reflections and (event.place.rectangle or 0) < len(ray.rectangles)
        ]
        # The index is don't care when nothing is left to fetch.
        found = {event.place for event in known if event.kind == "find"}
        return [event for event in known if event.kind != "fetch" or event.place in found] + shown

    def _tried(
        self, samples: Samples, starts: Mapping[int, int], steps: Mapping[str, str], bounce: int, end: int
    ) -> Iterable[Event]:
        """Follow the rectangles whose tests were started through a unit's steps; one may wait for another.

        Args:
            samples: the waveform.
            starts: the tested rectangles, by cycle.
            steps: names of the control's steps in order, by kind of event; the first kind is the start.
            bounce: number of the ray.
            end: cycle in which the ray ends.
        """
        waiting: dict[str, list[int]] = {kind: [] for kind in steps}
        first = next(iter(steps))
        early_out = samples.values.get(f"{self.sequencer}.early_out")
        for cycle in range(min(starts, default=end), end):
            moved = [(first, starts[cycle])] if cycle in starts else []
            waiting[first] += [rectangle for _, rectangle in moved]
            for before, kind in reversed([*pairwise(waiting)]):
                if samples.values[f"{self.control}.steps_{steps[kind]}"][cycle] and waiting[before]:
                    waiting[kind].append(waiting[before].pop(0))
                    moved.append((kind, waiting[kind][-1]))
            if early_out and early_out[cycle] and waiting["load"]:
                waiting["load"].pop()
            yield from (Event(kind, cycle, Place(bounce, rectangle)) for kind, rectangle in moved)

    def first_probes(self) -> list[Probe]:
        """Probes from the scene's memories to the primary ray."""
        rects = f"{DUT}.rect_mem_i"
        generator = f"{self.unit}.{'turned_generator' if self.config.turn else 'ray_generator'}_i"
        if self.config.turn:
            components = [f"{generator}.{numbered('slope_component', number, 3)}" for number in range(3)]
            sizes, signs = (tuple(f"{one}.{name}" for one in components) for name in ("size", "negative"))
        else:
            sizes, signs = fields(generator, "slope", SIGNS), fields(generator, "initial_signs", SIGNS, Signs())
        culling = Probe(
            # The mask is don't care for rectangles that the scene does not have.
            "rectangles that may be hit", (f"{self.sequencer}.wanted",), "start", hit_mask,
            decode=lambda ray, place, wanted: (wanted & hit_mask(ray, place)[0],), module="group_culler", shown=False,
        )  # fmt: skip
        return [
            *scene_probes("start", self.config),
            Probe("usable rectangles", (f"{rects}.rects_usable",), "start",
                lambda ray, _: ((1 << len(ray.rectangles)) - 1,), shown=False),
            *([Probe("from the centre", (f"{generator}.column", f"{generator}.row"), "start", from_the_centre,
                signed=True, shown=False, parts=("column", "row"))] if self.config.turn else []),
            Probe("slope, magnitudes", sizes, "start",
                lambda ray, _: [abs(slope) for slope in ray.of_ray(0, "slopes")], late=1, parts=AXES),
            Probe("slope, signs", signs, "start", Ray.slope_signs, late=1, parts=AXES),
            Probe("comes from the camera", (f"{self.sequencer}.steps_initial_ray",), "ray",
                lambda _, place: (int(place.bounce == 0),), late=1, shown=False),
            rect_probe("rectangle", rects, "rects_rect", Rect(self.config), "fetch", indexed, late=1),
            *([culling] if self.config.culling else []),
        ]  # fmt: skip

    def last_probes(self, kept_colour: str, golden_colour: Read = Ray.found_colour) -> list[Probe]:
        """Probes from a ray's found rectangle to the pins.

        Args:
            kept_colour: the signal with the rectangle's colour.
            golden_colour: reads the golden model's value of it.
        """
        combiner, bits = f"{self.unit}.colour_combiner_i", 3 * self.config.colour_bits
        channels = tuple(f"{combiner}.colour_sum_{number}_i.blended" for number in range(3))

        def pixel(ray: Ray, _: Place) -> Sequence[int]:
            return (ray.pixel,)

        return [
            Probe("ended before", (f"{combiner}.missed",), "blend",
                lambda ray, place: (int(not ray.alive(place.bounce)),), shown=False),
            Probe("found", (kept_colour.rpartition(".")[0] + ".found",), "blend", Ray.found),
            Probe("its colour", (kept_colour,), "blend", golden_colour, colour=True),
            Probe("colour seen", (f"{combiner}.ray_colour_word",), "blend", Ray.seen_colour, colour=True),
            Probe("share in the pixel", (f"{combiner}.colour_share_i.share",), "blend", share, shown=False),
            Probe("means of the channels", channels, "done", Ray.channels, parts=COLOURS, narrow=True),
            Probe("pixel", (f"{combiner}.pixel_word",), "done", pixel, colour=True, narrow=True),
            Probe("pixel among all", (f"{self.caster}.pixels",), "done", pixel, colour=True, narrow=True,
                decode=lambda ray, _, pixels: (pixels >> ray.unit * bits & (1 << bits) - 1,)),
            Probe("pixel from the line buffer", (f"{self.buffer}.pixel_out",), "shown", pixel, colour=True,
                narrow=True),
            *monitor_probes(RENDERER, "pixel", VIDEO, self.config),
        ]  # fmt: skip
