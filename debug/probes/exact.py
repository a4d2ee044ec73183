# SPDX-License-Identifier: MIT
"""Where the exact engine has what golden knows of a ray: a mirrored eye, and products that are compared."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.configuration import Configuration
from raycaster.debug.probes.ray import AXES, Event, Place, Probe, Ray, Value, fields
from raycaster.debug.probes.units import SIGNS, UnitProbes, nearest_found, slope_signs
from raycaster.debug.waves import Samples
from raycaster.golden.world import OTHER_AXES
from raycaster.rtl.common.records import Mirror, Signs, Surface

SURFACE = ("axis", "position", "colour")
MIRROR = ("active", "axis", "position")
BOUNDS = ("low_u", "high_u", "low_v", "high_v")


def eye(ray: Ray, place: Place) -> Sequence[Value]:
    """The camera, mirrored in all mirrors so far."""
    return ray.of_ray(place.bounce, "eyes") if ray.alive(place.bounce) else 3 * (None,)


def mirror(ray: Ray, place: Place) -> Sequence[Value]:
    """Whether the ray has left a mirror, and that one's axis and plane."""
    if not ray.alive(place.bounce):
        return 3 * (None,)
    if place.bounce == 0:
        return 0, None, None
    axis, position, _ = ray.plane(Place(place.bounce, ray.winner(place.bounce - 1)))
    return 1, axis, position


def distance(ray: Ray, place: Place) -> Sequence[Value]:
    """From the eye to the plane."""
    if not ray.alive(place.bounce):
        return (None,)
    axis, position, _ = ray.plane(place)
    return (position - ray.of_ray(place.bounce, "eyes")[axis],)


def denominator(ray: Ray, place: Place) -> Sequence[Value]:
    """The magnitude of the slope along the plane's axis."""
    return (ray.of_rectangle(place, "denominators"),) if ray.alive(place.bounce) else (None,)


def crosses(ray: Ray, place: Place) -> bool:
    """Whether the ray crosses the plane anywhere, so that the rest means something."""
    return ray.alive(place.bounce) and ray.of_rectangle(place, "denominators") != 0


def numerator(ray: Ray, place: Place) -> Sequence[Value]:
    """The distance, with the sign of the slope."""
    return (ray.of_rectangle(place, "numerators"),) if crosses(ray, place) else (None,)


def ways(ray: Ray, place: Place) -> Sequence[Value]:
    """The slope on u and v times the numerator."""
    return ray.of_rectangle(place, "quotients") if crosses(ray, place) else (None, None)


def ways_to_bounds(ray: Ray, place: Place) -> Sequence[Value]:
    """From the eye to each bound, times the denominator; the mirror takes the place of a bound behind it."""
    if not crosses(ray, place):
        return 4 * (None,)
    axis, _, bounds = ray.plane(place)
    eyes, slopes = ray.of_ray(place.bounce, "eyes"), ray.of_ray(place.bounce, "slopes")
    active, mirror_axis, mirror_position = mirror(ray, place)
    products = []
    for number, u in enumerate(OTHER_AXES[axis]):
        low, high = bounds[2 * number : 2 * number + 2]
        if active and mirror_axis == u and slopes[u] >= 0:
            low = max(low, mirror_position)
        elif active and mirror_axis == u:
            high = min(high, mirror_position)
        products += [(bound - eyes[u]) * ray.of_rectangle(place, "denominators") for bound in (low, high)]
    return products


def hit(ray: Ray, place: Place) -> Sequence[Value]:
    """Whether the rectangle is hit."""
    return (int(ray.of_rectangle(place, "hits")) if ray.alive(place.bounce) else None,)


def fraction(ray: Ray, place: Place) -> Sequence[Value]:
    """t of a hit, as numerator and denominator."""
    if not ray.alive(place.bounce) or not ray.of_rectangle(place, "hits"):
        return (None, None)
    return ray.of_rectangle(place, "numerators"), ray.of_rectangle(place, "denominators")


def nearest(ray: Ray, place: Place) -> int:
    """The nearest rectangle up to this one, -1 for none."""
    return ray.nearest(place) if ray.alive(place.bounce) else -1


def nearest_fraction(ray: Ray, place: Place) -> Sequence[Value]:
    """Its t."""
    index = nearest(ray, place)
    return fraction(ray, Place(place.bounce, index)) if index >= 0 else (None, None)


