# SPDX-License-Identifier: MIT
"""Where the seed engine has what golden knows of a ray: one division a coordinate, and a hit point that is stored."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from raycaster.configuration import Configuration
from raycaster.debug.probes.ray import AXES, Event, Place, Probe, Ray, Read, Value, fields
from raycaster.debug.probes.units import RECT_FIELDS, SIGNS, UnitProbes, nearest_found, slope_signs, sorted_rect
from raycaster.debug.waves import Samples
from raycaster.golden.world import OTHER_AXES
from raycaster.rtl.common.records import Origin, Rect
from raycaster.rtl.common.records import Ray as RayRecord


def origin(ray: Ray, place: Place) -> Sequence[Value]:
    """Where the ray starts."""
    return ray.of_ray(place.bounce, "origins") if ray.alive(place.bounce) else 3 * (None,)


def reflected(ray: Ray, place: Place) -> Sequence[Value]:
    """The same, of a ray that does not start at the camera."""
    return origin(ray, place) if place.bounce else 3 * (None,)


def reflected_signs(ray: Ray, place: Place) -> Sequence[Value]:
    """The signs of such a ray's slope."""
    return slope_signs(ray, place) if place.bounce else 3 * (None,)


def true_origin(ray: Ray, place: Place) -> Sequence[Value]:
    """Where it would start if nothing were rounded."""
    return ray.true_origin(place.bounce)


def of_rectangle(name: str, when: str | None = None) -> Read:
    """Reads an array of golden's, where another one says that it means something."""

    def read(ray: Ray, place: Place) -> Sequence[Value]:
        if not ray.alive(place.bounce):
            return (None, None)
        value = ray.of_rectangle(place, name)
        values = value if isinstance(value, tuple) else (int(value),)
        if when is None:
            return values
        means = ray.of_rectangle(place, when)
        means = means if isinstance(means, tuple) else len(values) * (means,)
        return [value if meant else None for value, meant in zip(values, means, strict=True)]

    return read


def one(read: Read) -> Read:
    """The same of what has one component."""
    return lambda ray, place: tuple(read(ray, place))[:1]


def products(ray: Ray, place: Place) -> Sequence[Value]:
    """What is divided, for u and v: magnitudes of the slope times n."""
    if not ray.alive(place.bounce):
        return (None, None)
    axis, _, _ = ray.plane(place)
    slopes = ray.of_ray(place.bounce, "slopes")
    return [abs(slopes[u] * ray.of_rectangle(place, "numerators")) for u in OTHER_AXES[axis]]


def towards(ray: Ray, place: Place) -> Sequence[Value]:
    """Whether the ray runs towards the plane."""
    if not ray.alive(place.bounce):
        return (None,)
    return (int(ray.of_rectangle(place, "numerators") * ray.of_rectangle(place, "denominators") > 0),)


def start_on_axis(ray: Ray, place: Place) -> Sequence[Value]:
    """The origin's coordinate that the plane is compared with."""
    axis, _, _ = ray.plane(place)
    return (origin(ray, place)[axis],)


def coordinates(ray: Ray, place: Place) -> Sequence[Value]:
    """The hit point on u and v, where there is one."""
    axis, _, _ = ray.plane(place)
    points = of_rectangle("points")(ray, place)
    if None in points:
        return (None, None)
    valid = ray.of_rectangle(place, "valid")
    return [points[u] if fits else None for u, fits in zip(OTHER_AXES[axis], valid, strict=True)]


def hit_point(ray: Ray, place: Place) -> Sequence[Value]:
    """The whole hit point, of a hit."""
    if not ray.alive(place.bounce) or not ray.of_rectangle(place, "hits"):
        return (None, None, None)
    return ray.of_rectangle(place, "points")


def true_numerator(ray: Ray, place: Place) -> Sequence[Value]:
    """n without rounding."""
    return (ray.true_numerator(place),)


def true_denominator(ray: Ray, place: Place) -> Sequence[Value]:
    """e of the ray without rounding."""
    return (ray.true_denominator(place),)


def true_coordinates(ray: Ray, place: Place) -> Sequence[Value]:
    """The hit point on u and v, without rounding."""
    point, (axis, _, _) = ray.true_hit(place), ray.plane(place)
    return [point[u] for u in OTHER_AXES[axis]] if point else (None, None)


