# SPDX-License-Identifier: MIT
"""Probes for the seed engine: one division per coordinate, and a stored hit point."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from raycaster.configuration import CHANNEL_BITS
from raycaster.debug.probes import AXES, fields
from raycaster.debug.probes.ray import Number, Place, Probe, Ray, Read, Value, packed
from raycaster.debug.probes.units import SIGNS, UnitProbes, indexed, rect_probe
from raycaster.golden.colour import hit_colours
from raycaster.golden.world import OTHER_AXES
from raycaster.rtl.common.records import Rect
from raycaster.rtl.seed.ray_mem import Origin
from raycaster.rtl.seed.ray_mem import Ray as RayRecord


def of_rectangle(name: str, when: str) -> Read:
    """Make a reader of one of the golden model's arrays; None where the array `when` is false."""

    def read(ray: Ray, place: Place) -> Sequence[Value]:
        value, means = ray.of_rectangle(place, name), ray.of_rectangle(place, when)
        values = value if isinstance(value, tuple) else (int(value),)
        means = means if isinstance(means, tuple) else len(values) * (means,)
        return [one if meant else None for one, meant in zip(values, means, strict=True)]

    return read


def of_nearest(name: str) -> Read:
    """Make a reader of one of the golden model's arrays, for the nearest rectangle up to this one."""

    def read(ray: Ray, place: Place) -> Sequence[Value] | None:
        nearest = ray.nearest(place)
        return of_rectangle(name, "hits")(ray, Place(place.bounce, nearest)) if nearest >= 0 else None

    return read


def colour_there(ray: Ray, place: Place) -> Sequence[Value]:
    """A rectangle's colour at its hit point."""
    winner, point = np.array([place.index]), np.array([ray.of_rectangle(place, "points")])
    colours = hit_colours(ray.rectangles, ray.scene.background, winner, point, 1 << ray.config.fraction_bits)
    return (packed(colours[0], CHANNEL_BITS),)