def nearest_surface(ray: Ray, place: Place) -> Sequence[Value]:
    """Its axis, plane and colour."""
    index = nearest(ray, place)
    if index < 0:
        return (None, None, None)
    axis, position, _ = ray.plane(Place(place.bounce, index))
    return axis, position, ray.colour(index)


def offered_surface(ray: Ray, place: Place) -> Sequence[Value]:
    """What the control says that the verdict is of."""
    axis, position, _ = ray.plane(place)
    return axis, position, ray.colour(place.rectangle)


class ExactProbes(UnitProbes):
    """The description; see `raycaster.debug.probes.ray.Description`."""

    def __init__(self, config: Configuration, unit: int):
        super().__init__(config, unit, "exact_control_i", "exact_unit")
        self.memory = f"{self.unit}.eye_register_i"
        self.tester = f"{self.unit}.rect_tester_i"
        self.keeper = f"{self.unit}.nearest_hit_i"

    @property
    def unit_signals(self) -> Sequence[str]:
        """What of a unit a viewer shows beside its slope and its colours."""
        return [
            *(f"{name}:signed" for name in fields(self.memory, "eye", AXES)),
            *fields(self.memory, "signs", SIGNS, Signs()),
            *fields(self.memory, "mirror", MIRROR, Mirror()),
            f"{self.tester}.distance:signed",
            f"{self.tester}.n:signed",
            f"{self.tester}.e",
            *(f"{self.tester}.{name}:signed" for name in ("way_u", "way_v")),
            *(f"{self.tester}.way_to_{name}:signed" for name in BOUNDS),
            *(f"{self.tester}.{name}" for name in ("hit", "numerator", "denominator")),
            *(f"{self.keeper}.{name}" for name in ("nearer", "found", "nearest_numerator", "nearest_denominator")),
            *fields(self.keeper, "found_surface", ("axis", "position", "colour:hex"), Surface()),
        ]

    def _tried(self, samples: Samples, tried: list[tuple[int, int]], bounce: int, end: int) -> list[Event]:
        """A verdict comes for each rectangle, in their order."""
        begin = tried[0][0] if tried else end
        strobe = samples.values[f"{self.control}.steps_write_z_buf"]
        verdicts = (cycle for cycle in range(begin, end) if strobe[cycle])
        events = [Event("find", cycle, Place(bounce, rectangle)) for cycle, rectangle in tried]
        return events + [
            Event("write", cycle, Place(bounce, rectangle))
            for cycle, (_, rectangle) in zip(verdicts, tried, strict=False)
        ]

    @property
    def probes(self) -> list[Probe]:
        """In the order in which values depend on each other."""
        offered = fields(self.control, "offered", SURFACE, Surface())
        kept_colour = fields(self.keeper, "found_surface", ("colour",), Surface())[0]
        return [
            *self.first_probes(),
            Probe("eye", fields(self.memory, "eye", AXES), "ray", eye, late=1, signed=True),
            Probe("signs", fields(self.memory, "signs", SIGNS, Signs()), "ray", slope_signs, late=1),
            Probe("mirror", fields(self.memory, "mirror", MIRROR, Mirror()), "ray", mirror, late=1, shown=False),
            Probe("eye distance", (f"{self.tester}.distance",), "find", distance, signed=True),
            Probe("denominator", (f"{self.tester}.e",), "find", denominator),
            Probe("numerator", (f"{self.tester}.n",), "find", numerator, signed=True),
            Probe(
                "way u, v", tuple(f"{self.tester}.{name}" for name in ("way_u", "way_v")), "find", ways, late=1,
                signed=True,
            ),
            Probe(
                "bounds u, v", tuple(f"{self.tester}.way_to_{name}" for name in BOUNDS), "find", ways_to_bounds, late=1,
                signed=True,
            ),
            Probe("offered", offered, "write", offered_surface, shown=False),
            Probe("inside", (f"{self.tester}.hit",), "write", hit),
            Probe(
                "fraction", tuple(f"{self.tester}.{name}" for name in ("numerator", "denominator")), "write", fraction,
                shown=False,
            ),
            Probe("any yet", (f"{self.keeper}.found",), "write", nearest_found, late=1, shown=False),
            Probe(
                "nearest t", tuple(f"{self.keeper}.nearest_{name}" for name in ("numerator", "denominator")), "write",
                nearest_fraction, late=1,
            ),
            Probe(
                "nearest surface", fields(self.keeper, "found_surface", SURFACE, Surface()), "write", nearest_surface,
                late=1, shown=False,
            ),
            *self.last_probes(kept_colour),
        ]  # fmt: skip