def true_quotients(ray: Ray, place: Place) -> Sequence[Value]:
    """The quotients, without rounding."""
    point, (axis, _, _) = ray.true_hit(place), ray.plane(place)
    start = ray.true_origin(place.bounce)
    return [abs(point[u] - start[u]) for u in OTHER_AXES[axis]] if point else (None, None)


def true_depth(ray: Ray, place: Place) -> Sequence[Value]:
    """The depth, without rounding."""
    point = ray.true_hit(place)
    return (abs(point[0] - ray.true_origin(place.bounce)[0]) if point else None,)


def true_inside(ray: Ray, place: Place) -> Sequence[Value]:
    """Whether the rectangle is hit, without rounding."""
    bounce = ray.true.bounces[place.bounce]
    return (int(bounce.hits[place.rectangle, 0]) if bounce.alive[0] else None,)


def nearest_depth(ray: Ray, place: Place) -> Sequence[Value]:
    """Of the nearest rectangle up to this one."""
    nearest = ray.nearest(place) if ray.alive(place.bounce) else -1
    return (ray.of_rectangle(Place(place.bounce, nearest), "depths") if nearest >= 0 else None,)


def nearest_point(ray: Ray, place: Place) -> Sequence[Value]:
    """Where it is hit."""
    nearest = ray.nearest(place) if ray.alive(place.bounce) else -1
    return ray.of_rectangle(Place(place.bounce, nearest), "points") if nearest >= 0 else 3 * (None,)


def nearest_surface(ray: Ray, place: Place) -> Sequence[Value]:
    """Its axis and colour."""
    nearest = ray.nearest(place) if ray.alive(place.bounce) else -1
    return (int(ray.rectangles.axes[nearest]), ray.colour(nearest)) if nearest >= 0 else (None, None)


