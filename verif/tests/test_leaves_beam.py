# SPDX-License-Identifier: MIT
"""The beam engine's blocks: MyHDL's simulator, the converted Verilog and exact arithmetic on one set of vectors."""

from fractions import Fraction
from math import gcd

import numpy as np
import pytest
from hard_scenes import pixel_word, sharpened, traced_scene, verdict

from raycaster.configuration import WORLD_SIZE, Configuration, ConfigurationError, configure
from raycaster.golden import exact
from raycaster.golden.random_world import EXTREMES, random_camera, random_rectangles
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.beam import fold_tester as tester
from raycaster.rtl.beam import nearest_of_two as contest
from raycaster.rtl.beam import ray_fold as folder
from raycaster.rtl.beam.beam_caster import beam_caster, beam_latency
from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.beam.nearest_of import nearest_of
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.beam.row_register import row_register
from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.beam.winner_delay import winner_delay
from raycaster.rtl.common.interfaces import Picture, Rects, Slope
from raycaster.rtl.common.records import Facet, Pixel, Point, Reflector, Walk, candidate_of, fold_of
from raycaster.rtl.common.widths import (
    DISTANCE_BITS,
    RGB_BITS,
    TURN_BITS,
    bit,
    exact_slope_bits,
    fold_bits,
    index_bits,
    signed,
    steepest_slope,
    unsigned,
    walk_bits,
)
from raycaster.rtl.engine import rect_setup as setup
from raycaster.rtl.engine.colour_blend import colour_blend
from raycaster.rtl.engine.colour_mean import colour_mean
from raycaster.rtl.engine.rect_setup import rect_setup
from raycaster.screens import BEAM_SCREENS
from raycaster.verif.leaf import Leaf, reset_signal, sorted_rect
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
LAST = WORLD_SIZE - 1
P, Q = (1, 0, 1), (2, 2, 0)
"""By the axis of a plane: p is y unless the plane is on y, q is z unless it is on z."""
WALK = ("way_p", "low_p", "high_p", "low_q", "high_q")


def config_id(value) -> str | None:
    return value.name if isinstance(value, Configuration) else None


def beam_config(**options) -> Configuration:
    return configure(engine="beam", **options)


def word(value: int, bits: int) -> int:
    """A number as its port has it."""
    return int(value) % (1 << bits)


def number(value: int, bits: int) -> int:
    """What a port of two's complement says."""
    return value - (1 << bits) if value >> (bits - 1) else value


def any_place(random: np.random.Generator) -> int:
    return int(random.choice(EXTREMES)) if random.random() < 0.3 else int(random.integers(WORLD_SIZE))


by_screen = pytest.mark.parametrize(
    "config",
    [
        beam_config(reflections=0, rows=200, scale=1),
        beam_config(reflections=1, rows=180),
        beam_config(reflections=2, rows=240),
        beam_config(reflections=2, screen="tiny"),
    ],
    ids=config_id,
)


# The configuration ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "shown"),
    [
        ({}, (640, 480, 2, 1, 25_000_000)),
        ({"scale": 1}, (320, 240, 1, 2, 25_000_000)),
        ({"rows": 200}, (640, 400, 2, 1, 25_000_000)),
        ({"rows": 180}, (1280, 720, 4, 1, 74_250_000)),
        ({"rows": 180, "scale": 1}, (320, 180, 1, 4, 74_250_000)),
        ({"screen": "tiny"}, (128, 96, 2, 1, 25_000_000)),
        ({"screen": "play"}, (320, 240, 1, 1, 6_000_000)),
    ],
)
def test_a_beam_is_as_fine_as_its_monitor(options, shown):
    config = beam_config(**options)
    screen = config.screen_geometry
    assert (screen.columns, screen.rows, screen.scale, screen.doubling, screen.clock_hz) == shown
    assert (config.scale, config.units, config.group_cycles) == (screen.scale, 1, 1)


