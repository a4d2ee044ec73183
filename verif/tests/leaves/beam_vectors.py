# SPDX-License-Identifier: MIT
"""Vectors and exact arithmetic for leaf tests of the beam engine's blocks."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import gcd
from typing import Any

import numpy as np
from hard_scenes import sharpened, verdict
from vectors import AXES, LAST, Bench, any_place, by_axis, colour_word, designs, named

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.design.decide import configure
from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.beam.latencies import TESTER_LATENCY, fold_lead, is_staged, slope_at
from raycaster.rtl.common.records import Candidate, Facet, Walk, stride_of
from raycaster.rtl.common.widths import steepest_slope, walk_bits
from raycaster.verif.random_world import random_basis, random_camera, random_rectangles

P, Q = (1, 0, 1), (2, 2, 0)
"""The axes p and q, indexed by a plane's axis: p is y unless the plane is on y, q is z unless it is on z."""

WALK = ("way_p", "low_p", "high_p", "low_q", "high_q")

CANDIDATE = ("valid", "at_mirror", "numerator", "denominator", "index")


def beam_config(*, reflections: int = 1, **options) -> Configuration:
    """Make a design; its reflections may take longer to set up than a line's blanking, as leaf tests need."""
    return replace(configure(engine="beam", reflections=0, **options), reflections=reflections)


BY_SCREEN = (
    beam_config(reflections=0, rows=200, scale=1),
    beam_config(reflections=1, rows=180),
    beam_config(reflections=2, rows=240),
    beam_config(reflections=2, screen="tiny"),
    beam_config(reflections=1, rows=180, turn=True),
    beam_config(reflections=2, rows=240, turn=True, materials=True, patterns=True),
    beam_config(reflections=2, screen="tiny", turn=True),
    beam_config(reflections=1, rows=180, scale=6, pixels=2),
    beam_config(reflections=1, rows=180, scale=6, pixels=2, turn=True),
    beam_config(reflections=1, screen="tiny", pixels=2, turn=True),
)
"""Designs of each screen, with and without each feature."""

by_screen = designs(*BY_SCREEN)


def products(table: Rectangles, index: int, camera, slope, names=()) -> dict[str, int]:
    """Compute the products that cross-multiplication compares, the distance and way_q; or those of these names."""
    axis = int(table.axes[index])
    low, high = (bound[index].astype(object) - camera for bound in (table.low, table.high))
    n, e = int(low[axis]), int(slope[axis])
    p, q = P[axis], Q[axis]
    found = {
        "distance": n,
        "way_p": n * int(slope[p]),
        "way_q": n * int(slope[q]),
        "low_p": int(low[p]) * e,
        "high_p": int(high[p]) * e,
        "low_q": int(low[q]) * e,
        "high_q": int(high[q]) * e,
    }
    return {name: found[name] for name in names or found}


def flat_tables(random: np.random.Generator, count: int) -> Rectangles:
    """Make a table whose rectangles all have a plane; corners of the world are common."""
    corners = np.array([[[any_place(random) for _ in AXES] for _ in range(2)] for _ in range(count)])
    axis = random.integers(3, size=count)
    corners[np.arange(count), 1, axis] = corners[np.arange(count), 0, axis]
    return Rectangles(corners, random.integers(256, size=(count, 3)).astype(np.uint8), random.random(count) < 0.8)


