# SPDX-License-Identifier: MIT
"""Functional coverage of rays and rectangles: the kinds of intersection in a scene, counted in the golden model.

Rectangles that the seed engine gives up before their division are not counted. In a design with culling, a rectangle is
counted for the primary rays of a group if one of them hits it: the culler may leave out all others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from raycaster.configuration import Configuration
from raycaster.engines import ENGINES, Engine
from raycaster.golden.model import Bounce
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.engine.ray_sequencer import ends_early
from raycaster.scene import Scene
from raycaster.verif.coverage.functional import RAYS, Cross, Pattern, traces

HITS = "edge", "hit"

# A control that waits for divisions skips a rectangle that no ray of the group runs towards.
_GIVEN_UP: dict[str, tuple[Pattern, ...]] = {
    "a group's primary rays run the same way from one point; a plane that none runs towards is skipped": (
        (None, None, "on plane", None, "primary"),
        (None, None, "behind", None, "primary"),
    ),
    "all rays of a group have the row's slope along z, so a plane that they are parallel to is skipped": (
        ("z", None, "parallel", None, None),
    ),
}
_WITHOUT_MIRROR: dict[str, tuple[Pattern, ...]] = {
    "primary rays have left no mirror": ((None, None, "before mirror", None, "primary"),),
}
_CULLED: dict[str, tuple[Pattern, ...]] = {
    "a group's primary rays run the same way from one point; a plane that none hits may be left out": (
        (None, None, "on plane", None, "primary"),
        (None, None, "behind", None, "primary"),
        ("z", None, "parallel", None, "primary"),
    ),
}


def _every_kind(engine: Engine) -> Cross:
    """Return the intersections of an engine, of all of its designs."""
    # In order of precedence: parallel to the plane; from a point on it; running away from it; in the seed engine, a
    # quotient on u or v that is too large; in the others, between the mirrored eye and the mirror, or in the mirror's
    # plane on an axis that was met there, though within the bounds; outside the bounds; exactly on a bound; inside.
    fourth = "overflow" if engine.divides else "before mirror"
    missed = "parallel", "on plane", "behind", fourth, "miss"
    points = {
        "axis": ("x", "y", "z"),  # of the rectangle's plane
        "slope": ("negative", "zero", "positive"),  # of the ray on that axis
        "result": (*missed, *HITS),
        "rank": ("none", "first", "nearer", "tie", "farther"),  # of a hit
        "ray": RAYS,
    }
    impossible: dict[str, tuple[Pattern, ...]] = {
        "a ray without a slope along the axis of a plane never reaches it": tuple(
            (None, "zero", result, None, None) for result in points["result"] if result != "parallel"
        ),
        "a ray with a slope along the axis of a plane is not parallel to it": tuple(
            (None, slope, "parallel", None, None) for slope in ("negative", "positive")
        ),
        "every hit is ranked": tuple((None, None, result, "none", None) for result in HITS),
        "only hits are ranked": tuple(
            (None, None, result, rank, None) for result in missed for rank in points["rank"][1:]
        ),
        "the slope along x has magnitude 100, never 0": (("x", "zero", None, None, None),),
        "primary rays run along positive x": (("x", "negative", None, None, "primary"),),
    }
    return Cross("intersections", points, impossible | (_GIVEN_UP if engine.divides else _WITHOUT_MIRROR))


INTERSECTIONS = {name: _every_kind(engine) for name, engine in ENGINES.items()}
"""By engine, the intersections of a ray with a rectangle."""


def cross_of(config: Configuration) -> Cross:
    """Return the intersections that a design counts: with culling, a group's primary rays meet fewer kinds."""
    cross = INTERSECTIONS[config.engine]
    fewer = _CULLED if config.culling and not config.facts.divides else {}
    return replace(cross, impossible={**cross.impossible, **fewer})


def count_intersections(scene: Scene, config: Configuration) -> np.ndarray:
    """Count the intersections of a scene's picture; int64, with one axis per point of `INTERSECTIONS`."""
    kinds = (
        (*kind, ray)
        for rectangles, traced in traces(scene, config, keep=True)
        for ray, bounce in enumerate(traced.bounces)
        for kind in _kinds(rectangles, bounce, config, culled=config.culling and ray == 0)
    )
    return INTERSECTIONS[config.engine].counted(kinds)


def _kinds(
    rectangles: Rectangles, bounce: Bounce, config: Configuration, *, culled: bool
) -> Iterator[tuple[np.ndarray | int, ...]]:
    """Yield, for each rectangle, the kinds of all rays that are tested against it, without the last point."""
    # 1 / 0 lies beyond every depth.
    nearest, nearest_scale = np.ones_like(bounce.alive, dtype=np.int64), np.zeros_like(bounce.alive, dtype=np.int64)
    for index in np.flatnonzero(rectangles.visible):
        axis, hit, scale = rectangles.axes[index], bounce.hits[index], bounce.scales[index]
        n, e, depth = bounce.numerators[index], bounce.denominators[index], bounce.depths[index]
        extent = list(OTHER_AXES[axis])
        point, low, high = (
            bounce.points[index][:, extent],
            rectangles.low[index, extent],
            rectangles.high[index, extent],
        )
        low, high = low * scale[:, None], high * scale[:, None]
        within, on_bound = (
            ((low <= point) & (point <= high)).all(axis=1),
            ((low == point) | (point == high)).any(axis=1),
        )
        # A quotient that is too large has no point.
        fourth = ~bounce.valid[index].all(axis=1) & (within | config.facts.divides)
        result = np.select([e == 0, n == 0, n * e < 0, fourth, ~hit, on_bound], range(6), 6)
        ours, theirs = depth * nearest_scale, nearest * scale
        rank = np.select([~hit, nearest_scale == 0, ours < theirs, ours == theirs], range(4), 4)
        tested = bounce.alive.copy()
        if ends_early(config):
            tested &= _any_in_group(tested & (n * e > 0), config)
        if culled:
            tested &= _any_in_group(hit, config)
        yield axis, (np.sign(bounce.slopes[:, axis]) + 1)[tested], result[tested], rank[tested]
        nearer = hit & (ours < theirs)
        np.copyto(nearest, depth, where=nearer)
        np.copyto(nearest_scale, scale, where=nearer)


def _any_in_group(rays: np.ndarray, config: Configuration) -> np.ndarray:
    """Return, for each ray, whether any ray of its group is among these, bool (rays,)."""
    return np.repeat(rays.reshape(-1, config.units).any(axis=1), config.units)