@pytest.mark.parametrize("options", [{"rows": 240}, {"rows": 200}, {"rows": 180}, {"screen": "tiny"}])
def test_a_finer_view_is_the_same_view(options):
    """The pixel (s row, s column) at scale s is the pixel (row, column) at scale 1."""
    fine = beam_config(**options)
    scale = fine.scale
    coarse = primary_slopes(beam_config(**options, scale=1).screen_geometry)
    assert np.array_equal(primary_slopes(fine.screen_geometry)[::scale, ::scale], scale * coarse)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"units": 4}, "^units: the beam engine is one unit that draws a pixel a clock, not 4$"),
        ({"scale": 3}, "^scale: the beam engine shows 240 rows at 1 or 2, not 3$"),
        ({"rows": 180, "scale": 8}, "^scale: the beam engine shows 180 rows at 1 or 2 or 4, not 8$"),
        ({"fraction_bits": 1}, "^fraction_bits: the beam engine has none, not 1$"),
        ({"engine": "seed", "scale": 2}, "^scale: the seed engine shows 240 rows at 1, not 2; scales need the beam"),
        ({"engine": "exact", "screen": "play"}, "^screen: play needs the beam engine, ENGINE=beam, not exact$"),
        ({"engine": "exact", "rows": 180}, "180 rows need the beam engine, ENGINE=beam$"),
    ],
)
def test_what_the_beam_engine_has_not(options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        configure(**{"engine": "beam"} | options)


@pytest.mark.parametrize("place", BEAM_SCREENS, ids=str)
@pytest.mark.parametrize("rectangles", [1, 2, 12, 32])
@pytest.mark.parametrize("reflections", [0, 1, 2])
def test_every_row_is_set_up_in_its_blanking(place, rectangles, reflections):
    """The latest column has left, and all rectangles are loaded, before the first column's turn."""
    screen, rows = place
    config = beam_config(screen=screen, rows=rows, rectangles=rectangles, reflections=reflections)
    horizontal = config.screen_geometry.horizontal
    # The horizontal sync is seen a pixel after its turn, and the columns start before theirs.
    assert 1 + setup.LATENCY + rectangles <= horizontal.blank - horizontal.front - beam_latency(config)


# rect_setup -----------------------------------------------------------------------------------------------------------


def products(table: Rectangles, index: int, camera, slope) -> dict[str, int]:
    """What cross-multiplication compares, and the distance and way_q."""
    axis = int(table.axes[index])
    low, high = (bound[index].astype(object) - camera for bound in (table.low, table.high))
    n, e = int(low[axis]), int(slope[axis])
    p, q = P[axis], Q[axis]
    return {
        "distance": n,
        "way_p": n * int(slope[p]),
        "way_q": n * int(slope[q]),
        "low_p": int(low[p]) * e,
        "high_p": int(high[p]) * e,
        "low_q": int(low[q]) * e,
        "high_q": int(high[q]) * e,
    }


def flat_tables(random: np.random.Generator, count: int) -> Rectangles:
    """Rectangles that all have a plane; corners of the world are common."""
    corners = np.array([[[any_place(random) for _ in AXES] for _ in range(2)] for _ in range(count)])
    axis = random.integers(3, size=count)
    corners[np.arange(count), 1, axis] = corners[np.arange(count), 0, axis]
    return Rectangles(corners, random.integers(256, size=(count, 3)).astype(np.uint8), random.random(count) < 0.8)


@by_screen
def test_rect_setup(config, tmp_path):
    """Lines at random, the last of which a reset ends."""
    count = config.rectangles
    leaf = Leaf(
        rect_setup,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "start_line": bit(),
            "rects": Rects(config),
            "camera": Point(),
            "column_slope": signed(exact_slope_bits(config) + 1),
            "row_slope": signed(exact_slope_bits(config) + 1),
            "load": unsigned(count),
            "facet": Facet(walk_bits(config)),
            "growth": Walk(DISTANCE_BITS),
            "start": Walk(walk_bits(config)),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes = primary_slopes(config.screen_geometry)
    stimulus = [{"reset": 1}] * 2
    loads = {}
    for line in range(12):
        table = flat_tables(random, count)
        camera = np.array([any_place(random) for _ in AXES])
        row = 0 if line == 0 else len(slopes) - 1 if line == 1 else int(random.integers(len(slopes)))
        held = {f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)}
        held |= {"reset": 0, "start_line": 0, "rects_usable": sum(int(one) << i for i, one in enumerate(table.enabled))}
        start = len(stimulus)
        stimulus += [{**held, "start_line": 1}, held, held]
        column = 0 if line < 4 else int(random.integers(slopes.shape[1] - 1))
        held["column_slope"] = word(slopes[row, column, 1], exact_slope_bits(config) + 1)
        held["row_slope"] = word(slopes[row, column, 2], exact_slope_bits(config) + 1)
        for index in range(count):
            # Two cycles after it was asked for.
            stimulus.append({**held, **sorted_rect(table, index, "rects_rect")})
            loads[start + setup.LATENCY + index] = table, index, camera, slopes[row, column : column + 2]
        stimulus += [held] * (setup.LATENCY + int(random.integers(5)))
    # Every stage of the last line has something at hand.
    end = start + setup.LATENCY + min(1, count - 1)
    stimulus[end] = stimulus[end] | {"reset": 1}
    stimulus[end + 1] = stimulus[end + 1] | {"reset": 0}
    loads = {cycle: load for cycle, load in loads.items() if cycle <= end}
    outputs = leaf.run_both(stimulus, settled=2 + setup.LATENCY)
    width = walk_bits(config)
    for cycle, output in enumerate(outputs[2:], 2):
        assert output["load"] == (1 << loads[cycle][1] if cycle in loads else 0), (cycle, repeat())
    for cycle, (table, index, camera, (first, second)) in loads.items():
        output = outputs[cycle]
        now, then = (products(table, index, camera, slope) for slope in (first, second))
        case = cycle, index, camera, table.corners[index].tolist(), repeat()
        assert output["facet_usable"] == table.enabled[index], case
        assert output["facet_axis"] == table.axes[index], case
        assert number(output["facet_distance"], DISTANCE_BITS) == now["distance"], case
        assert number(output["facet_way_q"], width) == now["way_q"] == then["way_q"], case
        assert output["facet_colour"] == int.from_bytes(bytes(table.colours[index])), case
        for name in WALK:
            assert number(output[f"start_{name}"], width) == now[name], (name, case)
            assert number(output[f"growth_{name}"], DISTANCE_BITS) == then[name] - now[name], (name, case)


# The walkers ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("live", [0xFFF, 0x5C3, 0])
def test_row_register(live, tmp_path):
    """It keeps what is not known, whichever bits these are."""
    leaf = Leaf(
        row_register,
        lambda: {
            "clk": bit(), "load": bit(), "given": unsigned(12), "live": unsigned(12), "known": unsigned(12),
            "word": unsigned(12),
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    stimulus = []
    for load in [1, *(random.random(200) < 0.3)]:
        given, other, known = (int(bits) for bits in random.integers(1 << 12, size=3))
        now = live if random.random() < 0.5 else other
        stimulus.append({"load": int(load), "given": given, "live": now, "known": known & ~now})
    kept = None
    for inputs, output in zip(stimulus, leaf.run_both(stimulus, settled=1), strict=True):
        if kept is not None:
            assert output["word"] == kept & inputs["live"] | inputs["known"], repeat()
        if inputs["load"]:
            kept = inputs["given"]


@by_screen
def test_rect_walker(config, tmp_path):
    """Whole rows, and many beginnings of rows, in which the ways and the bounds advance at different times."""
    leaf = Leaf(
        rect_walker,
        lambda: {
            "clk": bit(),
            "load": bit(),
            "step_way": bit(),
            "step_bounds": bit(),
            "start": Walk(walk_bits(config)),
            "growth": Walk(DISTANCE_BITS),
            "walk": Walk(walk_bits(config)),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes = primary_slopes(config.screen_geometry)
    width, columns = walk_bits(config), slopes.shape[1]
    stimulus, expected = [], {}
    for number in range(300):
        row = (0, len(slopes) - 1, int(random.integers(len(slopes))))[number % 3]
        first, steps = (0, columns) if number < 3 else (int(random.integers(columns - 8)), 8)
        table = flat_tables(random, 1)
        camera = np.array([any_place(random) for _ in AXES])
        now, then = (products(table, 0, camera, slope) for slope in slopes[row, first : first + 2])
        inputs = {f"start_{name}": word(now[name], width) for name in WALK}
        inputs |= {f"growth_{name}": word(then[name] - now[name], DISTANCE_BITS) for name in WALK}
        stimulus.append({**inputs, "load": 1})
        way = bounds = 0
        # One step more than there are columns: the last one's end.
        while min(way, bounds) < steps:
            slope = slopes[row, first] + np.array([0, 1, 0]) * [[way], [bounds]]
            seen = products(table, 0, camera, slope[0]), products(table, 0, camera, slope[1])
            expected[len(stimulus)] = [word(seen[name != "way_p"][name], width) for name in WALK]
            step_way, step_bounds = (int(done < steps and random.random() < 0.9) for done in (way, bounds))
            stimulus.append({"load": 0, "step_way": step_way, "step_bounds": step_bounds})
            way, bounds = way + step_way, bounds + step_bounds
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, values in expected.items():
        assert [outputs[cycle][f"walk_{name}"] for name in WALK] == values, (cycle, repeat())


@by_screen
def test_slope_walker(config, tmp_path):
    slope_bits = exact_slope_bits(config) + 1
    leaf = Leaf(
        slope_walker,
        lambda: {
            "clk": bit(),
            "start_line": bit(),
            "step": bit(),
            "column_slope": signed(slope_bits),
            "config": config,
        },
        tmp_path,
    )
    columns = config.screen_geometry.columns
    stimulus = [{"start_line": 1, "step": 1}, *({"start_line": 0, "step": step % 3 != 2} for step in range(columns))]
    stimulus.append({"start_line": 1})
    outputs = leaf.run_both(
        [*({name: int(value) for name, value in cycle.items()} for cycle in stimulus), {}], settled=1
    )
    column = 0
    for inputs, output in zip(stimulus[1:], outputs[1:], strict=False):
        assert number(output["column_slope"], slope_bits) == column - columns // 2
        column += inputs.get("step", 0)
    assert number(outputs[-1]["column_slope"], slope_bits) == -columns // 2


# ray_fold and fold_tester ---------------------------------------------------------------------------------------------


def beam_rays(random: np.random.Generator, config: Configuration, count: int):
    """Tables, rectangles of them to look at, cameras, slopes and mirrors (axis and plane, as the ray meets them).

    As the engine meets them, and as extreme as its widths allow.
    """
    steepest, view = steepest_slope(config), config.screen_geometry.view_distance
    powers = 1 << np.arange(steepest.bit_length())
    for _ in range(count):
        table = random_rectangles(random, count=8, closed=True)
        camera = random_camera(random, table).astype(np.int64)
        # Of a power of two its one bit counts, and of ways that a small one divides the lowest bits.
        extremes = [0, view, steepest, random.choice(powers), *random.integers([4, 16, 16, steepest])]
        sides = random.choice(extremes, 2) * random.choice([-1, 1], 2)
        slope = np.array([view, *sides])
        wanted = int(random.integers(config.reflections + 1))
        mirrors: list[tuple[int, int]] = []
        met = Fraction(0)
        for _ in range(20):
            if len(mirrors) == wanted:
                break
            axis, plane = int(random.integers(3)), any_place(random)
            eye, turned = seen_from(camera, slope, mirrors)
            if mirrors and random.random() < 0.3:
                # From corner to corner the image runs as far away as it can.
                axis, plane = mirrors[-1][0], LAST - mirrors[-1][1]
            elif turned[axis] and random.random() < 0.6:
                plane = coordinate(eye, turned, time_ahead(random, eye, turned, met, axis), axis)
            if turned[axis] and Fraction(int(plane - eye[axis]), int(turned[axis])) > met:
                met = Fraction(int(plane - eye[axis]), int(turned[axis]))
                mirrors.append((axis, plane))
        eye, turned = seen_from(camera, slope, mirrors)
        chosen = random.choice(np.flatnonzero(table.visible), 4)
        for index in chosen:
            axis, corners = int(table.axes[index]), table.corners.copy()
            if turned[axis] and random.random() < 0.8:
                corners[index, :, axis] = coordinate(eye, turned, time_ahead(random, eye, turned, met, axis), axis)
                table = Rectangles(corners, table.colours, table.enabled)
            table = sharpened(random, table, int(index), eye, turned, mirrors[-1] if mirrors else None)
        yield table, set(chosen.tolist()), camera, slope, mirrors


def time_ahead(random: np.random.Generator, eye, turned, met: Fraction, axis: int) -> Fraction:
    """When a ray is on its way from a mirror out of the world; often at a whole coordinate of two axes at once."""
    exits = ((LAST * (slope > 0) - place, slope) for place, slope in zip(eye.tolist(), turned.tolist(), strict=True))
    left = min(Fraction(way, slope) for way, slope in exits if slope)
    t = met + max(left - met, 0) * Fraction(int(random.integers(1, 65)), 64)
    if random.random() < 0.6:
        parts = int(np.gcd(turned[axis], turned[random.choice(OTHER_AXES[axis])]))
        t = Fraction(round(t * parts), parts)
    return t


def coordinate(eye, turned, t: Fraction, axis: int) -> int:
    """Where a ray is then; the world's last one where it has left."""
    return int(np.clip(int(eye[axis] + int(turned[axis]) * t), 0, LAST))


def seen_from(camera, slope, mirrors) -> tuple[np.ndarray, np.ndarray]:
    """The camera and the slope, mirrored."""
    eye, turned = np.array(camera), np.array(slope)
    for axis, plane in mirrors:
        eye[axis], turned[axis] = 2 * plane - eye[axis], -turned[axis]
    return eye, turned


def folded(config: Configuration, camera, slope, mirrors) -> dict[str, int]:
    """The fold, by its definition: x - E = +-(X - E) + T, where the room's x is the mirrored camera's."""
    eye, turned = seen_from(camera, slope, mirrors)
    turn = [int(value) for value in eye - camera]
    back = [sum(axis == mirror for mirror, _ in mirrors) % 2 for axis in range(3)]
    fields = {f"back_{name}": back[axis] for axis, name in enumerate(AXES)}
    fields |= {f"turn_{name}": word(turn[axis], TURN_BITS) for axis, name in enumerate(AXES)}
    for letter, others in (("p", P), ("q", Q)):
        for axis, other in enumerate(others):
            flip = back[axis] != back[other]
            sign = -1 if flip else 1
            added = turn[other] * int(slope[axis]) - sign * turn[axis] * int(slope[other]) + flip
            fields[f"{letter}_{AXES[axis]}"] = word(added, fold_bits(config))
    axis, plane = mirrors[-1] if mirrors else (0, int(camera[0]))
    distance = plane - int(camera[axis])
    fields |= {f"border_{name}": word(distance * int(slope[c]), walk_bits(config)) for c, name in enumerate(AXES)}
    fields["mirror_back"] = int(turned[axis] < 0)
    return fields | {"axis": axis, "distance": word(distance, DISTANCE_BITS)}


def slope_ports(config: Configuration, slope) -> dict[str, int]:
    width = exact_slope_bits(config) + 1
    return {"column_slope": word(slope[1], width), "row_slope": word(slope[2], width)}


@by_screen
def test_fold_tester(config, tmp_path):
    """A ray a cycle; its bounds come a cycle later, and its slope's magnitudes two."""
    slope_bits = exact_slope_bits(config)
    leaf = Leaf(
        fold_tester,
        lambda: {
            "clk": bit(),
            "facet": Facet(walk_bits(config)),
            "walk": Walk(walk_bits(config)),
            "column_slope": signed(slope_bits + 1),
            "row_slope": signed(slope_bits + 1),
            "slope": Slope(slope_bits),
            "fold": fold_of(config),
            "index": unsigned(index_bits(config)),
            "hit": candidate_of(config),
            "view_distance": config.screen_geometry.view_distance,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected, seen = [], {}, set()
    for table, chosen, camera, slope, mirrors in beam_rays(random, config, 3000):
        fold = {f"fold_{name}": value for name, value in folded(config, camera, slope, mirrors).items()}
        eye, turned = seen_from(camera, slope, mirrors)
        for index in chosen:
            now = products(table, index, camera, slope)
            bounds = {f"walk_{name}": word(now[name], walk_bits(config)) for name in WALK if name != "way_p"}
            facet = {
                "facet_usable": int(random.random() < 0.9),
                "facet_axis": int(table.axes[index]),
                "facet_distance": word(now["distance"], DISTANCE_BITS),
                "facet_way_q": word(now["way_q"], walk_bits(config)),
            }
            ray = {"walk_way_p": word(now["way_p"], walk_bits(config)), **slope_ports(config, slope)}
            start = len(stimulus)
            stimulus += [
                {**facet, **fold, **ray, "fold_active": int(bool(mirrors))},
                bounds,
                {"index": index} | {f"slope_d{AXES[c]}": abs(int(slope[c])) for c in (1, 2)},
            ]
            hit, n, e = verdict(table, index, eye, turned, mirrors[-1] if mirrors else None)
            seen.add((len(mirrors), hit))
            expected[start + tester.LATENCY] = hit and bool(facet["facet_usable"]), n, e, index, (
                table.corners[index].tolist(), camera, slope, mirrors, repeat()
            )  # fmt: skip
    outputs = leaf.run_both([*stimulus, {}], settled=tester.LATENCY)
    assert len(seen) == 2 * (config.reflections + 1)
    for cycle, (hit, n, e, index, case) in expected.items():
        output = outputs[cycle]
        assert output["hit_valid"] == hit, case
        assert output["hit_index"] == index, case
        assert not hit or (output["hit_numerator"], output["hit_denominator"]) == (n, e), case


@pytest.mark.parametrize(
    "config",
    [beam_config(rows=180), beam_config(reflections=2), beam_config(reflections=2, screen="tiny")],
    ids=config_id,
)
def test_ray_fold(config, tmp_path):
    """A ray a cycle; its slope comes a cycle after its mirrors."""
    slope_bits = exact_slope_bits(config) + 1
    leaf = Leaf(
        ray_fold,
        lambda: {
            "clk": bit(),
            "earlier": Reflector(),
            "last": Reflector(),
            "column_slope": signed(slope_bits),
            "row_slope": signed(slope_bits),
            "fold": fold_of(config),
            "view_distance": config.screen_geometry.view_distance,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    rays = [ray[2:] for ray in beam_rays(random, config, 4000) if ray[-1]]
    stimulus = [{} for _ in range(len(rays) + folder.LATENCY + 1)]
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        met = {"last": mirrors[-1], "earlier": (int(random.integers(3)), any_place(random))}
        if len(mirrors) == 2:
            met["earlier"] = mirrors[0]
        for name, (axis, plane) in met.items():
            distance = word(plane - int(camera[axis]), DISTANCE_BITS)
            stimulus[cycle] |= {f"{name}_axis": axis, f"{name}_distance": distance}
        stimulus[cycle] |= {"earlier_active": int(len(mirrors) == 2), "last_active": 1}
        stimulus[cycle + 1] |= slope_ports(config, slope)
    outputs = leaf.run_both(stimulus, settled=folder.LATENCY)
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        expected = {f"fold_{name}": value for name, value in folded(config, camera, slope, mirrors).items()}
        assert outputs[cycle + folder.LATENCY] == expected | {"fold_active": 1}, (camera, slope, mirrors, repeat())


# The nearest ----------------------------------------------------------------------------------------------------------


def any_candidate(random: np.random.Generator, config: Configuration) -> tuple[int, int, int, int]:
    """valid, numerator, denominator, index; equal fractions in other terms are common."""
    most = [(1 << len(signal)) - 1 for signal in (candidate_of(config).numerator, candidate_of(config).denominator)]
    if random.random() < 0.4:
        n, e, times = int(random.integers(1, 4)), int(random.integers(1, 4)), int(random.integers(1, 60))
        n, e = n * times, e * times
    else:
        n, e = (int(random.choice([1, limit, random.integers(1, limit)])) for limit in most)
    return int(random.random() < 0.8), n, e, int(random.integers(config.rectangles))


def close_candidates(random: np.random.Generator, config: Configuration) -> tuple:
    """Two whose products with the other's denominator are large, and differ by two at most."""
    most, most_below = (
        (1 << len(signal)) - 1 for signal in (candidate_of(config).numerator, candidate_of(config).denominator)
    )
    while True:
        apart, *below = map(int, [random.integers(-2, 3), *random.integers(most_below // 2, most_below, size=2)])
        if gcd(*below) > 1:
            continue
        first = -apart * pow(below[1], -1, below[0]) % below[0]
        first += below[0] * int(random.integers(most // below[0] + 1))
        second = (first * below[1] + apart) // below[0]
        if 0 < first <= most and 0 < second <= most:
            indices = map(int, random.integers(config.rectangles, size=2))
            return tuple((1, *one) for one in zip((first, second), below, indices, strict=True))


def candidate_ports(name: str, candidate) -> dict[str, int]:
    fields = zip(("valid", "numerator", "denominator", "index"), candidate, strict=True)
    return {f"{name}_{field}": value for field, value in fields}


@by_screen
def test_nearest_of_two(config, tmp_path):
    leaf = Leaf(
        nearest_of_two,
        lambda: {"clk": bit(), **{name: candidate_of(config) for name in ("first", "second", "nearest")}},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    pairs = [(any_candidate(random, config), any_candidate(random, config)) for _ in range(3000)]
    pairs += [close_candidates(random, config) for _ in range(1000)]
    stimulus = [candidate_ports("first", first) | candidate_ports("second", second) for first, second in pairs]
    outputs = leaf.run_both([*stimulus, *[{}] * contest.LATENCY], settled=contest.LATENCY)
    ties = 0
    for (first, second), output in zip(pairs, outputs[contest.LATENCY :], strict=True):
        valid = [candidate for candidate in (first, second) if candidate[0]]
        assert output["nearest_valid"] == bool(valid)
        if valid:
            # min takes the first of equals.
            assert output == candidate_ports("nearest", min(valid, key=lambda one: Fraction(one[1], one[2]))), repeat()
            ties += len({Fraction(one[1], one[2]) for one in valid}) < len(valid)
    assert ties > 20


@pytest.mark.parametrize("count", [1, 2, 3, 5, 8, 12])
def test_nearest_of(count, tmp_path):
    """The first of the nearest, whatever the number; a single one takes a round too."""
    config = beam_config(rectangles=count)
    rounds = max(1, (count - 1).bit_length())
    record = candidate_of(config)
    leaf = Leaf(
        nearest_of,
        lambda: {
            "clk": bit(), "candidates": unsigned(count * len(record.word)), "nearest": candidate_of(config),
            "rounds": rounds,
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    names = ("valid", "numerator", "denominator", "index")
    # Often with few that are valid, so that each of them is the nearest often enough.
    fields = []
    for _ in range(1200):
        share = random.choice([0.2, 0.5, 1])
        field = [any_candidate(random, config) for _ in range(count)]
        field = [(int(valid and random.random() < share), *others) for valid, *others in field]
        if count > 1 and random.random() < 0.5:
            place = 2 * int(random.integers(count // 2))
            field[place : place + 2] = close_candidates(random, config)
        fields.append(field)
    stimulus = [
        {"candidates": sum(record.pack(dict(zip(names, one, strict=True))) << i * len(record.word)
                           for i, one in enumerate(field))}
        for field in fields
    ]  # fmt: skip
    latency = rounds * contest.LATENCY
    outputs = leaf.run_both([*stimulus, *[{}] * latency], settled=latency)
    for field, output in zip(fields, outputs[latency:], strict=True):
        valid = [one for one in field if one[0]]
        assert output["nearest_valid"] == bool(valid), repeat()
        if valid:
            assert output == candidate_ports("nearest", min(valid, key=lambda one: Fraction(one[1], one[2]))), repeat()


@pytest.mark.parametrize("cycles", [2, 3, 13])
def test_winner_delay(cycles, tmp_path):
    leaf = Leaf(
        winner_delay,
        lambda: {"clk": bit(), "word": unsigned(5), "late_word": unsigned(5), "cycles": cycles},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [{"word": int(random.integers(32))} for _ in range(100)]
    outputs = leaf.run_both(stimulus, settled=cycles)
    for inputs, output in zip(stimulus, outputs[cycles:], strict=False):
        assert output == {"late_word": inputs["word"]}


# The colour -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("colour_bits", [1, 5, 8])
def test_colour_mean(colour_bits, tmp_path):
    config = beam_config(colour_bits=colour_bits)
    names = ("first", "second", "third")
    leaf = Leaf(
        colour_mean,
        lambda: {
            "clk": bit(),
            **{name: unsigned(8) for name in names},
            "reflections": unsigned(2),
            "mean": unsigned(colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    values = random.choice([0, 1, 254, 255, *random.integers(256, size=4)], (600, 3))
    stimulus = [
        {**dict(zip(names, map(int, seen), strict=True)), "reflections": number % 3}
        for number, seen in enumerate(values)
    ]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, output in zip(stimulus, outputs[1:], strict=True):
        first, second, third = (inputs[name] for name in names)
        mean = (first, (first + second) >> 1, (2 * first + second + third) >> 2)[inputs["reflections"]]
        assert output["mean"] == mean >> (8 - colour_bits), (inputs, repeat())


def test_colour_blend(tmp_path):
    """What comes after a ray that found nothing is background."""
    config = beam_config(colour_bits=6)
    leaf = Leaf(
        colour_blend,
        lambda: {
            "clk": bit(),
            **{f"found_{number}": bit() for number in range(3)},
            **{f"colour_{number}": unsigned(RGB_BITS) for number in range(3)},
            "picture": Picture(),
            "pixel": Pixel(config.colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    background, reflections = 0x123456, 0
    for number in range(1800):
        if number % 100 == 0:
            background, reflections = int(random.integers(1 << RGB_BITS)), number // 100 % 3
        found = (random.random(3) < 0.7).astype(int).tolist()
        colours = [int(random.integers(1 << RGB_BITS)) for _ in found]
        stimulus.append({
            "picture_background": background, "picture_reflections": reflections,
            **{f"found_{i}": one for i, one in enumerate(found)},
            **{f"colour_{i}": one for i, one in enumerate(colours)},
        })  # fmt: skip
        seen = [colour if all(found[: i + 1]) else background for i, colour in enumerate(colours)]
        weights, shift = (((1, 0, 0), 0), ((1, 1, 0), 1), ((2, 1, 1), 2))[reflections]
        channels = [[colour >> low & 255 for colour in seen] for low in (16, 8, 0)]
        expected.append([sum(w * c for w, c in zip(weights, one, strict=True)) >> shift >> 2 for one in channels])
    outputs = leaf.run_both([*stimulus, {}, {}], settled=2)
    for number, (colour, output) in enumerate(zip(expected, outputs[2:], strict=True)):
        if number % 100 != 99:  # whose background has changed on the way
            assert [output[f"pixel_{channel}"] for channel in ("red", "green", "blue")] == colour, (number, repeat())


# The engine -----------------------------------------------------------------------------------------------------------


def opened(random: np.random.Generator, corners: np.ndarray, axis: int, plane: int, eye, turned) -> Fraction:
    """Make a rectangle one that a ray hits near two of its edges, and say when."""
    corners[:, axis] = plane
    t = Fraction(int(plane - eye[axis]), int(turned[axis]))
    for u in OTHER_AXES[axis]:
        point = eye[u] + int(turned[u]) * t
        edge = int(np.clip(int(point) + int(random.choice([-1, 0, 0, 1])), 0, LAST))
        side = LAST if edge < point or (edge == point and random.random() < 0.5) else 0
        corners[:, u] = random.permutation([edge, side if random.random() < 0.7 else (any_place(random) + side) // 2])
    return t


def race(random: np.random.Generator, config: Configuration, slopes) -> tuple[np.ndarray, Rectangles, int]:
    """A camera, a table, and a ray that meets mirrors near their edges, and at its end two rectangles almost at once,
    or one that stands by the last mirror."""
    count, before_centre = config.rectangles, config.screen_geometry.centre_column - 1
    ends = int(random.integers(min(config.reflections + 1, count), size=2).max())
    by_mirror = ends > 0 and random.random() < 0.25
    for _ in range(300):
        camera, table = random.integers(WORLD_SIZE, size=3), flat_tables(random, count)
        corners, order = table.corners.copy(), random.permutation(count)
        # The last column whose rays run down along y is the one that tells its sign from the next one's.
        column = before_centre if random.random() < 0.1 else int(random.integers(len(slopes), size=2).min())
        # After two mirrors the lowest bits count where a small odd slope reaches an edge exactly.
        if ends == 2 and random.random() < 0.5:
            column = before_centre + 1 + int(random.choice([-3, -1, 1, 3]))
        mirrors: list[tuple[int, int]] = []
        times = [Fraction(0)]
        for bounce in range(ends + 1):
            eye, turned = seen_from(camera, slopes[column], mirrors)
            axis = int(random.choice(np.flatnonzero(turned)))
            t = time_ahead(random, eye, turned, times[-1], axis)
            if bounce == 2 and by_mirror:
                t = times[-1]
            elif bounce == 2:
                # It may meet the first one again, which then is the other of the two.
                again, first = mirrors[0]
                t = max(times[-1], Fraction(int(first - eye[again]), int(turned[again])))
            plane = coordinate(eye, turned, t, axis)
            if bounce == 2:
                plane = min(max(plane + int(random.integers(-1, 2)), 0), LAST)
            times.append(opened(random, corners[order[bounce]], axis, plane, eye, turned))
            mirrors.append((axis, plane))
        if ends + 1 < count:
            axis = int(random.choice(np.flatnonzero(turned)))
            plane = coordinate(eye, turned, times[-2 if by_mirror else -1], axis) + int(random.integers(-1, 2))
            opened(random, corners[order[ends + 1]], axis, min(max(plane, 0), LAST), eye, turned)
        table = Rectangles(corners, table.colours, np.ones(count, dtype=bool))
        traced = exact.trace(table, camera, (0, 0, 0), slopes[column : column + 1], ends, keep=True)
        if traced.bounces[-1].hits.sum() >= min(1 if by_mirror else 2, count):
            return camera, table, column
    raise AssertionError(f"no ray has two rectangles, or one by a mirror, after {ends} reflections; {repeat()}")


@pytest.mark.parametrize(
    ("config", "lines"),
    [
        (beam_config(screen="tiny", rectangles=1, reflections=0, colour_bits=4), 24),
        (beam_config(screen="tiny", rectangles=3, reflections=1, scale=1), 24),
        # Small enough for every rectangle to matter in every pass.
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1), 400),
        (beam_config(screen="tiny", rectangles=8, reflections=2), 12),
        (beam_config(rows=180, rectangles=5, reflections=1), 4),
    ],
    ids=config_id,
)
def test_beam_caster(config, lines, tmp_path):
    """Whole rows of scenes in which a ray of the row meets mirrors and edges."""
    leaf = Leaf(
        beam_caster,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "start_line": bit(),
            "next_column": bit(),
            "row_slope": signed(exact_slope_bits(config) + 1),
            "camera": Point(),
            "picture": Picture(),
            "rects": Rects(config),
            "pixel": Pixel(config.colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes = primary_slopes(config.screen_geometry)
    # Until no column is on its way, whatever the registers started from.
    stimulus, expected, fates = [{"reset": 1}] * beam_latency(config), {}, set()
    flat = [config.screen_geometry.horizon_row + slope for slope in (-3, -1, 1, 3)]
    for number in range(lines):
        row = int(random.choice([0, len(slopes) - 1, *flat, *random.integers(len(slopes), size=4)]))
        if number % 8:
            camera, table, column = race(random, config, slopes[row])
            background, reflections = random.integers(256, size=3), config.reflections
            line = slopes[row, : column + 1 + int(random.integers(4))]
        else:
            camera, table, background, reflections, _ = traced_scene(random, config, random.permutation(slopes[row]))
            line = slopes[row]
        traced = exact.trace(table, camera, background, line, reflections)
        fates |= {tuple(int(winner[column] >= 0) for winner in traced.winners) for column in range(len(line))}
        held = {f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)}
        held |= {"reset": 0, "start_line": 0, "next_column": 0, "picture_reflections": reflections}
        held["picture_background"] = int.from_bytes(bytes(background.astype(np.uint8)))
        held["rects_usable"] = sum(1 << int(index) for index in np.flatnonzero(table.visible))
        if number % 16 == 4:
            # Reset ends what a line has begun.
            begun = int(random.integers(config.rectangles + 2))
            stimulus += [{**held, "start_line": 1}, *[held] * begun, {**held, "reset": 1}]
            stimulus += [held] * beam_latency(config)
        stimulus += [{**held, "start_line": 1}, held, held]
        held["row_slope"] = word(slopes[row, 0, 2], exact_slope_bits(config) + 1)
        for index in range(config.rectangles):
            rect = sorted_rect(table, index, "rects_rect") if table.visible[index] else {}
            stimulus.append({**held, **rect})
        stimulus += [held] * (setup.LATENCY - 3 + int(random.integers(4)))
        for colour in traced.colours:
            stimulus += [held] * int(random.random() < 0.5 * (config.scale == 1 and number % 8 == 0))
            expected[len(stimulus) + beam_latency(config)] = (
                pixel_word(config, colour),
                (camera, table.corners, repeat()),
            )
            stimulus.append({**held, "next_column": 1})
        stimulus += [held] * beam_latency(config)
    outputs = leaf.run_both([*stimulus, {}], settled=min(expected))
    assert len(fates) >= config.reflections + 2
    shift = config.colour_bits
    for cycle, (pixel, case) in expected.items():
        output = outputs[cycle]
        assert (output["pixel_red"] << shift | output["pixel_green"]) << shift | output["pixel_blue"] == pixel, (
            cycle,
            case,
        )
