# SPDX-License-Identifier: MIT
"""What the engines with ray units and a line buffer have in common: their life cycle, and a pixel's way to the pins."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from raycaster.configuration import Configuration
from raycaster.debug.probes.ray import (
    AXES,
    DUT,
    Event,
    Place,
    Probe,
    Ray,
    Value,
    channels_of,
    fields,
    unit_name,
)
from raycaster.debug.waves import Samples, signed
from raycaster.rtl.common.records import Pixel, Point, Rect, Signs

RENDERER = f"{DUT}.ray_caster_renderer_i"
RECT_FIELDS = ("axis", "position", "u_low", "u_high", "v_low", "v_high", "colour")
SIGNS = ("dx", "dy", "dz")
VIDEO = f"{RENDERER}.video_generator_i"
COLOURS = ("red", "green", "blue")
PINS = ("vga_r", "vga_g", "vga_b")


def camera(ray: Ray, place: Place) -> Sequence[Value]:
    """The camera's position."""
    return ray.scene.camera.position


def sorted_rect(ray: Ray, place: Place) -> Sequence[Value]:
    """A rectangle's fields as the hardware sorts them."""
    axis, position, bounds = ray.plane(place)
    return axis, position, *bounds, ray.colour(place.rectangle)


def slope_signs(ray: Ray, place: Place) -> Sequence[Value]:
    """Which components of the slope are negative; nothing of a ray that is lost, or a component that is 0."""
    if not ray.alive(place.bounce):
        return 3 * (None,)
    return [None if slope == 0 else int(slope < 0) for slope in ray.of_ray(place.bounce, "slopes")]


def slope_magnitudes(ray: Ray, place: Place) -> Sequence[Value]:
    """The slope without its signs."""
    return [abs(slope) for slope in ray.of_ray(0, "slopes")]


def seen_colour(ray: Ray, place: Place) -> Sequence[Value]:
    """What a ray sees, background included."""
    return (ray.colour(ray.winner(place.bounce)),)


def found(ray: Ray, place: Place) -> Sequence[Value]:
    """Whether a ray has hit anything; nothing of one that is lost."""
    return (int(ray.winner(place.bounce) >= 0) if ray.alive(place.bounce) else None,)


def found_colour(ray: Ray, place: Place) -> Sequence[Value]:
    """The colour of what a ray has hit; nothing for a miss."""
    winner = ray.winner(place.bounce)
    return (ray.colour(winner) if winner >= 0 else None,)


def nearest_found(ray: Ray, place: Place) -> Sequence[Value]:
    """Whether any rectangle up to this one is hit; nothing of a ray that is lost."""
    return (int(ray.nearest(place) >= 0) if ray.alive(place.bounce) else None,)


def pixel(ray: Ray, place: Place) -> Sequence[Value]:
    """The pixel's colour."""
    return (ray.pixel,)


def pixel_channels(ray: Ray, place: Place) -> Sequence[Value]:
    """Its three channels."""
    return channels_of(ray.pixel, ray.config.colour_bits)


def video_signals(video: str) -> list[str]:
    """What a viewer shows of a video generator."""
    pins = (*(f"{name}:hex" for name in PINS), "vga_hs", "vga_vs", "vga_blank_n", "vga_clk")
    return [f"{video}.{name}" for name in ("x:signed", "y:signed", "scan_next_column", *pins)]


def bus_signals() -> list[str]:
    """What a viewer shows of the bus."""
    words = ("address", "read", "write", "writedata:hex", "byteenable:hex", "readdata:hex", "readdatavalid")
    return [*(f"{DUT}.avs_s0_{name}" for name in (*words, "waitrequest")), f"{DUT}.irq"]


def shown_events(samples: Samples, ray: Ray, video: str, after: int) -> list[Event]:
    """When the pixel was on its way to the pins, for the first time after a cycle."""
    screen = ray.config.screen_geometry
    x, y, ends = (samples.values[f"{video}.{name}"] for name in ("x", "y", "pixel_end"))
    place = ray.column * screen.doubling, ray.row * screen.doubling
    # The position is signed, and as wide as its range.
    bits = [max(span.visible - 1, span.blank - 1).bit_length() + 1 for span in (screen.horizontal, screen.vertical)]
    for cycle in range(after, len(samples.times_ns)):
        if ends[cycle] and (signed(x[cycle], bits[0]), signed(y[cycle], bits[1])) == place:
            return [Event("shown", cycle, Place(ray.reflections))]
    return []


