# SPDX-License-Identifier: MIT
"""Probes of all engines with ray units and a line buffer: the units' life cycle, and a pixel's path to the pins."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

from raycaster.configuration import Configuration
from raycaster.debug.probes import AXES, COLOURS, DUT, PINS, fields, numbered
from raycaster.debug.probes.ray import Description, Event, Place, Probe, Ray, Read
from raycaster.debug.waves import Samples, signed
from raycaster.rtl.common.records import Pixel, Signs, camera_of, rect_of

RENDERER = f"{DUT}.ray_caster_renderer_i"
RECT_FIELDS = ("axis", "position", "u_low", "u_high", "v_low", "v_high", "colour")
SIGNS = ("dx", "dy", "dz")
VIDEO = f"{RENDERER}.video_generator_i"


def hit_mask(ray: Ray, place: Place) -> Sequence[int]:
    """Mask of the rectangles that the ray hits, and that must therefore be tested."""
    return (sum(1 << i for i, hit in enumerate(ray.golden.bounces[place.bounce].hits[:, 0]) if hit),)


def scene_probes(event: str, config: Configuration) -> list[Probe]:
    """Probes of the scene's registers, from an event on."""
    bus = f"{DUT}.avalon_interface_i.picture"
    camera = fields(f"{DUT}.camera_mem_i", "camera", AXES, camera_of(config))
    return [
        Probe("camera", camera, event, lambda ray, _: ray.scene.camera.position, shown=False, parts=AXES),
        Probe("background", (f"{bus}_background",), event, lambda ray, _: (ray.colour(-1),), shown=False, colour=True),
        Probe("reflections", (f"{bus}_reflections",), event, lambda ray, _: (ray.reflections,), shown=False),
    ]


def monitor_probes(renderer: str, port: str, video: str, config: Configuration) -> list[Probe]:
    """Probes of the pixel's last steps."""
    channels = fields(renderer, port, COLOURS, Pixel(config.colour_bits))
    return [
        Probe("pixel to the monitor", channels, "shown", Ray.channels, parts=COLOURS),
        Probe("pins", tuple(f"{video}.{name}" for name in PINS), "shown", Ray.channels, late=1, parts=COLOURS),
    ]


def shown_events(samples: Samples, ray: Ray, video: str, after: int) -> list[Event]:
    """Find when the pixel first goes to the pins after a cycle."""
    screen = ray.config.screen_geometry
    x, y, ends = (samples.values[f"{video}.{name}"] for name in ("x", "y", "pixel_end"))
    place = ray.column * screen.doubling, ray.row * screen.doubling
    # The position is signed, and as wide as its range.
    bits = [max(span.visible - 1, span.blank - 1).bit_length() + 1 for span in (screen.horizontal, screen.vertical)]
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
            *[f"{self.control}.from_light"] * self.config.light,
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
        tried: dict[int, int] = {}
        # Tests of the shadow ray are not tests of the unit's own ray.
        from_light = values.get(f"{self.control}.from_light", [0] * len(samples.times_ns))
        for cycle in range(start, len(samples.times_ns)):
            ends = values[f"{step}_add_colour"][cycle] == 1
            if values[f"{step}_find_intersection"][cycle] and at_hand is not None and not from_light[cycle]:
                tried[cycle] = at_hand
            if values[f"{self.sequencer}.rects_fetch"][cycle]:
                at_hand = values[f"{self.sequencer}.rects_index"][cycle]
                # The next ray's first rectangle is fetched in the cycle in which a ray ends.
                events.append(Event("fetch", cycle, Place(bounce + int(ends), at_hand)))
            if ends:
                events += self._tried(samples, tried, bounce, cycle)
                events.append(Event("blend", cycle, Place(bounce)))
                if values[f"{step}_store_ray"][cycle]:
                    events.append(Event("ray", cycle, Place(bounce + 1)))
                bounce, tried = bounce + 1, {}
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

    def _tried(self, samples: Samples, starts: Mapping[int, int], bounce: int, end: int) -> Iterable[Event]:
        """Follow the rectangles that were tested for a ray through the unit's steps; one may wait for another."""
        waiting: dict[str, list[int]] = {kind: [] for kind in ("find", *self.steps)}
        early_out = samples.values.get(f"{self.sequencer}.early_out")
        for cycle in range(min(starts, default=end), end):
            moved = [("find", starts[cycle])] if cycle in starts else []
            waiting["find"] += [rectangle for _, rectangle in moved]
            for before, kind in reversed([*pairwise(waiting)]):
                if samples.values[f"{self.control}.steps_{self.steps[kind]}"][cycle] and waiting[before]:
                    waiting[kind].append(waiting[before].pop(0))
                    moved.append((kind, waiting[kind][-1]))
            if early_out and early_out[cycle] and waiting["load"]:
                waiting["load"].pop()
            yield from (Event(kind, cycle, Place(bounce, rectangle)) for kind, rectangle in moved)

    def first_probes(self) -> list[Probe]:
        """Probes from the scene's memories to the primary ray."""
        rects = f"{DUT}.rect_mem_i"
        generator = f"{self.unit}.{'turned_generator' if self.config.turn else 'ray_generator'}_i"
        culling = Probe(
            # The mask is don't care for rectangles that the scene does not have.
            "rectangles that may be hit", (f"{self.sequencer}.wanted",), "start", hit_mask,
            decode=lambda ray, place, wanted: (wanted & hit_mask(ray, place)[0],), module="group_culler", shown=False,
        )  # fmt: skip
        return [
            *scene_probes("start", self.config),
            Probe("usable rectangles", (f"{rects}.rects_usable",), "start",
                lambda ray, _: ((1 << len(ray.rectangles)) - 1,), shown=False),
            Probe("slope, magnitudes", fields(generator, "slope", SIGNS), "start",
                lambda ray, _: [abs(slope) for slope in ray.of_ray(0, "slopes")], late=1, parts=AXES),
            Probe("slope, signs", fields(generator, "initial_signs", SIGNS, Signs()), "start", Ray.slope_signs, late=1,
                parts=AXES),
            Probe("comes from the camera", (f"{self.sequencer}.steps_initial_ray",), "ray",
                lambda _, place: (int(place.bounce == 0),), late=1, shown=False),
            Probe("rectangle", fields(rects, "rects_rect", RECT_FIELDS, rect_of(self.config)), "fetch",
                Ray.sorted_rect, late=1, colour=(6,), shown=False),
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
            Probe("means of the channels", channels, "done", Ray.channels, parts=COLOURS),
            Probe("pixel", (f"{combiner}.pixel_word",), "done", pixel, colour=True),
            Probe("pixel among all", (f"{self.caster}.pixels",), "done", pixel, colour=True,
                decode=lambda ray, _, pixels: (pixels >> ray.unit * bits & (1 << bits) - 1,)),
            Probe("pixel from the line buffer", (f"{self.buffer}.pixel_out",), "shown", pixel, colour=True),
            *monitor_probes(RENDERER, "pixel", VIDEO, self.config),
        ]  # fmt: skip
