# SPDX-License-Identifier: MIT
"""Compare one ray's life in a waveform with the golden model: the part that the engines' descriptions share.

A description says which signals hold a value at which event of the control, and what the golden model says the value
is. Events come from strobes and states in the waveform itself; a register shows the value that it captures at an event
from the next cycle.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, SupportsInt

import numpy as np

from raycaster.configuration import CHANNEL_BITS
from raycaster.debug.probes import COLOURS, DUT, PINS, module_of
from raycaster.debug.waves import Samples, Waves, signed
from raycaster.design.for_scene import Design
from raycaster.errors import UserError
from raycaster.golden.colour import hit_colours
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import shown
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import BASIS_SCALE, CELLS, UNTURNED

VIDEO_SIGNALS = ("x:signed", "y:signed", *(f"{pin}:hex" for pin in PINS), "vga_hs", "vga_vs", "vga_blank_n", "vga_clk")
BUS_SIGNALS = (
    *(f"avs_s0_{name}" for name in ("address", "read", "write", "writedata:hex", "byteenable:hex", "readdata:hex")),
    *("avs_s0_readdatavalid", "avs_s0_waitrequest", "irq"),
)

ENDS = ("blend", "done")
"""Events after which a ray sees nothing more."""

OF_LOST_RAYS = (*ENDS, "shown")
"""Events that are compared even for a ray after a miss."""

Number = int | Fraction | None
"""A value without rounding; None if there is none."""

Value = Number | str
"""A value to compare; None is don't care, and equals everything."""


@dataclass(frozen=True)
class Place:
    """A moment of a ray's life: the bounce is 0 for the primary ray, then one more per reflection."""

    bounce: int
    rectangle: int | None = None

    @property
    def index(self) -> int:
        """Index of the place's rectangle, which must exist."""
        if self.rectangle is None:
            raise ValueError("the place has no rectangle")
        return self.rectangle


@dataclass(frozen=True)
class Event:
    """Something that the hardware did; the cycle is the index of the sample that has its values."""

    kind: str
    cycle: int
    place: Place
    golden: Mapping[str, Value] = field(default_factory=dict)
    """The golden model's values, by the names of a probe's parts, of probes that do not read them themselves."""


Read = Callable[["Ray", Place], Sequence[Value] | None]
"""Function for the golden model's values at a place, in the order of the signals; None if all are don't care."""


@dataclass(frozen=True)
class Probe:
    """A quantity: the signals that hold it in the hardware, and the golden model's value.

    Attributes:
        quantity: name of the quantity.
        signals: full names; a difference is blamed on the module with the signal.
        event: kind of event after which the signals hold the value.
        golden: the golden model's value; None if the event has it.
        late: cycles from the event until the signals hold the value.
        decode: function of the ray, the place and the samples that returns the values; None if the samples are the
            values.
        signed: True if the signals are in two's complement, or the indices of those that are.
        true: value without any rounding, if rounding can change it.
        scale: True if the values are in units of 2^-F.
        colour: True if the values are colours, or the indices of those that are.
        narrow: True if colours have the design's bits per channel instead of 8.
        parts: names of the values, if the quantity does not name them.
        module: module that a difference is blamed on, if not the one that contains the signal.
        shown: True if the table shows the value even when it is right.
    """

    quantity: str
    signals: tuple[str, ...]
    event: str
    golden: Read | None = None
    late: int = 0
    decode: Callable[..., Sequence[Value]] | None = None
    signed: bool | tuple[int, ...] = False
    true: Callable[[Ray, Place], Sequence[Number]] | None = None
    scale: bool = False
    colour: bool | tuple[int, ...] = False
    narrow: bool = False
    parts: Sequence[str] = ()
    module: str = ""
    shown: bool = True

    @property
    def is_channels(self) -> bool:
        """True if the values are the channels of one colour."""
        return tuple(self.parts) == COLOURS

    def is_signed(self, number: int) -> bool:
        """True if the signal with this index is in two's complement."""
        return self.signed is True or bool(self.signed and number in self.signed)

    def is_colour(self, number: int) -> bool:
        """True if the value with this index is a colour."""
        return self.colour is True or bool(self.colour and number in self.colour)