class UnitProbes:
    """The part of a description that does not depend on how a unit computes."""

    def __init__(self, config: Configuration, unit: int, control: str, unit_module: str):
        """Name everything.

        Args:
            config: the design.
            unit: which one has the pixel.
            control: the control's instance.
            unit_module: the name of the unit's module.
        """
        self.config = config
        self.caster = f"{RENDERER}.ray_caster_i"
        self.control = f"{self.caster}.{control}"
        self.sequencer = f"{self.control}.ray_sequencer_i"
        self.unit = f"{self.caster}.{unit_name(unit_module, config, unit)}"
        self.generator = f"{self.unit}.ray_generator_i"
        self.combiner = f"{self.unit}.colour_combiner_i"
        self.buffer = f"{RENDERER}.{unit_name('line_buffer', config, unit)}"
        self.rects = f"{DUT}.rect_mem_i"
        steps = f"{self.sequencer}.steps"
        self.tells = {
            "start": ("the group starts", f"{steps}_screen_to_ray"),
            "ray": ("the ray is kept", f"{steps}_store_ray"),
            "find": ("the rectangle is tried", f"{self.sequencer}.rect_sequencer_i.starting"),
            "write": ("the hit is offered", f"{self.control}.steps_write_z_buf"),
            "blend": ("the colour is added", f"{steps}_add_colour"),
            "done": ("the group is done", f"{self.sequencer}.done"),
            "shown": ("the pixel is shown", f"{VIDEO}.y"),
        }

    def named(self, signal: str, place: Place, ray: Ray) -> str:
        """The whole name, which probes have already."""
        return signal

    def groups(self, ray: Ray) -> dict[str, Sequence[str]]:
        """For viewers: signals by group."""
        strobes = ("screen_to_ray", "initial_ray", "find_intersection", "add_colour", "store_ray", "reset_z_buf")
        buffer = ("write", "write_address", "pixel_in:hex", "read_address", "pixel_out:hex")
        return {
            "control": [
                "bench.clk",
                *(f"{RENDERER}.scan_{name}" for name in ("start_screen", "start_row")),
                *(f"{RENDERER}.place_{name}" for name in ("row", "column_offset")),
                *(f"{RENDERER}.{name}" for name in ("reset_ray_caster", "enable", "done")),
                *(f"{self.sequencer}.{name}" for name in ("state", "bounce", "rects_index")),
                *(f"{self.sequencer}.steps_{name}" for name in strobes),
                f"{self.control}.steps_write_z_buf",
            ],
            "ray unit": [
                *fields(self.generator, "slope", SIGNS),
                *self.unit_signals,
                f"{self.combiner}.seen_word:hex",
                f"{self.combiner}.pixel_word:hex",
            ],
            "line buffer": [f"{self.buffer}.{name}" for name in buffer],
            "video": video_signals(VIDEO),
            "bus": bus_signals(),
        }

    unit_signals: Sequence[str] = ()
    """What of a unit a viewer shows beside its slope and its colours."""

    def controls(self) -> Iterable[str]:
        """The signals that `events` reads."""
        steps = ("screen_to_ray", "find_intersection", "add_colour", "store_ray")
        return [
            f"{RENDERER}.place_row",
            f"{RENDERER}.place_column_offset",
            f"{self.sequencer}.done",
            *(f"{self.sequencer}.steps_{name}" for name in steps),
            f"{self.control}.steps_write_z_buf",
            f"{self.sequencer}.rects_fetch",
            f"{self.sequencer}.rects_index",
            f"{VIDEO}.x",
            f"{VIDEO}.y",
            f"{VIDEO}.pixel_end",
        ]

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """The events that golden knows must happen."""
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
        """What the hardware did for the pixel."""
        values, step = samples.values, f"{self.sequencer}.steps"
        places = (values[f"{RENDERER}.place_{name}"] for name in ("row", "column_offset"))
        begun = zip(values[f"{step}_screen_to_ray"], *places, strict=True)
        start = next((cycle for cycle, now in enumerate(begun) if now == (1, ray.row, ray.offset)), None)
        shown = shown_events(samples, ray, VIDEO, start or 0)
        if start is None:
            return shown
        events = [Event("start", start, Place(0)), Event("ray", start, Place(0))]
        bounce, at_hand = 0, None
        tried: list[tuple[int, int]] = []
        for cycle in range(start, len(samples.times_ns)):
            ends = values[f"{step}_add_colour"][cycle] == 1
            if values[f"{step}_find_intersection"][cycle] and at_hand is not None:
                tried.append((cycle, at_hand))
            if values[f"{self.sequencer}.rects_fetch"][cycle]:
                at_hand = values[f"{self.sequencer}.rects_index"][cycle]
                # In the cycle in which a ray ends, the next one's first is fetched.
                events.append(Event("fetch", cycle, Place(bounce + int(ends), at_hand)))
            if ends:
                events += self._tried(samples, tried, bounce, cycle)
                events.append(Event("blend", cycle, Place(bounce)))
                if values[f"{step}_store_ray"][cycle]:
                    events.append(Event("ray", cycle, Place(bounce + 1)))
                bounce, tried = bounce + 1, []
            if values[f"{self.sequencer}.done"][cycle]:
                events.append(Event("done", cycle, Place(max(0, bounce - 1))))
                break
        known = [
            event
            for event in events
            if event.place.bounce <= ray.reflections and (event.place.rectangle or 0) < len(ray.rectangles)
        ]
        # Where nothing is left to fetch, the index means nothing.
        found = {event.place for event in known if event.kind == "find"}
        return [event for event in known if event.kind != "fetch" or event.place in found] + shown

    def _tried(self, samples: Samples, tried: list[tuple[int, int]], bounce: int, end: int) -> list[Event]:
        """What became of the rectangles that a ray was tried against, in their order."""
        raise NotImplementedError

    def first_probes(self) -> list[Probe]:
        """From the scene's memories to the primary ray."""
        sorter = fields(f"{self.rects}.rect_sorter_i", "rect", RECT_FIELDS, Rect())
        rect = fields(self.rects, "rects_rect", RECT_FIELDS, Rect())
        signs = fields(self.generator, "initial_signs", SIGNS, Signs())
        probes = [
            Probe("camera", fields(f"{DUT}.camera_mem_i", "camera", AXES, Point()), "start", camera, shown=False),
            Probe(
                "background",
                (f"{DUT}.avalon_interface_i.picture_background",),
                "start",
                lambda ray, place: (ray.colour(-1),),
                shown=False,
                colour=True,
            ),
            Probe(
                "reflections",
                (f"{DUT}.avalon_interface_i.picture_reflections",),
                "start",
                lambda ray, place: (ray.reflections,),
                shown=False,
            ),
            Probe(
                "usable rectangles",
                (f"{self.rects}.rects_usable",),
                "start",
                lambda ray, place: ((1 << len(ray.rectangles)) - 1,),
                shown=False,
            ),
            Probe("slope, magnitudes", fields(self.generator, "slope", SIGNS), "start", slope_magnitudes, late=1),
            Probe("slope, signs", signs, "start", slope_signs, late=1),
            Probe(
                "comes from the camera",
                (f"{self.sequencer}.steps_initial_ray",),
                "ray",
                lambda ray, place: (int(place.bounce == 0),),
                late=1,
                shown=False,
            ),
            Probe("rectangle, sorted", sorter, "fetch", sorted_rect, shown=False),
            Probe("rectangle", rect, "fetch", sorted_rect, late=1, shown=False),
        ]
        if self.config.culling:
            probes.append(
                # For those that the scene has not got, the mask is don't care.
                Probe(
                    "rectangles that may be hit",
                    (f"{self.sequencer}.wanted",),
                    "start",
                    _hit_mask,
                    decode=lambda ray, place, wanted: (wanted & _hit_mask(ray, place)[0],),
                    module="group_culler",
                    shown=False,
                )
            )
        return probes

    def last_probes(self, kept_colour: str) -> list[Probe]:
        """From what a ray has found, of which the colour's signal is given, to the pins."""
        channels = [f"{self.combiner}.colour_channel_{number}_i" for number in range(3)]
        bits = self.config.colour_bits
        unit_pixel = 3 * bits

        def one_of(ray: Ray, place: Place, pixels: int) -> Sequence[Value]:
            return ((pixels >> ray.unit * unit_pixel) & ((1 << unit_pixel) - 1),)

        group = tuple(f"{RENDERER}.{name}" for name in ("read_offset", "read_unit"))
        return [
            Probe("found", (kept_colour.rpartition(".")[0] + ".found",), "blend", found),
            Probe("its colour", (kept_colour,), "blend", found_colour, colour=True),
            Probe("colour seen", (f"{self.combiner}.seen_word",), "blend", seen_colour, colour=True),
            Probe(
                "sums of the channels",
                tuple(f"{channel}.total" for channel in channels),
                "blend",
                lambda ray, place: ray.sums(place.bounce),
                late=1,
            ),
            Probe("means of the channels", tuple(f"{channel}.blended" for channel in channels), "done", pixel_channels),
            Probe("pixel", (f"{self.combiner}.pixel_word",), "done", pixel, colour=True),
            Probe("pixel among all", (f"{self.caster}.pixels",), "done", pixel, decode=one_of, colour=True),
            Probe("pixel to the line buffer", (f"{self.buffer}.pixel_in",), "done", pixel, colour=True),
            Probe("place in the line buffer", group, "shown", lambda ray, place: (ray.offset, ray.unit), shown=False),
            Probe("pixel from the line buffer", (f"{self.buffer}.pixel_out",), "shown", pixel, colour=True),
            Probe("pixel to the monitor", fields(RENDERER, "pixel", COLOURS, Pixel(bits)), "shown", pixel_channels),
            Probe("pins", tuple(f"{VIDEO}.{name}" for name in PINS), "shown", pixel_channels, late=1),
        ]


def _hit_mask(ray: Ray, place: Place) -> Sequence[int]:
    """The rectangles that the ray hits, a bit each: those that must be tried."""
    hits = ray.golden.bounces[place.bounce].hits[:, 0]
    return (sum(1 << i for i, hit in enumerate(hits) if hit),)
