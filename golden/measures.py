# SPDX-License-Identifier: MIT
"""Measures of a picture's errors, in the terms of numerical analysis (Higham 2002, chapter 1).

Forward error: the distance of a computed hit point from the right one. Backward error: the least change of the ray for
which the result is right. Relative condition number: the relative change of a hit point per relative change of the
slope, for small changes.

A hit point is P = E + D n / e, with e = D[a], on a plane across axis a, and E is the eye, mirrored in the mirrors so
far. A change of D moves P within the plane by (n / e) (I - D e_a^T / e) times the change. That matrix projects along D,
so its norm is that of its complement, |D| / |e|; relative to |P - E| = |D| n / e, the condition number is |D| / |e|,
one over the cosine of the angle of incidence. Mirrors do not change it, as they change only signs.

Let a point Q be computed on the right plane. A ray towards Q differs from D by an angle b, so its least relative
change is sin b. By the law of sines in the triangle of E, P and Q, |Q - P| / |P - E| = sin b / sin q, where q is the
angle between plane and ray at Q or greater. So forward error <= condition number at Q x backward error, without any
approximation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from raycaster.golden.backward import backward_errors
from raycaster.golden.exact import ExactModel
from raycaster.golden.model import Model, Trace
from raycaster.golden.rivals import RIVALS, RivalModel
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.scene import Scene

NOISE = 1e-9
"""Relative forward error below which the rule is not checked, because the check itself is computed in float64."""

ROUNDING_MODELS: dict[str, SeedModel | RivalModel] = {
    "seed-0": SeedModel(),
    "seed-4": SeedModel(4, "nearest"),
    "seed-8": SeedModel(8, "nearest"),
    **RIVALS,
}
"""Golden models that round, by name: the seed engine with F = 0, truncated, with 4 and 8, to nearest, and others."""

ARITHMETICS: dict[str, Model] = {"exact": ExactModel(), **ROUNDING_MODELS}
"""Golden models by name; the exact one serves the exact and the beam engine."""


def relative_conditions(slopes: np.ndarray, perfect: Trace) -> tuple[np.ndarray, ...]:
    """Return the relative condition number of each intersection; see above.

    Args:
        slopes: int (rays, 3): slopes of the rays.
        perfect: exact trace of the rays.

    Returns:
        By depth of reflection, float (rays,), 1 or more; NaN where nothing is hit.
    """
    length = np.sqrt((np.asarray(slopes, dtype=float) ** 2).sum(axis=1))
    return tuple(
        np.where(winner >= 0, length / np.where(winner >= 0, denominator, 1), np.nan)
        for winner, denominator in zip(perfect.winners, perfect.denominators, strict=True)
    )


def hit_errors(
    axes: np.ndarray, camera: np.ndarray, slopes: np.ndarray, points: np.ndarray, right: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return relative forward errors, condition numbers at the computed points, and relative backward errors.

    Args:
        axes: int (rays,): the axes of the planes that primary rays hit.
        camera: (3,).
        slopes: (rays, 3).
        points: float (rays, 3): computed hit points.
        right: float (rays, 3): exact hit points.

    Returns:
        Each float (rays,): |Q - P| / |P - E|; |Q - E| / |Q[a] - E[a]|; the sine of the angle between Q - E and D. If a
        point is not on its plane, Q is where the ray towards it meets the plane.
    """
    way, found = right - camera, points - camera
    height, found_height = (np.take_along_axis(one, axes[:, None], axis=1) for one in (way, found))
    found *= height / found_height
    # The difference instead of Q, because it is small: its product with D loses no digits.
    sine = _length(np.cross(found - way, slopes)) / (_length(found) * _length(slopes))
    return _length(found - way) / _length(way), _length(found) / np.abs(height[:, 0]), sine


def measures(
    model: SeedModel | RivalModel, scene: Scene, slopes: np.ndarray, perfect: Trace, reflections: int
) -> dict[str, Any]:
    """Compare a model's picture with the exact one.

    Args:
        model: a model that rounds.
        scene: the scene.
        slopes: int (rows, columns, 3): slopes of the primary rays.
        perfect: exact trace of the rays, with this number of reflections.
        reflections: 0 or more.

    Returns:
        wrong: number of wrong pixels.
        flipped: number of rays that meet other rectangles than the exact ray.
        never: number of flipped rays that no slope on the screen makes right.
        near, far: number of flipped rays whose backward error is more than 0.01 and 1 pixel, with those of never.
        backward: the greatest finite backward error, in pixels; backward_mean: the mean of all finite ones.
        forward: the greatest error of a coordinate of a primary ray's hit point, in world units, among the rays that
            hit the right rectangle.
        of_bound: the greatest ratio of such an error to its derived bound; None for a turned camera, whose slopes are
            rounded too.
        relative: relative forward error, condition number and relative backward error of the primary ray with the
            greatest relative forward error; None if no ray hits.
        by_rule: the greatest ratio of a relative forward error to the product of condition number and backward error.
    """
    rectangles, camera = Rectangles.of_scene(scene), scene.camera.position
    rays = slopes.reshape(-1, 3)
    traced = model.trace(rectangles, camera, scene.background, rays, reflections, light=scene.light)
    errors = backward_errors(rectangles, camera, slopes, traced.winners, perfect.winners)
    finite = errors[np.isfinite(errors)]
    hit = (perfect.winners[0] >= 0) & (traced.winners[0] == perfect.winners[0])
    points, right = (one.points[0][hit] / one.denominators[0][hit, None] for one in (traced, perfect))
    off = np.abs(points - right)
    bound = model.bound(np.array(camera, dtype=float), rays[hit].astype(float), right - camera)
    relative = hit_errors(rectangles.axes[traced.winners[0][hit]], np.array(camera), rays[hit], points, right)
    forward, condition, backward = relative
    allowed = np.where(forward > NOISE, condition * backward, np.inf)
    return {
        "wrong": int((traced.colours != perfect.colours).any(axis=1).sum()),
        "flipped": int(np.any(np.array(traced.winners) != np.array(perfect.winners), axis=0).sum()),
        "never": int(np.isinf(errors).sum()),
        "near": int((errors > 0.01).sum()),
        "far": int((errors > 1).sum()),
        "backward": float(finite.max(initial=0)),
        "backward_mean": float(finite.sum() / max(len(finite), 1)),
        "forward": float(off.max(initial=0)),
        "of_bound": None if scene.camera.turned else float((off / np.where(bound > 0, bound, np.inf)).max(initial=0)),
        "relative": [float(one[forward.argmax()]) for one in relative] if len(forward) else None,
        "by_rule": float((forward / allowed).max(initial=0)),
    }


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.sqrt((np.asarray(vectors, dtype=float) ** 2).sum(axis=-1))