@dataclass(frozen=True)
class Reading:
    """A probe's values at one event, from the golden model and from the hardware; time_ns is the start of the cycle."""

    probe: Probe
    place: Place
    cycle: int
    time_ns: float
    golden: tuple[Value, ...]
    found: tuple[Value, ...]

    @property
    def wrong(self) -> int | None:
        """Index of the first component that differs from the golden model; None if all agree."""
        pairs = zip(self.golden, self.found, strict=True)
        return next((i for i, (golden, found) in enumerate(pairs) if golden is not None and golden != found), None)

    @property
    def signal(self) -> str:
        """Name of the wrong signal, or of the first one."""
        signals = self.probe.signals
        return signals[min(self.wrong or 0, len(signals) - 1)]

    @property
    def module(self) -> str:
        """Module that a difference is blamed on."""
        return self.probe.module or module_of(self.signal)


class Description:
    """Base class of the engines' descriptions.

    Attributes:
        probes: probes in the order in which values depend on each other.
        event_names: each kind of event's name, and the signal that shows it.
        video: instance of the video generator.
        states: signals that a viewer shows, although they are neither events nor values.
        diagrams: signals that only the manual's timing diagrams show.
    """

    probes: Sequence[Probe]
    event_names: Mapping[str, tuple[str, str]]
    video: str
    states: Sequence[str] = ()
    diagrams: Sequence[str] = ()

    def signals(self, name: str) -> tuple[str, ...]:
        """Return the full names of the signals of a quantity, or of the control's only signal of this name."""
        for probe in self.probes:
            if probe.quantity == name:
                return probe.signals
        found = {signal for signal in (*self.controls(), *self.diagrams) if signal.endswith(f".{name}")}
        if len(found) != 1:
            raise ValueError(f"{name}: expected a quantity or a signal, got {sorted(found)}")
        return tuple(found)

    def events(self, samples: Samples, ray: Ray) -> list[Event]:
        """List what the hardware did for the pixel."""
        raise NotImplementedError

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """List the events, by kind and place, that the golden model says must happen."""
        raise NotImplementedError

    def controls(self) -> Iterable[str]:
        """List the signals that `events` reads."""
        raise NotImplementedError

    def groups(self) -> Mapping[str, Sequence[str]]:
        """Group the signals for a viewer, by group name: full names, with `:signed` or `:hex` after those that are not
        unsigned numbers or single bits."""
        values = []
        for probe in self.probes:
            for number, signal in enumerate(probe.signals):
                kind = ":hex" if probe.is_colour(number) else ":signed" if probe.is_signed(number) else ""
                values.append(signal + kind)
        listed: dict[str, tuple[str, str]] = {}
        for group, signals in {
            "video": [f"{self.video}.{name}" for name in VIDEO_SIGNALS],
            "bus": [f"{DUT}.{name}" for name in BUS_SIGNALS],
            "control": ["bench.clk", *self.states, *self.controls()],
            "values": values,
        }.items():
            for signal in signals:
                listed.setdefault(re.sub(":[a-z]+$", "", signal), (group, signal))
        order = ("control", "values", "video", "bus")
        return {name: [signal for group, signal in listed.values() if group == name] for name in order}