class SeedProbes(UnitProbes):
    """The description; see `raycaster.debug.probes.ray.Description`."""

    def __init__(self, config: Configuration, unit: int):
        super().__init__(config, unit, "ray_control_i", "ray_unit")
        self.finder = f"{self.unit}.intersection_finder_i"
        self.helpers = [f"{self.finder}.intersection_helper_{number}_i" for number in range(2)]
        self.z_buffer = f"{self.unit}.z_buffer_i"
        self.memory = f"{self.unit}.ray_mem_i"

    @property
    def unit_signals(self) -> Sequence[str]:
        """What of a unit a viewer shows beside its slope and its colours."""
        u, v = self.helpers
        return [
            *fields(self.unit, "ray", (*AXES, *SIGNS), RayRecord(self.config)),
            f"{self.control}.steps_load_divider",
            f"{self.control}.steps_store_quotient",
            f"{u}.difference:signed",
            f"{self.finder}.e_slope",
            f"{self.finder}.e_negative",
            f"{u}.product",
            f"{v}.product",
            f"{u}.divider_i.quotient",
            f"{v}.divider_i.quotient",
            f"{u}.value:signed",
            f"{v}.value:signed",
            *(f"{self.finder}.{name}" for name in ("inside_u", "inside_v", "hit", "depth")),
            *fields(self.finder, "point", AXES, Origin(self.config)),
            *(f"{self.z_buffer}.{name}" for name in ("nearer", "found", "nearest", "found_axis", "found_colour:hex")),
        ]

    def controls(self) -> Iterable[str]:
        """The signals that `events` reads."""
        steps = [f"{self.control}.steps_{name}" for name in ("load_divider", "store_quotient")]
        return [*super().controls(), *steps, f"{self.sequencer}.early_out"]

    def _tried(self, samples: Samples, tried: list[tuple[int, int]], bounce: int, end: int) -> list[Event]:
        """Follow each rectangle through the divider, in which one may wait while another one is loaded."""
        values = samples.values
        started, dividing, finishing = [], [], []
        starts, events = dict(tried), []

        def note(kind: str, cycle: int, rectangle: int) -> int:
            events.append(Event(kind, cycle, Place(bounce, rectangle)))
            return rectangle

        for cycle in range(min(starts, default=end), end):
            if cycle in starts:
                started.append(note("find", cycle, starts[cycle]))
            if values[f"{self.control}.steps_write_z_buf"][cycle] and finishing:
                note("write", cycle, finishing.pop(0))
            if values[f"{self.control}.steps_store_quotient"][cycle] and dividing:
                finishing.append(note("store", cycle, dividing.pop(0)))
            if values[f"{self.control}.steps_load_divider"][cycle] and started:
                dividing.append(note("load", cycle, started.pop(0)))
            if values[f"{self.sequencer}.early_out"][cycle] and dividing:
                note("early out", cycle, dividing.pop())
        return events

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """The events that golden knows must happen; a rectangle behind the ray may be left early."""
        for kind, place in super().expected(ray):
            if kind != "write" or not self.config.culling or ray.of_rectangle(place, "hits"):
                yield kind, place

    @property
    def probes(self) -> list[Probe]:
        """In the order in which values depend on each other."""
        u, v = self.helpers
        ray, origins = RayRecord(self.config), Origin(self.config)
        offered = fields(self.control, "offered", RECT_FIELDS, Rect())
        kept = (f"{self.z_buffer}.found_axis", f"{self.z_buffer}.found_colour")
        return [
            *self.first_probes(),
            Probe(
                "reflected origin", fields(self.memory, "reflected", AXES, ray), "ray", reflected, late=1, scale=True,
                shown=False,
            ),
            Probe(
                "reflected signs", fields(self.memory, "reflected", SIGNS, ray), "ray", reflected_signs, late=1,
                shown=False,
            ),
            Probe(
                "origin", fields(self.unit, "ray", AXES, ray), "ray", origin, late=1, true=true_origin, scale=True
            ),
            Probe("signs", fields(self.unit, "ray", SIGNS, ray), "ray", slope_signs, late=1),
            Probe("start", (f"{self.finder}.start_a",), "find", start_on_axis, scale=True, shown=False),
            Probe(
                "denominator",
                (f"{self.finder}.e_slope", f"{self.finder}.e_negative"),
                "find",
                one(of_rectangle("denominators")),
                decode=lambda ray, place, slope, negative: (-slope if negative else slope,),
                true=true_denominator,
            ),
            Probe(
                "numerator", (f"{u}.difference",), "find", one(of_rectangle("numerators")), signed=True,
                true=true_numerator, scale=True,
            ),
            Probe("towards the plane", (f"{u}.towards",), "find", towards, late=1, shown=False),
            Probe("towards the plane, v", (f"{v}.towards",), "find", towards, late=1, shown=False),
            Probe("product", (f"{u}.product", f"{v}.product"), "load", products, shown=False),
            Probe("rectangle at the end", offered, "store", sorted_rect, late=1, shown=False),
            Probe(
                "quotient u, v", (f"{u}.divider_i.quotient", f"{v}.divider_i.quotient"), "store",
                of_rectangle("quotients", "valid"), late=1, true=true_quotients, scale=True,
            ),
            Probe("valid", (f"{u}.valid", f"{v}.valid"), "store", of_rectangle("valid"), late=1, shown=False),
            Probe(
                "hit point u, v", (f"{u}.value", f"{v}.value"), "write", coordinates, signed=True,
                true=true_coordinates, scale=True,
            ),
            Probe("inside", (f"{self.finder}.hit",), "write", one(of_rectangle("hits")), true=true_inside),
            Probe(
                "depth", (f"{self.finder}.depth",), "write", one(of_rectangle("depths", "hits")), true=true_depth,
                scale=True,
            ),
            Probe(
                "point", fields(self.finder, "point", AXES, origins), "write", hit_point, scale=True, shown=False
            ),
            Probe("any yet", (f"{self.z_buffer}.found",), "write", nearest_found, late=1, shown=False),
            Probe("nearest", (f"{self.z_buffer}.nearest",), "write", nearest_depth, late=1, scale=True),
            Probe("nearest surface", kept, "write", nearest_surface, late=1, shown=False),
            Probe(
                "nearest point", fields(self.z_buffer, "found_point", AXES, origins), "write", nearest_point, late=1,
                scale=True, shown=False,
            ),
            *self.last_probes(f"{self.z_buffer}.found_colour"),
        ]  # fmt: skip