def row_slopes(random: np.random.Generator, config: Configuration, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the slope of a column from which a lane takes this many steps, and a step's increment."""
    screen = config.screen_geometry
    row, column = int(random.integers(screen.rows)), int(random.integers(screen.columns - columns * config.pixels + 1))
    basis = np.array(random_basis(random) if config.turn else np.eye(3), dtype=np.int64)
    factors = [screen.view_distance, column - screen.centre_column, screen.horizon_row - row]
    return factors @ basis, config.pixels * basis[1]


def beam_rays(random: np.random.Generator, config: Configuration, count: int, most: int | None = None):
    """Yield tables, indices of rectangles to test, cameras, slopes and mirrors (axis and plane, as the ray meets them).

    They are as the engine meets them, and as extreme as its widths allow. most: the most mirrors; by default, as many
    as the design has reflections.
    """
    most = config.reflections if most is None else most
    steepest, view = steepest_slope(config), config.screen_geometry.view_distance
    powers = 1 << np.arange(steepest.bit_length())
    for _ in range(count):
        table = random_rectangles(random, count=8, closed=True)
        camera = random_camera(random, table).astype(np.int64)
        # With a power of two a single bit decides; with a small slope, the lowest bits of the ways do.
        extremes = [0, view, steepest, random.choice(powers), *random.integers([4, 16, 16, steepest])]
        slope = random.choice(extremes, 3) * random.choice([-1, 1], 3)
        if not config.turn:
            slope[0] = view
        wanted = int(random.integers(most + 1))
        mirrors: list[tuple[int, int]] = []
        met = Fraction(0)
        for _ in range(20):
            if len(mirrors) == wanted:
                break
            axis, plane = int(random.integers(3)), any_place(random)
            eye, turned = seen_from(camera, slope, mirrors)
            if mirrors and random.random() < 0.3:
                # Mirrors on opposite sides of the world move the image as far away as possible.
                axis, plane = mirrors[-1][0], LAST - mirrors[-1][1]
            elif mirrors and random.random() < 0.6:
                # Through the point where the last mirror was met, if its coordinate on this axis is whole too.
                plane = coordinate(eye, turned, met, axis)
            elif turned[axis] and random.random() < 0.6:
                plane = coordinate(eye, turned, time_ahead(random, eye, turned, met, axis), axis)
            if not turned[axis]:
                continue
            t = Fraction(int(plane - eye[axis]), int(turned[axis]))
            # Mirrors in one point, a corner, are on different axes.
            if t > met or (t == met and mirrors and axis not in met_last(camera, slope, mirrors)):
                met = t
                mirrors.append((axis, plane))
        eye, turned = seen_from(camera, slope, mirrors)
        chosen = random.choice(np.flatnonzero(table.visible), 4)
        for index in chosen:
            axis, corners = int(table.axes[index]), table.corners.copy()
            if turned[axis] and random.random() < 0.8:
                # A third plane may go through the mirrors' corner.
                t = met if random.random() < 0.4 else time_ahead(random, eye, turned, met, axis)
                corners[index, :, axis] = coordinate(eye, turned, t, axis)
                table = Rectangles(corners, table.colours, table.enabled)
            table = sharpened(random, table, int(index), eye, turned, mirrors[-1] if mirrors else None)
        yield table, set(chosen.tolist()), camera, slope, mirrors


def time_ahead(random: np.random.Generator, eye, turned, met: Fraction, axis: int) -> Fraction:
    """Pick a time between a ray's last mirror and its exit from the world; often with whole coordinates on two axes."""
    exits = ((LAST * (slope > 0) - place, slope) for place, slope in zip(eye.tolist(), turned.tolist(), strict=True))
    left = min(Fraction(way, slope) for way, slope in exits if slope)
    t = met + max(left - met, 0) * Fraction(int(random.integers(1, 65)), 64)
    if random.random() < 0.6:
        parts = int(np.gcd(turned[axis], turned[random.choice(OTHER_AXES[axis])]))
        t = Fraction(round(t * parts), parts)
    return t


def coordinate(eye, turned, t: Fraction, axis: int) -> int:
    """Return a ray's coordinate at time t, clipped to the world."""
    return int(np.clip(int(eye[axis] + int(turned[axis]) * t), 0, LAST))


def seen_from(camera, slope, mirrors) -> tuple[np.ndarray, np.ndarray]:
    """Return the camera and the slope, mirrored."""
    eye, turned = np.array(camera), np.array(slope)
    for axis, plane in mirrors:
        eye[axis], turned[axis] = 2 * plane - eye[axis], -turned[axis]
    return eye, turned


def met_last(camera, slope, mirrors) -> list[int]:
    """Return the axes of the mirrors in the point that a ray left last."""
    times = []
    for number, (axis, plane) in enumerate(mirrors):
        eye, turned = seen_from(camera, slope, mirrors[:number])
        times.append(Fraction(int(plane - eye[axis]), int(turned[axis])))
    return [axis for t, (axis, _) in zip(times, mirrors, strict=True) if t == times[-1]]


def image_of(camera, slope, mirrors) -> dict[str, int]:
    """Return the room's image by its definition: x - E = +-(X - E) + T, with x on the ray from the mirrored camera."""
    eye, _ = seen_from(camera, slope, mirrors)
    met = met_last(camera, slope, mirrors)
    fields = by_axis("met_", (int(axis in met) for axis in range(3)))
    fields |= by_axis("back_", (sum(axis == mirror for mirror, _ in mirrors) % 2 for axis in range(3)))
    return fields | by_axis("shift_", (int(there) - int(here) for there, here in zip(eye, camera, strict=True)))


def folded(camera, slope, mirrors) -> dict[str, int]:
    """Return the fold of a ray in the image of the room."""
    eye, turned = seen_from(camera, slope, mirrors)
    turn = [int(value) for value in eye - camera]
    fields = image_of(camera, slope, mirrors)
    back = [fields[f"back_{name}"] for name in AXES]
    for letter, others in (("p", P), ("q", Q)):
        for axis, other in enumerate(others):
            flip = back[axis] != back[other]
            sign = -1 if flip else 1
            fields[f"{letter}_{AXES[axis]}"] = (
                turn[other] * int(slope[axis]) - sign * turn[axis] * int(slope[other]) + flip
            )
    axis, plane = mirrors[-1] if mirrors else (0, int(camera[0]))
    distance = plane - int(camera[axis])
    fields |= by_axis("border_", (distance * int(component) for component in slope))
    return fields | {"mirror_back": int(turned[axis] < 0), "axis": axis, "distance": distance}


def check_tester(leaf_of: Callable[..., Bench], block: Callable, config: Configuration, random: np.random.Generator):
    """Test mirrored rays if the block has a port for their fold, otherwise rays from the camera."""
    leaf = leaf_of(block, config, hit=lambda: Candidate(config), staged=is_staged(config))
    folds = "fold_axis" in leaf.given
    lead = fold_lead(config) if folds else 0
    strobes = ("step_way", "step_bounds", "step_slope")
    seen = set()
    # The more mirrors, the fewer of them meet in one point.
    count, most = (3600 * max(1, config.reflections - 1), None) if folds else (1500, 0)
    for table, chosen, camera, slope, mirrors in beam_rays(random, config, leaf.some(count), most):
        if bool(mirrors) != folds:
            continue
        fold = named("fold", folded(camera, slope, mirrors)) if folds else {}
        eye, turned = seen_from(camera, slope, mirrors)
        met = met_last(camera, slope, mirrors)
        for index in chosen:
            now = products(table, index, camera, slope)
            usable, cell = int(random.random() < 0.9), int(random.integers(8)) if config.patterns else 0
            facet = {"facet_usable": usable, "facet_axis": table.axes[index], "facet_distance": now["distance"]}
            way_q = {"walk_way_q" if config.turn else "facet_way_q": now["way_q"]}
            bounds = {f"walk_{name}": now[name] for name in WALK if name != "way_p"}
            # Between its strobes a stage keeps its values.
            cycles: list[dict[str, Any]] = [dict.fromkeys(strobes, 0) for _ in range(lead + 3)]
            cycles[0] |= facet | ({"facet_cell": cell} if config.patterns else {}) | fold
            cycles[lead] |= by_axis("signs_d", (int(part < 0) for part in slope))
            cycles[lead if folds else 1] |= {"walk_way_p": now["way_p"], **way_q}
            cycles[lead + 1] |= bounds
            cycles[lead + slope_at(config)] |= by_axis("slope_d", map(abs, slope))
            # Any index in the design; the table has fewer rectangles.
            number = int(random.integers(config.rectangles))
            cycles[lead + 2] |= {"index": number}
            # Inputs without their strobe belong to another ray.
            cycles[lead + 1] |= by_axis("signs_d", [int(random.integers(2)) for _ in AXES])
            cycles[lead + 2] |= {name: int(random.integers(1 << walk_bits(config))) for name in bounds}
            for cycle, strobe in enumerate(strobes, lead):
                cycles[cycle] |= {strobe: 1}
            hit, n, e, at_mirror = verdict(table, index, eye, turned, mirrors[-1] if mirrors else None, met)
            seen.add((len(met), hit, at_mirror))
            wanted = {"valid": hit and usable, "index": number}
            wanted |= {"axis": table.axes[index], "cell": cell} if config.patterns else {}
            wanted |= {"at_mirror": at_mirror, "numerator": n, "denominator": e} if hit else {}
            leaf.expected[leaf.cycle + lead + TESTER_LATENCY] = named("hit", wanted)
            leaf.stimulus += cycles
    # No mirror: miss or hit. One, or two in one point: also a hit in that point. Three in one point hide the rest.
    assert len([case for case in seen if case[0] < 3]) == (3 * min(config.reflections, 2) if folds else 2)
    assert ((3, False, False) in seen) == (config.reflections > 2 and folds)
    leaf.case(dict.fromkeys(strobes, 0))
    leaf.check(settled=lead + TESTER_LATENCY)


@cache
def candidate_limits(config: Configuration) -> tuple[int, int]:
    """Return the greatest numerator and denominator."""
    candidate = Candidate(config)
    return tuple((1 << len(signal)) - 1 for signal in (candidate.numerator, candidate.denominator))


def any_candidate(random: np.random.Generator, config: Configuration) -> tuple[int, int, int, int, int]:
    """Return valid, at_mirror, numerator, denominator and index; equal fractions in other terms are common."""
    most = candidate_limits(config)
    if random.random() < 0.4:
        n, e, times = int(random.integers(1, 4)), int(random.integers(1, 4)), int(random.integers(1, 60))
        n, e = n * times, e * times
    else:
        n, e = (int(random.choice([1, limit, random.integers(1, limit)])) for limit in most)
    return int(random.random() < 0.8), int(random.integers(2)), n, e, int(random.integers(config.rectangles))


def close_candidates(random: np.random.Generator, config: Configuration) -> tuple:
    """Return two candidates whose cross products are large and differ by at most two."""
    most, most_below = candidate_limits(config)
    # With denominators far wider than numerators, such pairs are rare and take long to find.
    if random.random() < 0.9:
        most_below = min(most, most_below)
    while True:
        apart, *below = map(int, [random.integers(-2, 3), *random.integers(most_below // 2, most_below, size=2)])
        if gcd(*below) > 1:
            continue
        first = -apart * pow(below[1], -1, below[0]) % below[0]
        first += below[0] * int(random.integers(most // below[0] + 1))
        second = (first * below[1] + apart) // below[0]
        if 0 < first <= most and 0 < second <= most:
            indices = map(int, random.integers(config.rectangles, size=2))
            corners = map(int, random.integers(2, size=2))
            return tuple((1, *one) for one in zip(corners, (first, second), below, indices, strict=True))


def candidate_ports(config: Configuration, name: str, candidate) -> dict[str, int]:
    """Return a candidate as the fields of a port."""
    fields = dict(zip(CANDIDATE, candidate, strict=True))
    return named(name, fields | ({"axis": fields["index"] % 3, "cell": fields["index"] % 8} if config.patterns else {}))


def fraction_of(candidate) -> Fraction:
    _, _, numerator, denominator, _ = candidate
    return Fraction(numerator, denominator)


def first_of(config: Configuration, candidates) -> dict[str, int]:
    """Return the ports of the nearest candidate, of equal ones the first."""
    valid = [candidate for candidate in candidates if candidate[0]]
    return candidate_ports(config, "nearest", min(valid, key=fraction_of)) if valid else {"nearest_valid": 0}


def any_facets(random: np.random.Generator, config: Configuration) -> tuple[list[dict[str, int]], int]:
    """Return the fields of random facets, and all facets packed side by side."""
    record = Facet(config)
    facets = [
        {name: int(random.integers(1 << bits)) for name, bits in record.layout.items()}
        for _ in range(config.rectangles)
    ]
    return facets, sum(record.pack(facet) << i * len(record.word) for i, facet in enumerate(facets))


def opened(random: np.random.Generator, corners: np.ndarray, axis: int, plane: int, eye, turned) -> Fraction:
    """Change a rectangle so that a ray hits it near two of its edges; return the time of the hit."""
    corners[:, axis] = plane
    t = Fraction(int(plane - eye[axis]), int(turned[axis]))
    for u in OTHER_AXES[axis]:
        point = eye[u] + int(turned[u]) * t
        edge = int(np.clip(int(point) + int(random.choice([-1, 0, 0, 1])), 0, LAST))
        side = LAST if edge < point or (edge == point and random.random() < 0.5) else 0
        corners[:, u] = random.permutation([edge, side if random.random() < 0.7 else (any_place(random) + side) // 2])
    return t


def last_hits(table: Rectangles, camera, slope, mirrors: int) -> int:
    """Count the rectangles in a ray's way after its last mirror; faster than a whole trace."""
    eye, way = (np.array(one, dtype=np.int64)[:, None] for one in (camera, slope))
    for number, (winner, *_, bounce) in enumerate(ExactModel().meetings(table, eye, way, keep=True)):
        if number == mirrors or winner[0] < 0:
            return int(bounce.hits.sum()) if number == mirrors else 0
    raise AssertionError("a ray ends")


def race(random: np.random.Generator, config: Configuration, slopes) -> tuple[np.ndarray, Rectangles, int]:
    """Return a camera, a table, and the column of a ray that meets mirrors near their edges.

    After the mirrors, the ray meets two rectangles almost at once, or one next to the last mirror.
    """
    count, before_centre = config.rectangles, config.screen_geometry.centre_column - 1
    ends = int(random.integers(min(config.reflections + 1, count), size=2).max())
    by_mirror = ends > 0 and random.random() < 0.25
    # A camera that can turn more often looks where no second mirror is in reach.
    for _ in range(5000):
        camera, table = random.integers(WORLD_SIZE, size=3), flat_tables(random, count)
        corners, order = table.corners.copy(), random.permutation(count)
        # The last column with a negative slope along y is the only one whose right neighbour has another sign.
        column = before_centre if random.random() < 0.1 else int(random.integers(len(slopes), size=2).min())
        # After two or more mirrors, the lowest bits decide where a small odd slope reaches an edge exactly.
        if ends >= 2 and random.random() < 0.5:
            column = before_centre + 1 + int(random.choice([-3, -1, 1, 3]))
        mirrors: list[tuple[int, int]] = []
        times = [Fraction(0)]
        for bounce in range(ends + 1):
            eye, turned = seen_from(camera, slopes[column], mirrors)
            axis = int(random.choice(np.flatnonzero(turned)))
            t = time_ahead(random, eye, turned, times[-1], axis)
            if bounce >= 2 and by_mirror:
                t = times[-1]
            elif bounce >= 2:
                # The ray may meet the mirror before the last again, which then is the other of the two rectangles.
                again, first = mirrors[-2]
                t = max(times[-1], Fraction(int(first - eye[again]), int(turned[again])))
            plane = coordinate(eye, turned, t, axis)
            if bounce >= 2:
                plane = min(max(plane + int(random.integers(-1, 2)), 0), LAST)
            times.append(opened(random, corners[order[bounce]], axis, plane, eye, turned))
            mirrors.append((axis, plane))
        if ends + 1 < count:
            axis = int(random.choice(np.flatnonzero(turned)))
            plane = coordinate(eye, turned, times[-2 if by_mirror else -1], axis) + int(random.integers(-1, 2))
            opened(random, corners[order[ends + 1]], axis, min(max(plane, 0), LAST), eye, turned)
        table = Rectangles(corners, table.colours, np.ones(count, dtype=bool))
        if last_hits(table, camera, slopes[column], ends) >= min(1 if by_mirror else 2, count):
            return camera, table, column
    raise AssertionError(f"no ray meets two rectangles, or one next to a mirror, after {ends} reflections")


def row_ports(config: Configuration, table: Rectangles, camera, slopes) -> tuple[dict[str, int], list[dict[str, int]]]:
    """Return the values held on a lane's ports during a row, and the extra inputs of the row's first cycles.

    slopes: of the lane's first column, and of the lane's next column to the right.
    """
    facet, growth = Facet(config), stride_of(config)
    begin: list[dict[str, int]] = [{"start_line": 1}]
    facets = growths = 0
    for index in range(config.rectangles):
        now, then = (products(table, index, camera, slope) for slope in slopes)
        seen = {"usable": 1, "axis": table.axes[index], "distance": now["distance"], "way_q": now["way_q"]}
        seen["colour"] = colour_word(table.colours[index])
        more = {name: config.pixels * (then[name] - now[name]) for name in WALK}
        facets |= facet.pack(seen) << index * len(facet.word)
        growths |= growth.pack(more) << index * len(growth.word)
        begin.append({f"start_{name}": now[name] for name in WALK} | {"load": 1 << index})
    return by_axis("aim_", slopes[0]) | {"facets": facets, "growths": growths, "start_line": 0, "load": 0}, begin


def any_view(random: np.random.Generator, config: Configuration) -> np.ndarray:
    """Return a row's slopes as on another screen, so that every bit of the slopes matters."""
    slopes, steepest = primary_slopes(config.screen_geometry), steepest_slope(config)
    spare = steepest - int(abs(slopes[..., 1]).max())
    view = slopes[int(random.integers(len(slopes)))].copy()
    view[:, 0] = random.integers(1, steepest + 1)
    view[:, 1] += random.integers(-spare, spare + 1)
    view[:, 2] = random.integers(-steepest, steepest + 1)
    return view


def row_ports_of(config: Configuration) -> dict[str, Any]:
    """Return the signals that carry a row's set-up to a lane and to each of its passes, as for `leaf_of`."""
    growths = config.rectangles * len(stride_of(config).word)
    return {"load": config.rectangles, "start": lambda: Walk(config), "growths": growths}
