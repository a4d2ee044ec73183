# SPDX-License-Identifier: MIT
"""Probes for the exact engine: a mirrored eye, and t as a fraction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raycaster.debug.probes import AXES, fields
from raycaster.debug.probes.ray import Place, Probe, Ray, Read, Value
from raycaster.debug.probes.units import SIGNS, UnitProbes, indexed, rect_probe
from raycaster.output import printable
from raycaster.rtl.common.records import Signs, Surface
from raycaster.rtl.exact.eye_register import Mirror
from raycaster.scene import Light


def mirror(ray: Ray, place: Place) -> Sequence[Value]:
    """1 if the ray has left a mirror, else 0; then the mirror's axis and distance from the eye, and flags of the axes
    of all mirrors in its starting point, if the design has them."""
    with_corners = ray.config.most_reflections > 1
    if place.bounce == 0:
        return 0, None, None, *(None,) * 3 * with_corners
    left = Place(place.bounce - 1, ray.winner(place.bounce - 1))
    axis, _, _ = ray.plane(left)
    return 1, axis, ray.of_rectangle(left, "numerators"), *ray.of_ray(place.bounce, "met")[: 3 * with_corners]


def fraction(ray: Ray, place: Place) -> Sequence[Value] | None:
    """t of a hit, as numerator and denominator."""
    if place.index < 0 or not ray.of_rectangle(place, "hits"):
        return None
    return ray.of_rectangle(place, "numerators"), ray.of_rectangle(place, "denominators")


def shadow_ray(ray: Ray, place: Place) -> tuple[Light, np.ndarray] | None:
    """Return the light and the slope of the shadow ray, int64 (3,); None if the ray hit nothing that it could light."""
    light = ray.scene.light
    if light is None or ray.winner(place.bounce) < 0:
        return None
    point, e = ray.golden.points[place.bounce][0], ray.golden.denominators[place.bounce][0]
    return light, point - e * np.array(light.position)


def shadow_sizes(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Magnitudes of the shadow ray's slope; None for a miss."""
    found = shadow_ray(ray, place)
    return found and [abs(int(part)) for part in found[1]]