class Ray:
    """The golden model's knowledge of one pixel."""

    def __init__(self, design: Design, row: int, column: int):
        """Trace the pixel's rays.

        Raises:
            UserError: there is no such pixel.
        """
        self.design, self.config, self.scene = design, design.configuration, design.scene
        screen = self.config.screen_geometry
        if not (0 <= row < screen.rows and 0 <= column < screen.columns):
            raise UserError(
                f"pixel: expected column from 0 to {screen.columns - 1} and row from 0 to {screen.rows - 1}, "
                f"got {column},{row}"
            )
        self.row, self.column = row, column
        self.offset, self.unit = divmod(column, self.config.units)
        """Group that the pixel is in, and the ray unit that computes it; see the seed engine's ray_generator."""
        if self.config.facts.whole_frames:
            self.unit = row % self.config.units
        self.lane = column * screen.doubling % screen.pixels_per_clock
        """Number of the pixel among those of its clock, 0 for the left one."""
        self.reflections = design.reflections
        fixed, every = self.config.fixed, Rectangles.of_scene(self.scene)
        self.rectangles = Rectangles.of_fixed(fixed.rectangles) if fixed else every
        """Those of the hardware, which lacks some of a scene that is built in."""
        self._names = [one.name for one in self.scene.rect]
        if fixed:
            bounds = (
                [(*low, *high) for low, high in zip(one.low, one.high, strict=True)] for one in (every, self.rectangles)
            )
            places = enumerate(next(bounds))
            self._names = [next(self._names[i] for i, one in places if one == own) for own in next(bounds)]
        basis = self.scene.camera.basis
        self.row_slopes = primary_slopes(screen, basis)[row]
        """int64 (columns, 3): slopes of the primary rays of the pixel's row, as long as in the hardware."""
        if self.config.turn and basis == UNTURNED:
            # The golden model uses shorter slopes then; the hardware scales them as for any other basis.
            self.row_slopes = self.row_slopes * BASIS_SCALE
        slopes = self.row_slopes[column][None]
        arguments = self.rectangles, self.scene.camera.position, self.scene.background, slopes, design.reflections
        self.true, self.golden = (
            model.trace(*arguments, light=self.scene.light, keep=True)
            for model in (ExactModel(), model_of(self.config))
        )
        bits, colours = self.config.colour_bits, self.golden.colours[0].reshape(1, 1, 3)
        self.pixel = packed(shown(colours, self.config)[0, 0] >> (CHANNEL_BITS - bits), bits)
        """The pixel's colour, with the design's number of bits."""

    def name(self, rectangle: int) -> str:
        """Return a rectangle's name in the scene file, or an empty text."""
        return self._names[rectangle] or ""

    def alive(self, bounce: int) -> bool:
        """True if there is such a ray: every ray before it hit something."""
        return bounce <= self.reflections and bool(self.golden.bounces[bounce].alive[0])

    def of_rectangle(self, place: Place, name: str) -> Any:
        """Read one of the golden model's arrays by rectangle, at a place: an int, a bool, or a tuple of them."""
        value = getattr(self.golden.bounces[place.bounce], name)[place.index, 0]
        return tuple(value.tolist()) if value.ndim else value.item()

    def of_ray(self, bounce: int, name: str) -> tuple[int, ...]:
        """Read one of the golden model's arrays by ray."""
        return tuple(getattr(self.golden.bounces[bounce], name)[0].tolist())

    def winner(self, bounce: int) -> int:
        """Return the rectangle that is hit, -1 for none."""
        return int(self.golden.winners[bounce][0]) if self.alive(bounce) else -1

    def nearest(self, place: Place) -> int:
        """Return the nearest rectangle of those up to the place's rectangle, -1 for none."""
        return self.nearest_of(place.bounce, range(place.index + 1))

    def nearest_of(self, number: int, candidates: Iterable[int]) -> int:
        """Return the nearest of some rectangles at a bounce, -1 for none."""
        bounce = self.golden.bounces[number]
        hits = [i for i in candidates if i < len(self.rectangles) and bounce.hits[i, 0]]
        # Only the seed engine compares depths along x, which are 0 for all hits of a ray that runs across x.
        ways = bounce.depths if self.config.facts.divides else bounce.numerators
        return min(hits, key=lambda i: (Fraction(int(ways[i, 0]), int(bounce.scales[i, 0])), i), default=-1)

    def colour(self, rectangle: int) -> int:
        """Return a rectangle's colour, or the background for -1: 24 bits, red highest, blue lowest."""
        channels = self.scene.background if rectangle < 0 else self.rectangles.colours[rectangle]
        return packed(channels, CHANNEL_BITS)

    def plane(self, place: Place) -> tuple[int, int, tuple[int, ...]]:
        """Return a rectangle's axis, its plane's coordinate, and its bounds as the hardware sorts them."""
        axis = int(self.rectangles.axes[place.index])
        low, high = self.rectangles.low[place.index], self.rectangles.high[place.index]
        u, v = OTHER_AXES[axis]
        return axis, int(low[axis]), tuple(int(value) for value in (low[u], high[u], low[v], high[v]))

    def hit(self, place: Place) -> Sequence[Value]:
        """Return 1 if the rectangle is hit, else 0."""
        return (int(self.of_rectangle(place, "hits")),)

    def origin(self, place: Place) -> Sequence[Value]:
        """Return the start of a ray."""
        return self.of_ray(place.bounce, "origins")

    def rect_fields(self, index: int) -> Mapping[str, int]:
        """Return a rectangle's fields, as the hardware sorts and codes them, by the names in its records."""
        axis, position, bounds = self.plane(Place(0, index))
        rectangles = self.rectangles
        return {
            "axis": axis, "position": position,
            **dict(zip(("u_low", "u_high", "v_low", "v_high"), bounds, strict=True)),
            "colour": self.colour(index), "mirror": int(rectangles.mirrors[index]),
            "kind": int(rectangles.kinds[index]), "cell": CELLS.index(int(rectangles.cells[index])),
            "colour_2": packed(rectangles.colours_2[index], CHANNEL_BITS),
        }  # fmt: skip

    def cell_parity(self, index: int, point: Sequence[int], scale: int) -> tuple[int, int]:
        """Return the lowest bits of the numbers of a rectangle's cell along u and v, at a point in units of 1/scale."""
        size = scale * int(self.rectangles.cells[index])
        u, v = OTHER_AXES[int(self.rectangles.axes[index])]
        return int(point[u]) // size % 2, int(point[v]) // size % 2

    def cell_seen(self, place: Place) -> Sequence[Value] | None:
        """Return the `cell_parity` of the point that a ray hit; None without a hit or a pattern."""
        winner = self.winner(place.bounce)
        if winner < 0 or not self.rectangles.kinds[winner]:
            return None
        points, denominators = self.golden.points[place.bounce], self.golden.denominators[place.bounce]
        return self.cell_parity(winner, points[0], int(denominators[0]))

    def own_colour(self, place: Place) -> Sequence[Value] | None:
        """Return the colour, with pattern but without shadow, at the point that a ray hit; None for a miss."""
        if self.winner(place.bounce) < 0:
            return None
        names = ("winners", "points", "denominators")
        hit = (getattr(self.golden, name)[place.bounce] for name in names)
        return (packed(hit_colours(self.rectangles, self.scene.background, *hit)[0], CHANNEL_BITS),)

    def slope_signs(self, place: Place) -> Sequence[Value]:
        """Return the signs of the slope's components, 1 if negative; None for a component that is 0."""
        return [None if slope == 0 else int(slope < 0) for slope in self.of_ray(place.bounce, "slopes")]

    def found(self, place: Place) -> Sequence[Value] | None:
        """Return 1 if a ray hit anything, else 0; None for a ray after a miss."""
        return (int(self.winner(place.bounce) >= 0),) if self.alive(place.bounce) else None

    def found_colour(self, place: Place) -> Sequence[Value] | None:
        """Return the colour of the rectangle that a ray hit; None for a miss."""
        winner = self.winner(place.bounce)
        return (self.colour(winner),) if winner >= 0 else None

    def seen_colour(self, place: Place) -> tuple[int] | None:
        """Return the colour that a ray sees, background included; None for a ray after a surface without a mirror."""
        if self.config.materials and not self.alive(place.bounce):
            return None
        return (int.from_bytes(bytes(self.golden.seen[place.bounce][0])),)

    def channels(self, place: Place) -> Sequence[Value]:
        """Return the pixel's three channels."""
        return channels_of(self.pixel, self.config.colour_bits)

    def true_origin(self, bounce: int) -> tuple[Fraction, ...]:
        """Compute where a ray starts without rounding; after a miss the result means nothing."""
        if bounce == 0:
            return tuple(map(Fraction, self.scene.camera.position))
        return self._true_point(self.true.points[bounce - 1][0], self.true.denominators[bounce - 1][0])

    def true_hit(self, place: Place) -> tuple[Fraction, ...] | None:
        """Compute where a ray meets a rectangle's plane without rounding; None if it runs along or away from it."""
        bounce, (axis, position, _) = self.true.bounces[place.bounce], self.plane(place)
        ahead = (position - self.true_origin(place.bounce)[axis]) * int(bounce.slopes[0, axis])
        if not bounce.alive[0] or ahead <= 0:
            return None
        return self._true_point(bounce.points[place.index, 0], bounce.scales[place.index, 0])

    @staticmethod
    def _true_point(scaled: np.ndarray, divisor: SupportsInt) -> tuple[Fraction, ...]:
        return tuple(Fraction(int(coordinate), int(divisor) or 1) for coordinate in scaled)


