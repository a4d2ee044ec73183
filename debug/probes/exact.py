# SPDX-License-Identifier: MIT
"""Probes for the exact engine: a mirrored eye, and t as a fraction."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.debug.probes import AXES, fields
from raycaster.debug.probes.ray import Place, Probe, Ray, Value
from raycaster.debug.probes.units import SIGNS, UnitProbes
from raycaster.output import printable
from raycaster.rtl.common.records import Signs, mirror_of, surface_of
from raycaster.scene import Light

SURFACE = ("axis", "position", "colour")


def mirror(ray: Ray, place: Place) -> Sequence[Value]:
    """1 if the ray has left a mirror, else 0; then the mirror's axis and distance from the eye."""
    if place.bounce == 0:
        return 0, None, None
    left = Place(place.bounce - 1, ray.winner(place.bounce - 1))
    axis, _, _ = ray.plane(left)
    return 1, axis, ray.of_rectangle(left, "numerators")


def surface(ray: Ray, rectangle: int) -> Sequence[Value] | None:
    """A rectangle's axis, plane and colour; None for -1."""
    return (*ray.plane(Place(0, rectangle))[:2], ray.colour(rectangle)) if rectangle >= 0 else None


def fraction(ray: Ray, place: Place) -> Sequence[Value] | None:
    """t of a hit, as numerator and denominator."""
    if place.index < 0 or not ray.of_rectangle(place, "hits"):
        return None
    return ray.of_rectangle(place, "numerators"), ray.of_rectangle(place, "denominators")


def light_on(ray: Ray, place: Place) -> Light | None:
    """Return the scene's light; None if the ray hit nothing that it could light."""
    return ray.scene.light if ray.alive(place.bounce) and ray.winner(place.bounce) >= 0 else None


def lighting(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Say whether the light reaches the hit point and, if not, why; None for a miss."""
    if light_on(ray, place) is None:
        return None
    shading = ray.golden.shadings[place.bounce]
    if not shading.facing[0]:
        return ("on the dark side",)
    shades = int(shading.shades[0])
    return (f"shaded by {shades} {printable(ray.scene.rect[shades].name)}".rstrip() if shades >= 0 else "lit",)


def hardware_lighting(ray: Ray, place: Place, facing: int, shaded: int) -> Sequence[Value]:
    """Say what the unit found, in the model's words if they agree: the unit does not know which rectangle shades."""
    found = "on the dark side" if not facing else "shaded" if shaded else "lit"
    golden = lighting(ray, place)
    return golden if golden and str(golden[0]).startswith(found) else (found,)


def shadow_slope(ray: Ray, place: Place) -> Sequence[Value] | None:
    """Magnitudes of the shadow ray's slope; None for a miss."""
    light = light_on(ray, place)
    if light is None:
        return None
    point, e = ray.golden.points[place.bounce][0], int(ray.golden.denominators[place.bounce][0])
    return [abs(int(n) - e * part) for n, part in zip(point, light.position, strict=True)]


class ExactProbes(UnitProbes):
    """The exact engine's description; see `raycaster.debug.probes.ray.Description`."""

    modules = ("exact_control", "exact_unit")

    @property
    def probes(self) -> list[Probe]:
        """Probes in the order in which values depend on each other."""
        memory, tester, keeper = (f"{self.unit}.{name}_i" for name in ("eye_register", "rect_tester", "nearest_hit"))
        kept = fields(keeper, "found_surface", SURFACE, surface_of(self.config))
        t = tuple(f"{tester}.{name}" for name in ("numerator", "denominator"))
        nearest_t = tuple(f"{keeper}.found_{name}" for name in ("distance", "slope"))
        return [
            *self.first_probes(),
            Probe("eye", fields(memory, "eye", AXES), "ray", Ray.origin, late=1, signed=True, parts=AXES),
            Probe("signs", fields(memory, "signs", SIGNS, Signs()), "ray", Ray.slope_signs, late=1, parts=AXES),
            Probe("mirror", fields(memory, "mirror", ("active", "axis", "distance"), mirror_of(self.config)), "ray",
                mirror, late=1, shown=False),
            Probe("offered", fields(self.control, "offered", SURFACE, surface_of(self.config)), "write",
                lambda ray, place: surface(ray, place.index), colour=(2,), shown=False),
            Probe("inside", (f"{tester}.hit",), "write", Ray.hit),
            Probe("t", t, "write", fraction),
            Probe("nearest t", nearest_t, "write",
                lambda ray, place: fraction(ray, Place(place.bounce, ray.nearest(place))), late=1),
            Probe("nearest", kept, "write", lambda ray, place: surface(ray, ray.nearest(place)), late=1,
                colour=(2,), shown=False),
            *(self._light_probes() if self.config.light else []),
            *self.last_probes(kept[-1]),
        ]  # fmt: skip

    def _light_probes(self) -> list[Probe]:
        """Probes of the shadow ray and of its result."""
        shadow = f"{self.unit}.shadow_ray_i"
        facing, shaded = f"{shadow}.facing", f"{self.unit}.shadow_register_i.shaded"
        return [
            Probe("slope from the light", fields(shadow, "shadow_slope", SIGNS), "blend", shadow_slope, parts=AXES),
            Probe("light", (facing, shaded), "blend", lighting, decode=hardware_lighting, module="shadow_register"),
        ]