def shadow_signs(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Signs of the shadow ray's slope, 1 if negative; None for a miss, and for a component that is 0."""
    found = shadow_ray(ray, place)
    return found and [int(part < 0) if part else None for part in found[1]]


def faces(ray: Ray, place: Place) -> Sequence[Value] | None:
    """1 if the light is on the side of the rectangle that the ray came from, else 0; None for a miss."""
    return shadow_ray(ray, place) and (int(ray.golden.shadings[place.bounce].facing[0]),)


def in_question(read: Read) -> Read:
    """Restrict a reader to tests of shadow rays of points to which the light may still come: others don't matter."""

    def restricted(ray: Ray, place: Place) -> Sequence[Value] | None:
        if shadow_ray(ray, place) is None or not ray.golden.shadings[place.bounce].facing[0]:
            return None
        shades = int(ray.golden.shadings[place.bounce].shades[0])
        return read(ray, place) if shades < 0 or place.index <= shades else None

    return restricted


def crossing(ray: Ray, place: Place) -> Sequence[Value] | None:
    """1 if the shadow ray meets the rectangle, else 0, and its t as numerator and denominator."""
    found = shadow_ray(ray, place)
    if found is None:
        return None
    eye, slope = (np.array(one)[:, None] for one in (found[0].position, found[1]))
    n, e, within = (one.item() for one in ray.rectangles.crossed(place.index, eye, slope))
    hit = e > 0 and n > 0 and within
    return (1, n, e) if hit else (0, None, None)


def shaded(ray: Ray, place: Place) -> Sequence[Value] | None:
    """1 if the rectangle, or one before it, is between the light and the point, else 0."""
    return (int(0 <= int(ray.golden.shadings[place.bounce].shades[0]) <= place.index),)


def lighting(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Say whether the light reaches the hit point and, if not, why; None for a miss."""
    if shadow_ray(ray, place) is None:
        return None
    shading = ray.golden.shadings[place.bounce]
    if not shading.facing[0]:
        return ("on the dark side",)
    shades = int(shading.shades[0])
    return (f"shaded by {shades} {printable(ray.scene.rect[shades].name)}".rstrip() if shades >= 0 else "lit",)


def hardware_lighting(ray: Ray, place: Place, shaded: int, facing: int) -> Sequence[Value]:
    """Say what the unit found, in the model's words if they agree: the unit does not know which rectangle shades."""
    found = "on the dark side" if not facing else "shaded" if shaded else "lit"
    golden = lighting(ray, place)
    return golden if golden and str(golden[0]).startswith(found) else (found,)


def dark(ray: Ray, place: Place) -> Sequence[Value] | None:
    """1 if the light does not reach the hit point, else 0; None for a miss."""
    return shadow_ray(ray, place) and (int(not ray.golden.shadings[place.bounce].lit[0]),)


def hit_colour(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Colour that a ray sees, in the light or in the dark; None for a miss."""
    return ray.seen_colour(place) if ray.winner(place.bounce) >= 0 else None


class ExactProbes(UnitProbes):
    """The exact engine's description; see `raycaster.debug.probes.ray.Description`."""

    modules = ("exact_control", "exact_unit")

    @property
    def probes(self) -> list[Probe]:
        """Probes in the order in which values depend on each other."""
        memory, tester, keeper = (f"{self.unit}.{name}_i" for name in ("eye_register", "rect_tester", "nearest_hit"))
        surface, left = Surface(self.config), Mirror(self.config)
        mirror_fields = ("active", "axis", "distance", *(name for name in left.layout if name.startswith("met_")))
        t = tuple(f"{tester}.{name}" for name in ("numerator", "denominator"))
        nearest_t = tuple(f"{keeper}.found_{name}" for name in ("distance", "slope"))
        return [
            *self.first_probes(),
            Probe("eye", fields(memory, "eye", AXES), "ray", Ray.origin, late=1, signed=True, parts=AXES),
            Probe("signs", fields(memory, "signs", SIGNS, Signs()), "ray", Ray.slope_signs, late=1, parts=AXES),
            Probe("mirror", fields(memory, "mirror", mirror_fields, left), "ray", mirror, late=1, shown=False,
                parts=mirror_fields),
            *(self._switch_probes() if self.config.light else []),
            rect_probe("offered", self.control, "offered", surface, "write", indexed),
            Probe("inside", (f"{tester}.hit",), "write", Ray.hit),
            Probe("t", t, "write", fraction),
            Probe("nearest t", nearest_t, "write",
                lambda ray, place: fraction(ray, Place(place.bounce, ray.nearest(place))), late=1),
            rect_probe("nearest", keeper, "found_surface", surface, "write", Ray.nearest, late=1),
            *(self._pattern_probes() if self.config.patterns else []),
            *(self._light_probes() if self.config.light else []),
            *self.last_probes(fields(keeper, "found_surface", ("colour",), surface)[0]),
        ]  # fmt: skip

    def _pattern_probes(self) -> list[Probe]:
        """Probes of the hit point's cell and colour."""
        painter = f"{self.unit}.pattern_colour_i"
        return [
            Probe("odd cell u, v", (f"{painter}.odd_u", f"{painter}.odd_v"), "blend", Ray.cell_seen, shown=False,
                module="cell_finder"),
            Probe("colour there", (f"{painter}.colour",), "blend", Ray.own_colour, colour=True, shown=False),
        ]  # fmt: skip

    def _switch_probes(self) -> list[Probe]:
        """Probes of the ray at the tester: the unit's own, or the one from the light."""
        switch = f"{self.unit}.ray_switch_i"
        eye, sizes = (fields(switch, f"tested_{name}", parts) for name, parts in (("eye", AXES), ("slope", SIGNS)))
        signs = fields(switch, "tested_signs", SIGNS, Signs())
        own = (
            Ray.origin, Ray.slope_signs, lambda ray, place: [abs(part) for part in ray.of_ray(place.bounce, "slopes")]
        )  # fmt: skip
        light = (
            lambda ray, place: ray.scene.light and ray.scene.light.position, shadow_signs, shadow_sizes
        )  # fmt: skip
        return [
            Probe(f"{name} {what} tested", signals, event, golden, signed=what == "eye", parts=AXES, shown=False)
            for event, name, goldens in (
                ("find", "own", own), ("light find", "the light's", [in_question(one) for one in light])
            )
            for what, signals, golden in zip(("eye", "signs", "slope"), (eye, signs, sizes), goldens, strict=True)
        ]  # fmt: skip

    def _light_probes(self) -> list[Probe]:
        """Probes of the shadow ray, of its tests, and of their result."""
        shadow, register = f"{self.unit}.shadow_ray_i", f"{self.unit}.shadow_register_i.shaded"
        tests = tuple(f"{self.unit}.rect_tester_i.{name}" for name in ("hit", "numerator", "denominator"))
        slope, facing = fields(shadow, "shadow_slope", SIGNS), f"{shadow}.facing"
        return [
            Probe("slope from the light", slope, "aimed", shadow_sizes, late=1, parts=AXES),
            Probe("signs from the light", fields(shadow, "shadow_signs", SIGNS, Signs()), "aimed", shadow_signs, late=1,
                parts=AXES),
            Probe("faces the light", (facing,), "aimed", faces, late=1, shown=False),
            Probe("between", tests, "light write", in_question(crossing), parts=("hit", "numerator", "denominator"),
                shown=False),
            Probe("shaded", (register,), "light write", in_question(shaded), late=1, shown=False),
            Probe("light", (register, facing), "blend", lighting, decode=hardware_lighting),
            Probe("dark", (f"{self.unit}.dark",), "blend", dark, shown=False),
            Probe("colour in this light", (f"{self.unit}.shade_colour_i.shaded",), "blend", hit_colour, colour=True,
                shown=False),
        ]  # fmt: skip