def odd_cells(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Lowest bits of the numbers of the pattern's cell that is hit, along u and v; None without a hit or a pattern."""
    if not (ray.of_rectangle(place, "hits") and ray.rectangles.kinds[place.index]):
        return None
    return ray.cell_parity(place.index, ray.of_rectangle(place, "points"), 1 << ray.config.fraction_bits)


def found_colour(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Colour at the point that a ray hit; None for a miss."""
    winner = ray.winner(place.bounce)
    return colour_there(ray, Place(place.bounce, winner)) if winner >= 0 else None


def nearest_surface(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Axis and colour of the nearest rectangle up to this one; None if there is none."""
    nearest = Place(place.bounce, ray.nearest(place))
    return (ray.plane(nearest)[0], *colour_there(ray, nearest)) if nearest.index >= 0 else None


def of_reflected(read: Read) -> Read:
    """Restrict a reader to reflected rays."""
    return lambda ray, place: read(ray, place) if place.bounce else None


def products(ray: Ray, place: Place) -> Sequence[Value]:
    """Dividends for u and v: magnitudes of the slope times n."""
    slopes, n = ray.of_ray(place.bounce, "slopes"), ray.of_rectangle(place, "numerators")
    return [abs(slopes[u] * n) for u in OTHER_AXES[ray.plane(place)[0]]]


def towards(ray: Ray, place: Place) -> Sequence[Value]:
    """1 if the ray runs towards the plane, else 0; for both helpers."""
    return 2 * (int(ray.of_rectangle(place, "numerators") * ray.of_rectangle(place, "denominators") > 0),)


def coordinates(ray: Ray, place: Place) -> Sequence[Value]:
    """The hit point on u and v; None where there is none."""
    points, valid = ray.of_rectangle(place, "points"), ray.of_rectangle(place, "valid")
    return [points[u] if fits else None for u, fits in zip(OTHER_AXES[ray.plane(place)[0]], valid, strict=True)]


def true_coordinates(ray: Ray, place: Place) -> Sequence[Number]:
    """The hit point on u and v, without rounding."""
    point, (axis, _, _) = ray.true_hit(place), ray.plane(place)
    return [point[u] for u in OTHER_AXES[axis]] if point else (None, None)


def true_depth(ray: Ray, place: Place) -> Sequence[Number]:
    """The depth, without rounding."""
    point = ray.true_hit(place)
    return (abs(point[0] - ray.true_origin(place.bounce)[0]) if point else None,)


def true_inside(ray: Ray, place: Place) -> Sequence[Number]:
    """1 if the rectangle is hit, else 0, without rounding."""
    bounce = ray.true.bounces[place.bounce]
    return (int(bounce.hits[place.index, 0]) if bounce.alive[0] else None,)


class SeedProbes(UnitProbes):
    """The seed engine's description; see `raycaster.debug.probes.ray.Description`."""

    modules = ("ray_control", "ray_unit")
    steps: Mapping[str, str] = {"load": "load_divider", "store": "store_quotient", "write": "write_z_buf"}

    def expected(self, ray: Ray) -> Iterable[tuple[str, Place]]:
        """List the events that must happen; with culling, a rectangle that is not hit may end before its verdict."""
        for kind, place in super().expected(ray):
            if kind != "write" or not self.config.culling or ray.of_rectangle(place, "hits"):
                yield kind, place

    @property
    def probes(self) -> list[Probe]:
        """Probes in the order in which values depend on each other."""
        finder, memory, buffer = (f"{self.unit}.{name}_i" for name in ("intersection_finder", "ray_mem", "z_buffer"))
        helpers = [f"{finder}.intersection_helper_{number}_i" for number in range(2)]

        def of_helpers(name: str) -> tuple[str, ...]:
            return tuple(f"{helper}.{name}" for helper in helpers)

        ray, point = RayRecord(self.config), Origin(self.config)
        kept = (f"{buffer}.found_axis", f"{buffer}.found_colour")
        return [
            *self.first_probes(),
            Probe("reflected origin", fields(memory, "reflected", AXES, ray), "ray", of_reflected(Ray.origin), late=1,
                scale=True, shown=False, parts=AXES),
            Probe("reflected signs", fields(memory, "reflected", SIGNS, ray), "ray",
                of_reflected(Ray.slope_signs), late=1, shown=False, parts=AXES),
            Probe("origin", fields(self.unit, "ray", AXES, ray), "ray", Ray.origin, late=1, scale=True,
                true=lambda ray, place: ray.true_origin(place.bounce), parts=AXES),
            Probe("signs", fields(self.unit, "ray", SIGNS, ray), "ray", Ray.slope_signs, late=1, parts=AXES),
            Probe("towards the plane", of_helpers("towards"), "find", towards, late=1, shown=False),
            Probe("product", of_helpers("product"), "load", products, shown=False),
            rect_probe("rectangle at the end", self.control, "offered", Rect(self.config), "store", indexed, late=1),
            Probe("quotient u, v", of_helpers("divider_i.quotient"), "store", of_rectangle("quotients", "valid"),
                late=1, scale=True),
            Probe("valid", of_helpers("valid"), "store", lambda ray, place: ray.of_rectangle(place, "valid"), late=1,
                shown=False),
            Probe("hit point u, v", of_helpers("value"), "write", coordinates, signed=True, true=true_coordinates,
                scale=True),
            Probe("inside", (f"{finder}.hit",), "write", Ray.hit, true=true_inside),
            Probe("depth", (f"{finder}.depth",), "write", of_rectangle("depths", "hits"), true=true_depth, scale=True),
            Probe("point", fields(finder, "point", AXES, point), "write", of_rectangle("points", "hits"), scale=True,
                shown=False, parts=AXES),
            *(self._pattern_probes(finder) if self.config.patterns else []),
            Probe("nearest", (f"{buffer}.nearest",), "write", of_nearest("depths"), late=1, scale=True),
            Probe("nearest surface", kept, "write", nearest_surface, late=1, colour=(1,), shown=False),
            Probe("nearest point", fields(buffer, "found_point", AXES, point), "write", of_nearest("points"), late=1,
                scale=True, shown=False, parts=AXES),
            *self.last_probes(kept[-1], found_colour),
        ]  # fmt: skip

    def _pattern_probes(self, finder: str) -> list[Probe]:
        """Probes of a hit point's cell and colour."""
        odd = tuple(f"{finder}.cell_parity_{number}_i.odd" for number in range(2))
        return [
            Probe("odd cell u, v", odd, "write", odd_cells, shown=False),
            Probe("colour there", (f"{self.unit}.pattern_colour_i.colour",), "write",
                lambda ray, place: colour_there(ray, place) if ray.of_rectangle(place, "hits") else None, colour=True,
                shown=False),
        ]  # fmt: skip