def packed(channels: Iterable[int], bits: int) -> int:
    """Pack red, green and blue into a word."""
    red, green, blue = (int(channel) for channel in channels)
    return (red << 2 * bits) | (green << bits) | blue


def channels_of(colour: int, bits: int) -> tuple[int, int, int]:
    """Split a colour's word into red, green and blue."""
    mask = (1 << bits) - 1
    return colour >> 2 * bits & mask, colour >> bits & mask, colour & mask


def read(waves: Waves, description: Description, ray: Ray) -> list[Reading]:
    """Read everything that the waveform has of a pixel's life, in the order in which it happened.

    An expected event that did not happen is a wrong reading at the end of its ray.

    Raises:
        UserError: the waveform is of another design.
    """
    samples = waves.sample(description.controls())
    if not samples.times_ns:
        raise UserError(f"{waves.path}: the clock never rises")
    events, probes, found = description.events(samples, ray), description.probes, []
    for event in events:
        for probe in probes:
            if probe.event != event.kind or not (ray.alive(event.place.bounce) or event.kind in OF_LOST_RAYS):
                continue
            values = probe.golden(ray, event.place) if probe.golden else map(event.golden.get, probe.parts)
            golden, cycle = tuple(values or ()), event.cycle + probe.late
            if any(value is not None for value in golden) and 0 <= cycle < len(samples.times_ns):
                found.append((probe, event.place, cycle, golden))
    readings = []
    happened = {(event.kind, event.place) for event in events}
    for kind, place in description.expected(ray):
        if (kind, place) not in happened:
            ends = (event.cycle for event in events if event.kind in ENDS and event.place.bounce >= place.bounce)
            cycle = min(ends, default=len(samples.times_ns) - 1)
            quantity, signal = description.event_names[kind]
            probe = Probe(quantity, (signal,), kind, lambda ray, place: ("yes",))
            readings.append(Reading(probe, place, cycle, samples.begin_ns(cycle), ("yes",), ("no",)))
    values = waves.sample({name for probe, *_ in found for name in probe.signals}).values
    for probe, place, cycle, golden in found:
        seen: Sequence[Value] = [
            signed(values[name][cycle], waves.width(name)) if probe.is_signed(number) else values[name][cycle]
            for number, name in enumerate(probe.signals)
        ]
        if probe.decode:
            seen = len(golden) * [None] if None in seen else probe.decode(ray, place, *seen)
        readings.append(Reading(probe, place, cycle, samples.begin_ns(cycle), golden, tuple(seen)))
    # Within a cycle, sorting keeps the description's order, in which values depend on each other. Omissions come
    # first, as these events should have happened earlier.
    return sorted(readings, key=lambda reading: reading.cycle)


def first_difference(readings: Iterable[Reading]) -> Reading | None:
    """Return the first reading that differs from the golden model."""
    return next((reading for reading in readings if reading.wrong is not None), None)
