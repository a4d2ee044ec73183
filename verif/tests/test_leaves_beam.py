# SPDX-License-Identifier: MIT
"""The beam engine's blocks: MyHDL's simulator, the converted Verilog and exact arithmetic on one set of vectors."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import gcd
from unittest import mock

import numpy as np
import pytest
from hard_scenes import pixel_word, sharpened, traced_scene, verdict

from raycaster.configuration import (
    CHANNEL_BITS,
    MOST_REFLECTIONS,
    WORLD_SIZE,
    Configuration,
    ConfigurationError,
    configure,
)
from raycaster.engines.beam import (
    AIM_LATENCY,
    CELL_LATENCY,
    CELL_SLOPE_AT,
    FOLD_LATENCY,
    SETUP_LATENCY,
    TESTER_LATENCY,
    beam_latency,
    blanking_left,
    blend_latency,
    contest_latency,
    fold_lead,
    is_staged,
    mixes,
    slope_at,
    start_cycles,
    winner_latency,
)
from raycaster.golden.exact import ExactModel
from raycaster.golden.random_world import EXTREMES, random_basis, random_camera, random_looks, random_rectangles
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.beam.beam_caster import beam_caster
from raycaster.rtl.beam.beam_lane import beam_lane
from raycaster.rtl.beam.beam_pass import beam_pass
from raycaster.rtl.beam.bound_tester import bound_tester
from raycaster.rtl.beam.cell_step import cell_step
from raycaster.rtl.beam.colour_blend import colour_blend
from raycaster.rtl.beam.colour_mean import colour_mean
from raycaster.rtl.beam.colour_mix import colour_mix
from raycaster.rtl.beam.colour_seen import colour_seen
from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.beam.hit_cell import hit_cell
from raycaster.rtl.beam.hit_cells import hit_cells
from raycaster.rtl.beam.lane_start import lane_start
from raycaster.rtl.beam.line_starter import line_starter
from raycaster.rtl.beam.look_up import look_up
from raycaster.rtl.beam.mirror_look_up import mirror_look_up
from raycaster.rtl.beam.nearest_of import nearest_of
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.ray_tester import ray_tester
from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.beam.row_register import row_register
from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.delay_line import delay_line
from raycaster.rtl.common.interfaces import Direction, Picture, Rects, Slope
from raycaster.rtl.common.records import (
    CellDivision,
    Look,
    Pixel,
    Point,
    Reflector,
    Sight,
    Signs,
    camera_of,
    candidate_of,
    facet_of,
    fold_of,
    growth_of,
    seen_of,
    shade_of,
    shown_of,
    stride_of,
    turn_of,
    walk_of,
    winner_of,
)
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import (
    BASIS_BITS,
    DISTANCE_BITS,
    MIRROR_BITS,
    RGB_BITS,
    bit,
    exact_slope_bits,
    eye_bits,
    factor_bits,
    fold_bits,
    index_bits,
    signed,
    steepest_slope,
    turn_bits,
    unsigned,
    walk_bits,
)
from raycaster.rtl.engine.rect_setup import rect_setup
from raycaster.scene import UNTURNED
from raycaster.screens import BEAM_SCREENS
from raycaster.verif.leaf import Leaf, reset_signal, sorted_rect
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
LAST = WORLD_SIZE - 1
P, Q = (1, 0, 1), (2, 2, 0)
"""By the axis of a plane: p is y unless the plane is on y, q is z unless it is on z."""
WALK = ("way_p", "low_p", "high_p", "low_q", "high_q")
CANDIDATE = ("valid", "at_mirror", "numerator", "denominator", "index")


def config_id(value) -> str | None:
    return value.name if isinstance(value, Configuration) else None


def beam_config(*, reflections: int = 1, **options) -> Configuration:
    """A design; for a leaf test also one that has too many reflections to set up a line in its blanking."""
    return replace(configure(engine="beam", reflections=0, **options), reflections=reflections)


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
        beam_config(reflections=1, rows=180, turn=True),
        beam_config(reflections=2, rows=240, turn=True, materials=True, patterns=True),
        beam_config(reflections=2, screen="tiny", turn=True),
        beam_config(reflections=1, rows=180, scale=6, pixels=2),
        beam_config(reflections=1, rows=180, scale=6, pixels=2, turn=True),
        beam_config(reflections=1, screen="tiny", pixels=2, turn=True),
    ],
    ids=config_id,
)


by_depth = pytest.mark.parametrize(
    "config",
    [
        *by_screen.args[1],
        beam_config(reflections=3, screen="tiny"),
        beam_config(reflections=4, rows=180),
        beam_config(reflections=3, rows=240, turn=True, patterns=True),
        beam_config(reflections=4, screen="tiny", turn=True),
    ],
    ids=config_id,
)
"""And with more reflections."""


def any_slope(random: np.random.Generator, config: Configuration) -> np.ndarray:
    """One that a pixel's ray may have; where the camera turns, of any basis that the registers hold."""
    slopes = primary_slopes(config.screen_geometry)
    slope = slopes[int(random.integers(len(slopes))), int(random.integers(slopes.shape[1]))]
    if not config.turn:
        return slope
    return slope @ np.array(random_basis(random), dtype=np.int64)


def direction_ports(name: str, config: Configuration, slope) -> dict[str, int]:
    width = exact_slope_bits(config) + 1
    return {f"{name}_{axis}": word(value, width) for axis, value in zip(AXES, slope, strict=True)}


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
        ({"screen": "play"}, (320, 240, 1, 1, 6_120_000)),
        ({"rows": 180, "scale": 3}, (960, 540, 3, 2, 74_250_000)),
        ({"rows": 180, "scale": 6}, (1920, 1080, 6, 1, 74_250_000)),
        ({"rows": 180, "scale": 6, "pixels": 2}, (1920, 1080, 6, 1, 74_250_000)),
        ({"rows": 180, "pixels": 2}, (1280, 720, 4, 1, 37_125_000)),
        ({"pixels": 2}, (640, 480, 2, 1, 12_500_000)),
    ],
)
def test_a_beam_is_as_fine_as_its_monitor(options, shown):
    config = beam_config(**options)
    screen = config.screen_geometry
    assert (screen.columns, screen.rows, screen.scale, screen.doubling, screen.clock_hz) == shown
    assert (config.scale, config.units, config.group_cycles) == (screen.scale, options.get("pixels", 1), 1)


@pytest.mark.parametrize(("pixels", "rate"), [(1, 30), (2, 60)])
def test_full_hd_at_a_clock_that_chips_reach(pixels, rate):
    """As CEA-861 has it: 2200 x 1125, both syncs high; two pixels a clock are as many clocks, and twice the frames."""
    screen = beam_config(rows=180, scale=6, pixels=pixels).screen_geometry
    horizontal, vertical = screen.horizontal, screen.vertical
    assert (horizontal.visible, horizontal.front, horizontal.sync, horizontal.back) == (1920, 88, 44, 148)
    assert (vertical.visible, vertical.front, vertical.sync, vertical.back) == (1080, 4, 5, 36)
    assert horizontal.active_high and vertical.active_high
    assert screen.clock_hz == 74_250_000
    assert screen.clock_hz / screen.frame_cycles == rate
    assert screen.frame_cycles == 2200 * 1125 // pixels


@pytest.mark.parametrize(
    "options", [{"rows": 240}, {"rows": 200}, {"rows": 180}, {"rows": 180, "scale": 6}, {"screen": "tiny"}]
)
def test_a_finer_view_is_the_same_view(options):
    """The pixel (s row, s column) at scale s is the pixel (row, column) at scale 1."""
    fine = beam_config(**options)
    scale = fine.scale
    coarse = primary_slopes(beam_config(**options | {"scale": 1}).screen_geometry)
    assert np.array_equal(primary_slopes(fine.screen_geometry)[::scale, ::scale], scale * coarse)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"units": 4}, "^units: the beam engine has one for each of PIXELS=1 a clock, not 4$"),
        ({"scale": 3}, "^scale: the beam engine shows 240 rows at 1 or 2, not 3$"),
        ({"rows": 180, "scale": 8}, "^scale: the beam engine shows 180 rows at 1 or 2 or 3 or 4 or 6, not 8$"),
        ({"fraction_bits": 1}, "^fraction_bits: the beam engine has none, not 1$"),
        ({"engine": "seed", "scale": 2}, "^scale: the seed engine shows 240 rows at 1, not 2; scales need the beam"),
        ({"engine": "exact", "screen": "play"}, "^screen: play needs the beam engine, ENGINE=beam, not exact$"),
        ({"engine": "exact", "rows": 180}, "180 rows need the beam engine, ENGINE=beam$"),
        ({"pixels": 3}, "^pixels: expected 2 or less, got 3$"),
        ({"pixels": 2, "units": 1}, "^units: the beam engine has one for each of PIXELS=2 a clock, not 1$"),
        ({"engine": "seed", "pixels": 2}, "^pixels: 2 a clock need the beam engine, ENGINE=beam, not seed$"),
        (
            {"pixels": 2, "scale": 1},
            "^pixels: 2 a clock need a column for each of the monitor's pixels, SCALE=2, not 1$",
        ),
        (
            {"pixels": 2, "rows": 180, "scale": 3},
            "^pixels: 2 a clock need a column for each of the monitor's pixels, SCALE=6, not 3$",
        ),
    ],
)
def test_what_the_beam_engine_has_not(options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        configure(**{"engine": "beam"} | options)


@pytest.mark.parametrize("part", ["visible", "front", "sync", "back"])
def test_two_pixels_a_clock_take_an_even_line(part):
    screen = BEAM_SCREENS["play", 240]
    line = replace(screen.horizontal, **{part: getattr(screen.horizontal, part) + 1})
    with (
        mock.patch.dict(BEAM_SCREENS, {("play", 240): replace(screen, horizontal=line)}),
        pytest.raises(
            ConfigurationError, match=r"^pixels: 2 a clock need an even width and blanking, and the play screen"
        ),
    ):
        configure(engine="beam", screen="play", pixels=2)


@pytest.mark.parametrize("place", BEAM_SCREENS, ids=str)
@pytest.mark.parametrize("rectangles", [1, 2, 12, 32])
@pytest.mark.parametrize("reflections", range(MOST_REFLECTIONS + 1))
def test_every_row_is_set_up_in_its_blanking(place, rectangles, reflections):
    """The latest column has left, and all rectangles are loaded, before the first column's turn."""
    screen, rows = place
    size = {"screen": screen, "rows": rows, "rectangles": rectangles, "reflections": reflections}
    if screen == "vga" or rectangles < 32 or reflections < 3:
        assert blanking_left(configure(engine="beam", **size)) >= 0
        return
    with pytest.raises(ConfigurationError, match=r"^rectangles: with 32 of them, [34] reflections, .*either$"):
        configure(engine="beam", **size)


@pytest.mark.parametrize(
    ("screen", "rows", "most"), [("vga", 240, 4), ("vga", 180, 4), ("tiny", 48, 2), ("play", 240, 1)]
)
def test_every_row_of_a_turned_camera_is_set_up_in_its_blanking(screen, rows, most):
    """That of a dozen rectangles, with all there is; on small screens with so many reflections at most."""
    config = beam_config(screen=screen, rows=rows, reflections=most, turn=True, materials=True, patterns=True)
    assert blanking_left(config) >= 0
    with pytest.raises(
        ConfigurationError, match=r"^rectangles: with 32 of them, 2 reflections .* is 31 cycles short of a line's"
    ):
        configure(engine="beam", screen="play", rectangles=32, reflections=2, turn=True)


@pytest.mark.parametrize(
    ("options", "fits"),
    [
        ({"rows": 180, "scale": 6, "reflections": 1}, True),
        ({"rows": 180, "scale": 6, "reflections": 2, "turn": True}, False),
        ({"rows": 180, "scale": 6, "reflections": 1, "turn": True}, True),
        ({"screen": "tiny", "reflections": 2, "turn": True, "rectangles": 8}, True),
        ({"screen": "play", "reflections": 1}, True),
        ({"screen": "play", "reflections": 2}, False),
    ],
)
def test_two_pixels_a_clock_halve_the_blanking(options, fits):
    """There is one set-up for both lanes, which the shorter blanking must be long enough for."""
    if fits:
        assert blanking_left(configure(engine="beam", pixels=2, **options)) >= 0
        return
    with pytest.raises(ConfigurationError, match=r"^rectangles: .* at two pixels a clock, the .*PIXELS=1$"):
        configure(engine="beam", pixels=2, **options)


def pixels_of(config: Configuration, channels: list[int]) -> list[int]:
    """The pixels of a clock, the left one first, as words of what their red, green and blue ports have."""
    bits = config.colour_bits
    lanes = [[channel >> bits * lane & (1 << bits) - 1 for channel in channels] for lane in range(config.pixels)]
    return [(red << bits | green) << bits | blue for red, green, blue in lanes]


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
def test_rect_setup(config, tmp_path, in_adders=False):
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
            "slope": Direction(exact_slope_bits(config) + 1),
            "load": unsigned(count),
            "facet": facet_of(config),
            "growth": growth_of(config),
            "start": walk_of(config),
            "config": config,
            "in_adders": in_adders,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [{"reset": 1}] * 2
    loads = {}
    for _ in range(12):
        table = random_looks(random, flat_tables(random, count))
        camera = np.array([any_place(random) for _ in AXES])
        held = {f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)}
        held |= {"reset": 0, "start_line": 0, "rects_usable": sum(int(one) << i for i, one in enumerate(table.enabled))}
        start = len(stimulus)
        stimulus += [{**held, "start_line": 1}, held, held]
        slope = any_slope(random, config)
        held |= direction_ports("slope", config, slope)
        for index in range(count):
            # Two cycles after it was asked for.
            stimulus.append({**held, **sorted_rect(table, index, "rects_rect", config)})
            loads[start + SETUP_LATENCY + index] = table, index, camera, slope
        stimulus += [held] * (SETUP_LATENCY + int(random.integers(5)))
    # Every stage of the last line has something at hand.
    end = start + SETUP_LATENCY + min(1, count - 1)
    stimulus[end] = stimulus[end] | {"reset": 1}
    stimulus[end + 1] = stimulus[end + 1] | {"reset": 0}
    loads = {cycle: load for cycle, load in loads.items() if cycle <= end}
    outputs = leaf.run_both(stimulus, settled=2 + SETUP_LATENCY)
    width = walk_bits(config)
    for cycle, output in enumerate(outputs[2:], 2):
        assert output["load"] == (1 << loads[cycle][1] if cycle in loads else 0), (cycle, repeat())
    for cycle, (table, index, camera, slope) in loads.items():
        output = outputs[cycle]
        now, then = (products(table, index, camera, column) for column in (slope, slope + np.array([0, 1, 0])))
        case = cycle, index, camera, table.corners[index].tolist(), slope, repeat()
        assert output["facet_usable"] == table.enabled[index], case
        assert output["facet_axis"] == table.axes[index], case
        assert number(output["facet_distance"], DISTANCE_BITS) == now["distance"], case
        looks = sorted_rect(table, index, "facet", config)
        assert all(
            output[f"facet_{name}"] == looks[f"facet_{name}"] for name in Look(config.materials, config.patterns).layout
        )
        way_q = output["start_way_q" if config.turn else "facet_way_q"]
        assert number(way_q, width) == now["way_q"], case
        for name in WALK:
            assert number(output[f"start_{name}"], width) == now[name], (name, case)
            if not config.turn:
                assert number(output[f"growth_{name}"], DISTANCE_BITS) == then[name] - now[name], (name, case)


@pytest.mark.parametrize("turn", [False, True])
def test_rect_setup_in_adders(turn, tmp_path):
    test_rect_setup(beam_config(screen="tiny", turn=turn), tmp_path, in_adders=True)


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


@pytest.mark.slow_sets("beam-vga")
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
            "start": walk_of(config),
            "growth": stride_of(config),
            "walk": walk_of(config),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    width, names = walk_bits(config), list(walk_of(config).layout)
    columns = config.screen_geometry.columns // config.pixels
    growth_width = int(stride_of(config).layout["way_p"])
    stimulus, expected = [], {}
    for line in range(300):
        steps = columns if line < 3 else 8
        table = flat_tables(random, 1)
        camera = np.array([any_place(random) for _ in AXES])
        first, more = row_slopes(random, config, steps)
        now, then = (products(table, 0, camera, slope) for slope in (first, first + more))
        inputs = {f"start_{name}": word(now[name], width) for name in names}
        inputs |= {f"growth_{name}": word(then[name] - now[name], growth_width) for name in names}
        stimulus.append({**inputs, "load": 1})
        way = bounds = 0
        # One step more than there are columns: the last one's end.
        while min(way, bounds) < steps:
            ways, walls = (products(table, 0, camera, first + more * done) for done in (way, bounds))
            seen = [word((ways if name.startswith("way") else walls)[name], width) for name in names]
            expected[len(stimulus)] = seen
            step_way, step_bounds = (int(done < steps and random.random() < 0.9) for done in (way, bounds))
            stimulus.append({"load": 0, "step_way": step_way, "step_bounds": step_bounds})
            way, bounds = way + step_way, bounds + step_bounds
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, values in expected.items():
        assert [outputs[cycle][f"walk_{name}"] for name in names] == values, (cycle, repeat())


@pytest.mark.parametrize("config", [beam_config(screen="tiny", pixels=2), beam_config(rows=180, scale=6, pixels=2)])
def test_lane_start(config, tmp_path):
    """A rectangle's products of a row's first two columns, of those of the first and what a column adds."""
    leaf = Leaf(
        lane_start,
        lambda: {
            "clk": bit(),
            "load": unsigned(config.rectangles),
            "start": walk_of(config),
            "growth": growth_of(config),
            "late_load": unsigned(config.rectangles),
            "first_start": walk_of(config),
            "second_start": walk_of(config),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes, width = primary_slopes(config.screen_geometry), walk_bits(config)
    stimulus, expected = [], []
    for _ in range(300):
        row, table = int(random.integers(len(slopes))), flat_tables(random, 1)
        camera = np.array([any_place(random) for _ in AXES])
        now, then = (products(table, 0, camera, slope) for slope in slopes[row, :2])
        load = int(random.integers(1 << config.rectangles))
        inputs = {f"start_{name}": word(now[name], width) for name in WALK}
        inputs |= {f"growth_{name}": word(then[name] - now[name], DISTANCE_BITS) for name in WALK}
        stimulus.append({**inputs, "load": load})
        starts = {"first_start": now, "second_start": then}
        wanted = {f"{lane}_{name}": word(ways[name], width) for lane, ways in starts.items() for name in WALK}
        expected.append({**wanted, "late_load": load})
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for output, wanted in zip(outputs[1:], expected, strict=True):
        assert {name: output[name] for name in wanted} == wanted, repeat()


def test_word_of(tmp_path):
    config = beam_config(screen="tiny")
    bits = len(facet_of(config).word)
    leaf = Leaf(word_of, lambda: {"record": facet_of(config), "word": unsigned(bits)}, tmp_path)
    random = np.random.default_rng(seed())
    words = [int.from_bytes(random.bytes(8)) % (1 << bits) for _ in range(50)]
    layout = facet_of(config)
    stimulus = [
        {f"record_{name}": w >> layout.slice(name)[1] & (1 << int(b)) - 1 for name, b in layout.layout.items()}
        for w in words
    ]
    assert [output["word"] for output in leaf.run_both(stimulus)] == words, repeat()


def row_slopes(random: np.random.Generator, config: Configuration, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """The slope of a column that a lane takes so many steps from, and what a step adds."""
    screen = config.screen_geometry
    row, column = int(random.integers(screen.rows)), int(random.integers(screen.columns - columns * config.pixels + 1))
    basis = np.array(random_basis(random) if config.turn else np.eye(3), dtype=np.int64)
    factors = [screen.view_distance, column - screen.centre_column, screen.horizon_row - row]
    return factors @ basis, config.pixels * basis[1]


@by_screen
def test_slope_walker(config, tmp_path):
    slope_bits = exact_slope_bits(config) + 1
    leaf = Leaf(
        slope_walker,
        lambda: {
            "clk": bit(),
            "start_line": bit(),
            "step": bit(),
            "aim": Direction(slope_bits),
            "slope": Direction(slope_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    lane, walked = config.screen_geometry.columns // config.pixels, AXES if config.turn else "y"
    stimulus, expected = [], []
    for line in range(100):
        # Few steps tell of many aims.
        columns = lane if line < 3 else 8
        first, more = row_slopes(random, config, columns)
        aim = direction_ports("aim", config, more if config.turn else first)
        aim = {name: value for name, value in aim.items() if name[-1] in walked}
        steps = [int(step % 3 != 2) for step in range(columns)]
        stimulus += [{"start_line": 1, "step": 1, **aim}, *({"start_line": 0, "step": step} for step in steps)]
        # A turned camera's first step is from 0 to the row's start, which is another test's.
        base = 0 * first if config.turn else first
        expected += [base + more * sum(steps[:column]) for column in range(columns + 1)]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for slope, output in zip(expected, outputs[1:], strict=True):
        given = direction_ports("slope", config, slope)
        assert output == {name: given[name] for name in output} and len(output) == len(walked), repeat()


@pytest.mark.parametrize(
    "config",
    [
        beam_config(screen="tiny", turn=True, rectangles=3),
        beam_config(rows=180, turn=True, rectangles=1),
        beam_config(screen="tiny", turn=True, rectangles=3, pixels=2),
        beam_config(rows=180, scale=6, turn=True, rectangles=1, pixels=2),
    ],
    ids=config_id,
)
def test_line_starter(config, tmp_path):
    """The first rays' slopes from their latency on, each until its sweep's end; the last sweep's ends nothing."""
    slope_bits, screen, basis_names = (
        exact_slope_bits(config) + 1,
        config.screen_geometry,
        list(camera_of(config).layout)[3:],
    )
    leaf = Leaf(
        line_starter,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "start_line": bit(),
            "camera": camera_of(config),
            "row_slope": signed(factor_bits(config)),
            "loaded": bit(),
            "aim": Direction(slope_bits),
            "start_sweep": bit(),
            "enter": unsigned(config.pixels),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [{"reset": 1}] * 6, {}
    for _ in range(60):
        basis = np.array(random_basis(random), dtype=np.int64)
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        held = {
            f"camera_{name}": word(value, BASIS_BITS) for name, value in zip(basis_names, basis.flatten(), strict=True)
        }
        held |= {"reset": 0, "start_line": 0, "loaded": 0}
        start, ended = len(stimulus), random.random() < 0.2
        sweep = SETUP_LATENCY + config.rectangles - 1
        first_end = AIM_LATENCY - 3 + sweep
        ends = [first_end + sweep * lane for lane in range(config.pixels)]
        stimulus += [
            {**held, "start_line": 1},
            {**held, "reset": int(ended)},
            {**held, "row_slope": word(screen.horizon_row - row, factor_bits(config))},
        ]
        stimulus += [held] * (first_end - 3)
        stimulus += [{**held, "loaded": 1}, *[held] * (sweep - 1)] * config.pixels
        stimulus += [{**held, "loaded": 1}, *[held] * int(random.integers(1, 4))]
        first = [screen.view_distance, -screen.centre_column, screen.horizon_row - row] @ basis
        aims = [first + lane * basis[1] for lane in range(config.pixels)] + [config.pixels * basis[1]]
        for cycle in range(start, len(stimulus)):
            age = cycle - start
            sweeps = age in (AIM_LATENCY - 3, *ends) and not ended
            entering = sum(1 << lane for lane, end in enumerate(ends) if age == end and not ended)
            aim = direction_ports("aim", config, aims[sum(age >= end + 2 for end in ends)])
            expected[cycle] = {"start_sweep": int(sweeps), "enter": entering}
            expected[cycle] |= {} if age < AIM_LATENCY or ended else aim
    outputs = leaf.run_both([*stimulus, {}], settled=6 + AIM_LATENCY)
    for cycle, fields in expected.items():
        assert {name: outputs[cycle][name] for name in fields} == fields, (cycle, repeat())


# ray_fold and the testers ---------------------------------------------------------------------------------------------


def beam_rays(random: np.random.Generator, config: Configuration, count: int, most: int | None = None):
    """Tables, rectangles of them to look at, cameras, slopes and mirrors (axis and plane, as the ray meets them).

    As the engine meets them, and as extreme as its widths allow. most: mirrors, if not as many as there can be.
    """
    most = config.reflections if most is None else most
    steepest, view = steepest_slope(config), config.screen_geometry.view_distance
    powers = 1 << np.arange(steepest.bit_length())
    for _ in range(count):
        table = random_rectangles(random, count=8, closed=True)
        camera = random_camera(random, table).astype(np.int64)
        # Of a power of two its one bit counts, and of ways that a small one divides the lowest bits.
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
                # From corner to corner the image runs as far away as it can.
                axis, plane = mirrors[-1][0], LAST - mirrors[-1][1]
            elif mirrors and random.random() < 0.6:
                # Where the last one was met, if that is on a whole coordinate of this axis too.
                plane = coordinate(eye, turned, met, axis)
            elif turned[axis] and random.random() < 0.6:
                plane = coordinate(eye, turned, time_ahead(random, eye, turned, met, axis), axis)
            if not turned[axis]:
                continue
            t = Fraction(int(plane - eye[axis]), int(turned[axis]))
            # A corner has a mirror on each of its axes.
            if t > met or (t == met and mirrors and axis not in met_last(camera, slope, mirrors)):
                met = t
                mirrors.append((axis, plane))
        eye, turned = seen_from(camera, slope, mirrors)
        chosen = random.choice(np.flatnonzero(table.visible), 4)
        for index in chosen:
            axis, corners = int(table.axes[index]), table.corners.copy()
            if turned[axis] and random.random() < 0.8:
                # A third plane may be in the mirrors' corner.
                t = met if random.random() < 0.4 else time_ahead(random, eye, turned, met, axis)
                corners[index, :, axis] = coordinate(eye, turned, t, axis)
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


def met_last(camera, slope, mirrors) -> list[int]:
    """The axes of the mirrors that a ray met in the point that it left last."""
    times = []
    for number, (axis, plane) in enumerate(mirrors):
        eye, turned = seen_from(camera, slope, mirrors[:number])
        times.append(Fraction(int(plane - eye[axis]), int(turned[axis])))
    return [axis for t, (axis, _) in zip(times, mirrors, strict=True) if t == times[-1]]


def image_of(config: Configuration, camera, slope, mirrors) -> dict[str, int]:
    """The image of the room, by its definition: x - E = +-(X - E) + T, where the room's x is the mirrored camera's."""
    eye, _ = seen_from(camera, slope, mirrors)
    met = met_last(camera, slope, mirrors)
    fields = {f"met_{name}": int(axis in met) for axis, name in enumerate(AXES)}
    fields |= {f"back_{name}": sum(axis == mirror for mirror, _ in mirrors) % 2 for axis, name in enumerate(AXES)}
    moved = zip(AXES, eye, camera, strict=True)
    return fields | {f"turn_{name}": word(int(there) - int(here), turn_bits(config)) for name, there, here in moved}


def folded(config: Configuration, camera, slope, mirrors) -> dict[str, int]:
    """The fold of a ray in that image."""
    eye, turned = seen_from(camera, slope, mirrors)
    turn = [int(value) for value in eye - camera]
    fields = image_of(config, camera, slope, mirrors)
    back = [fields[f"back_{name}"] for name in AXES]
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


@pytest.mark.slow_sets(
    quick=[
        "beam-tiny48-s2-u1-r12-m2-c8-turn",
        "beam-vga180-s6-u2-r12-m1-c8",
        "beam-vga240-s2-u1-r12-m2-c8-turn-materials-patterns",
    ]
)
@by_screen
def test_ray_tester(config, tmp_path):
    """A ray now and then; what walks comes a cycle later, and its slope's magnitudes then, or a cycle after that."""
    check_tester(ray_tester, {}, config, tmp_path)


@pytest.mark.slow_sets(quick=["beam-tiny48-s2-u1-r12-m2-c8-turn"])
@by_depth
def test_fold_tester(config, tmp_path):
    """A ray now and then; its bounds come a cycle later, and its slope's magnitudes then, or two cycles later."""
    if config.reflections:
        check_tester(fold_tester, {"fold": fold_of(config)}, config, tmp_path)


def check_tester(block, ports, config: Configuration, tmp_path) -> None:
    """Rays with mirrors where there is a port for their fold, and otherwise rays from the camera."""
    slope_bits, lead = exact_slope_bits(config), fold_lead(config) if ports else 0
    strobes = ("step_way", "step_bounds", "step_slope")
    leaf = Leaf(
        block,
        lambda: {
            "clk": bit(),
            **{strobe: bit() for strobe in strobes},
            "facet": facet_of(config),
            "walk": walk_of(config),
            "signs": Signs(),
            "slope": Slope(slope_bits),
            **{name: port.twin() for name, port in ports.items()},
            "index": unsigned(index_bits(config)),
            "hit": candidate_of(config),
            "staged": is_staged(config),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected, seen = [], {}, set()
    # Of more mirrors fewer are in one point.
    count, most = (3600 * max(1, config.reflections - 1), None) if ports else (1500, 0)
    for table, chosen, camera, slope, mirrors in beam_rays(random, config, count, most):
        if bool(mirrors) != bool(ports):
            continue
        fold = {f"fold_{name}": value for name, value in folded(config, camera, slope, mirrors).items()}
        eye, turned = seen_from(camera, slope, mirrors)
        for index in chosen:
            now = products(table, index, camera, slope)
            bounds = {f"walk_{name}": word(now[name], walk_bits(config)) for name in WALK if name != "way_p"}
            way_q = {"walk_way_q" if config.turn else "facet_way_q": word(now["way_q"], walk_bits(config))}
            facet = {
                "facet_usable": int(random.random() < 0.9),
                "facet_axis": int(table.axes[index]),
                "facet_distance": word(now["distance"], DISTANCE_BITS),
            }
            if config.patterns:
                facet["facet_cell"] = int(random.integers(8))
            ways = {"walk_way_p": word(now["way_p"], walk_bits(config)), **way_q}
            # Between its strobes a stage keeps what it has.
            case_stimulus: list[dict[str, int]] = [dict.fromkeys(strobes, 0) for _ in range(lead + 3)]
            case_stimulus[0] |= facet | (fold if ports else {})
            case_stimulus[lead] |= {f"signs_d{axis}": int(part < 0) for axis, part in zip(AXES, slope, strict=True)}
            case_stimulus[lead if ports else 1] |= ways
            case_stimulus[lead + 1] |= bounds
            case_stimulus[lead + slope_at(config)] |= {f"slope_d{AXES[c]}": abs(int(slope[c])) for c in range(3)}
            # Any of the design's rectangles, of which the table has fewer.
            number = int(random.integers(config.rectangles))
            case_stimulus[lead + 2] |= {"index": number}
            # What comes without its strobe is another ray's.
            case_stimulus[lead + 1] |= {f"signs_d{axis}": int(random.integers(2)) for axis in AXES}
            case_stimulus[lead + 2] |= {name: int(random.integers(1 << walk_bits(config))) for name in bounds}
            for cycle, strobe in enumerate(strobes, lead):
                case_stimulus[cycle] |= {strobe: 1}
            start = len(stimulus) + lead
            stimulus += case_stimulus
            mirror, met = mirrors[-1] if mirrors else None, met_last(camera, slope, mirrors)
            hit, n, e = verdict(table, index, eye, turned, mirror, met)
            at_mirror = hit and not verdict(table, index, eye, turned, mirror)[0]
            seen.add((len(met), hit, at_mirror))
            case = table.corners[index].tolist(), camera, slope, mirrors, repeat()
            expected[start + TESTER_LATENCY] = facet, hit and bool(facet["facet_usable"]), at_mirror, n, e, number, case
    outputs = leaf.run_both([*stimulus, dict.fromkeys(strobes, 0)], settled=lead + TESTER_LATENCY)
    # With no mirror; with one, and two in one point, where a third plane may be too. Three in one point hide the rest.
    assert len([case for case in seen if case[0] < 3]) == (3 * min(config.reflections, 2) if ports else 2)
    assert ((3, False, False) in seen) == (config.reflections > 2 and bool(ports))
    for cycle, (facet, hit, at_mirror, n, e, number, case) in expected.items():
        output = outputs[cycle]
        assert output["hit_valid"] == hit, case
        assert output["hit_index"] == number, case
        if config.patterns:
            assert (output["hit_axis"], output["hit_cell"]) == (facet["facet_axis"], facet["facet_cell"]), case
        if hit:
            fields = [output[f"hit_{name}"] for name in ("at_mirror", "numerator", "denominator")]
            assert fields == [at_mirror, n, e], case


@pytest.mark.slow_sets(
    quick=["beam-vga180-s4-u1-r12-m1-c8-turn", "beam-vga240-s2-u1-r12-m2-c8-turn", "beam-vga240-s2-u1-r12-m4-c8-turn"]
)
@pytest.mark.parametrize(
    "config",
    [
        beam_config(rows=180),
        beam_config(reflections=2),
        beam_config(reflections=2, screen="tiny"),
        beam_config(rows=180, turn=True),
        beam_config(reflections=2, turn=True),
        beam_config(reflections=3, screen="tiny"),
        beam_config(reflections=4, turn=True),
    ],
    ids=config_id,
)
def test_ray_fold(config, tmp_path):
    """A ray a cycle, at the last of its mirrors; its slope comes a cycle later."""
    slope_bits = exact_slope_bits(config) + 1
    leaf = Leaf(
        ray_fold,
        lambda: {
            "clk": bit(),
            "before": turn_of(config),
            "last": Reflector(),
            "slope": Direction(slope_bits),
            "fold": fold_of(config),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    rays = [ray[2:] for ray in beam_rays(random, config, 4000) if ray[-1]]
    stimulus = [{} for _ in range(len(rays) + FOLD_LATENCY + 1)]
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        before = image_of(config, camera, slope, mirrors[:-1])
        stimulus[cycle] |= {f"before_{name}": value for name, value in before.items()}
        axis, plane = mirrors[-1]
        distance, at_mirror = word(plane - int(camera[axis]), DISTANCE_BITS), len(met_last(camera, slope, mirrors)) > 1
        stimulus[cycle] |= {"last_axis": axis, "last_distance": distance, "last_at_mirror": int(at_mirror)}
        stimulus[cycle + 1] |= direction_ports("slope", config, slope)
    outputs = leaf.run_both(stimulus, settled=FOLD_LATENCY)
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        expected = {f"fold_{name}": value for name, value in folded(config, camera, slope, mirrors).items()}
        assert outputs[cycle + FOLD_LATENCY] == expected, (camera, slope, mirrors, repeat())


# The nearest ----------------------------------------------------------------------------------------------------------


@cache
def candidate_limits(config: Configuration) -> tuple[int, int]:
    """The greatest numerator and denominator."""
    candidate = candidate_of(config)
    return tuple((1 << len(signal)) - 1 for signal in (candidate.numerator, candidate.denominator))


def any_candidate(random: np.random.Generator, config: Configuration) -> tuple[int, int, int, int, int]:
    """valid, at_mirror, numerator, denominator, index; equal fractions in other terms are common."""
    most = candidate_limits(config)
    if random.random() < 0.4:
        n, e, times = int(random.integers(1, 4)), int(random.integers(1, 4)), int(random.integers(1, 60))
        n, e = n * times, e * times
    else:
        n, e = (int(random.choice([1, limit, random.integers(1, limit)])) for limit in most)
    return int(random.random() < 0.8), int(random.integers(2)), n, e, int(random.integers(config.rectangles))


def close_candidates(random: np.random.Generator, config: Configuration) -> tuple:
    """Two whose products with the other's denominator are large, and differ by two at most."""
    most, most_below = candidate_limits(config)
    # Of denominators far wider than numerators few have such a pair, and are long to find.
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
    fields = dict(zip(CANDIDATE, candidate, strict=True))
    if config.patterns:
        fields |= {"axis": fields["index"] % 3, "cell": fields["index"] % 8}
    return {f"{name}_{field}": value for field, value in fields.items()}


def fraction_of(candidate) -> Fraction:
    _, _, numerator, denominator, _ = candidate
    return Fraction(numerator, denominator)


@by_screen
def test_nearest_of_two(config, tmp_path):
    latency, ports = contest_latency(config), ("first", "second", "nearest")
    leaf = Leaf(
        nearest_of_two,
        lambda: {"clk": bit(), **{name: candidate_of(config) for name in ports}, "latency": latency},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    pairs = [(any_candidate(random, config), any_candidate(random, config)) for _ in range(3000)]
    pairs += [close_candidates(random, config) for _ in range(1000)]
    stimulus = [
        candidate_ports(config, "first", first) | candidate_ports(config, "second", second) for first, second in pairs
    ]
    outputs = leaf.run_both([*stimulus, *[{}] * latency], settled=latency)
    ties = 0
    for (first, second), output in zip(pairs, outputs[latency:], strict=True):
        valid = [candidate for candidate in (first, second) if candidate[0]]
        assert output["nearest_valid"] == bool(valid)
        if valid:
            # min takes the first of equals.
            assert output == candidate_ports(config, "nearest", min(valid, key=fraction_of)), repeat()
            ties += len(set(map(fraction_of, valid))) < len(valid)
    assert ties > 20


@pytest.mark.parametrize(("count", "contest"), [(1, 2), (2, 2), (3, 2), (5, 2), (8, 2), (12, 2), (1, 3), (7, 3)])
def test_nearest_of(count, contest, tmp_path):
    """The first of the nearest, whatever the number; a single one takes a round too."""
    config = beam_config(rectangles=count)
    rounds = max(1, (count - 1).bit_length())
    record = candidate_of(config)
    leaf = Leaf(
        nearest_of,
        lambda: {
            "clk": bit(), "candidates": unsigned(count * len(record.word)), "nearest": candidate_of(config),
            "rounds": rounds, "latency": contest,
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    # Often with few that are valid, so that each of them is the nearest often enough.
    fields = []
    for _ in range(1200):
        share = random.choice([0.2, 0.5, 1])
        field = [any_candidate(random, config) for _ in range(count)]
        field = [(int(valid and random.random() < share), *others) for valid, *others in field]
        if count > 1 and random.random() < 0.5:
            # Neighbours meet in the first round, and any two in the last one at the latest.
            first = 2 * int(random.integers(count // 2))
            places = [first, first + 1] if random.random() < 0.5 else random.choice(count, 2, replace=False).tolist()
            for place, one in zip(places, close_candidates(random, config), strict=True):
                field[place] = one
        fields.append(field)
    stimulus = [
        {"candidates": sum(record.pack(dict(zip(CANDIDATE, one, strict=True))) << i * len(record.word)
                           for i, one in enumerate(field))}
        for field in fields
    ]  # fmt: skip
    latency = rounds * contest
    outputs = leaf.run_both([*stimulus, *[{}] * latency], settled=latency)
    for field, output in zip(fields, outputs[latency:], strict=True):
        valid = [one for one in field if one[0]]
        assert output["nearest_valid"] == bool(valid), repeat()
        if valid:
            assert output == candidate_ports(config, "nearest", min(valid, key=fraction_of)), repeat()


@pytest.mark.parametrize("cycles", [1, 2, 3, 13])
def test_delay_line(cycles, tmp_path):
    leaf = Leaf(
        delay_line,
        lambda: {"clk": bit(), "word": unsigned(5), "late_word": unsigned(5), "cycles": cycles},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [{"word": int(random.integers(32))} for _ in range(100)]
    outputs = leaf.run_both(stimulus, settled=cycles)
    for inputs, output in zip(stimulus, outputs[cycles:], strict=False):
        assert output == {"late_word": inputs["word"]}


# The colour -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("behind", [0, 1, 3])
def test_colour_mean(behind, tmp_path):
    """Channels at their ends and between; what is behind has a fraction of its own."""
    far_bits, number = CHANNEL_BITS + behind, 3 - behind
    leaf = Leaf(
        colour_mean,
        lambda: {
            "own": unsigned(CHANNEL_BITS),
            "behind": unsigned(far_bits),
            "reflections": unsigned(3),
            "mean": unsigned(far_bits + 1),
            "number": number,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    ends = [[own, far << behind] for own in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << behind) + 1], size=(200, 2)).tolist()]
    # Where a scene asks for fewer reflections, what is behind is not looked at here, nor by who comes before.
    depths = range(number, MOST_REFLECTIONS + 1)
    stimulus = [{"own": own, "behind": far, "reflections": depth} for own, far in pairs for depth in depths]
    for inputs, output in zip(stimulus, leaf.run_both(stimulus), strict=True):
        own = inputs["own"] << behind
        assert output["mean"] == own + (inputs["behind"] if inputs["reflections"] > number else own), (inputs, repeat())


@pytest.mark.parametrize("behind", [0, 1, 3])
def test_colour_mix(behind, tmp_path):
    """Every share of channels at their ends and between; what is behind has a fraction of its own."""
    far_bits = CHANNEL_BITS + 2 * behind
    leaf = Leaf(
        colour_mix,
        lambda: {
            "clk": bit(),
            "near": unsigned(CHANNEL_BITS),
            "mirror": unsigned(MIRROR_BITS),
            "far": unsigned(far_bits),
            "mixed": unsigned(far_bits + 2),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    # The most that is behind is 255, without a fraction.
    ends = [[near, far << 2 * behind] for near in (0, 1, 254, 255) for far in (0, 1, 254, 255)]
    pairs = [*ends, *random.integers([256, (255 << 2 * behind) + 1], size=(400, 2)).tolist()]
    stimulus = [{"near": near, "mirror": mirror, "far": far} for near, far in pairs for mirror in range(5)]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, output in zip(stimulus, outputs[1:], strict=True):
        near, mirror, far = (inputs[name] for name in ("near", "mirror", "far"))
        assert output["mixed"] == (4 - mirror) * (near << 2 * behind) + mirror * far, (inputs, repeat())


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("number", [0, 1, 3])
def test_colour_seen(materials, number, tmp_path):
    """The background where this ray, or one before it, found nothing; a mirror where a scene goes on behind it."""
    config = beam_config(reflections=4, materials=materials)
    leaf = Leaf(
        colour_seen,
        lambda: {
            "clk": bit(), "reached": bit(), "seen": seen_of(config), "picture": Picture(), "found": bit(),
            "shade": shade_of(config), "number": number,
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    stimulus = [
        {
            "reached": int(random.integers(2)),
            "seen_found": int(random.random() < 0.7),
            "seen_colour": int(random.integers(1 << RGB_BITS)),
            **({"seen_mirror": int(random.integers(1, 5))} if materials else {}),
            "picture_background": int(random.integers(1 << RGB_BITS)),
            **({"picture_reflections": int(random.integers(MOST_REFLECTIONS + 1))} if materials else {}),
        }
        for _ in range(400)
    ]
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, now, then in zip(stimulus, outputs, outputs[1:], strict=False):
        found = inputs["reached"] and inputs["seen_found"]
        assert now["found"] == found, (inputs, repeat())
        colour = inputs["seen_colour" if found else "picture_background"].to_bytes(3)
        assert bytes(then[f"shade_{channel}"] for channel in ("red", "green", "blue")) == colour, (inputs, repeat())
        if materials:
            goes_on = inputs["picture_reflections"] > number
            assert then["shade_mirror"] == (inputs["seen_mirror"] if goes_on else 0), (inputs, repeat())


@pytest.mark.parametrize(
    "config",
    [
        beam_config(colour_bits=6),
        beam_config(reflections=0),
        beam_config(reflections=2),
        beam_config(reflections=4, colour_bits=6),
        beam_config(reflections=1, materials=True),
        beam_config(reflections=2, materials=True, colour_bits=6),
        beam_config(reflections=4, materials=True),
        beam_config(reflections=0, materials=True),
    ],
    ids=config_id,
)
def test_colour_blend(config, tmp_path):
    """What comes after a ray that found nothing is background, and weighs as much as the mirrors before it say."""
    rays, record = config.reflections + 1, seen_of(config)
    leaf = Leaf(
        colour_blend,
        lambda: {
            "clk": bit(),
            "seen": unsigned(rays * len(record.word)),
            "picture": Picture(),
            "pixel": Pixel(config.colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    latency, background, reflections = blend_latency(config), 0x123456, 0
    for number in range(3000):
        if number % 100 == 0:
            background, reflections = int(random.integers(1 << RGB_BITS)), number // 100 % rays
        found = (random.random(rays) < 0.8).astype(int).tolist()
        colours = [int(random.integers(1 << RGB_BITS)) for _ in found]
        mirrors = [int(random.integers(5)) if mixes(config) else 2 for _ in found]
        rows = zip(found, mirrors, colours, strict=True)
        fields = [dict(zip(("found", "mirror", "colour"), one, strict=True)) for one in rows]
        stimulus.append({
            "picture_background": background, **({"picture_reflections": reflections} if rays > 1 else {}),
            "seen": sum(record.pack(one) << i * len(record.word) for i, one in enumerate(fields)),
        })  # fmt: skip
        seen = [colour if all(found[: i + 1]) else background for i, colour in enumerate(colours)]
        pixel = []
        for low in (16, 8, 0):
            channels = [Fraction(colour >> low & 255) for colour in seen[: reflections + 1]]
            value = channels.pop()
            for own, quarters in reversed(list(zip(channels, mirrors, strict=False))):
                value = ((4 - quarters) * own + quarters * value) / 4
            pixel.append(int(value) >> CHANNEL_BITS - config.colour_bits)
        expected.append(pixel)
    outputs = leaf.run_both([*stimulus, *[{}] * latency], settled=latency)
    for number, (colour, output) in enumerate(zip(expected, outputs[latency:], strict=True)):
        if number % 100 < 100 - latency:  # of the others the background has changed on the way
            assert [output[f"pixel_{channel}"] for channel in ("red", "green", "blue")] == colour, (number, repeat())


# The look-ups ---------------------------------------------------------------------------------------------------------


def any_facets(random: np.random.Generator, config: Configuration) -> tuple[list[dict[str, int]], int]:
    """Fields of facets, and all of them side by side."""
    record = facet_of(config)
    facets = [
        {name: int(random.integers(1 << bits)) for name, bits in record.layout.items()}
        for _ in range(config.rectangles)
    ]
    return facets, sum(record.pack(facet) << i * len(record.word) for i, facet in enumerate(facets))


@pytest.mark.parametrize("looks", [{}, {"materials": True, "patterns": True}], ids=["plain", "looks"])
def test_look_up(looks, tmp_path):
    """Of each rectangle what it looks like, of a pattern the colour of the cell; between its steps it keeps that."""
    config = beam_config(screen="tiny", rectangles=5, **looks)
    leaf = Leaf(
        look_up,
        lambda: {
            "clk": bit(),
            "step": bit(),
            "facets": unsigned(config.rectangles * len(facet_of(config).word)),
            "sight": Sight(index_bits(config)) if config.patterns else winner_of(config),
            "seen": seen_of(config),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected, kept = [], [], None
    for _ in range(400):
        facets, side_by_side = any_facets(random, config)
        sight = {"valid": int(random.integers(2)), "index": int(random.integers(config.rectangles))}
        sight |= {name: int(random.integers(2)) for name in ("odd_u", "odd_v") if config.patterns}
        step = int(random.random() < 0.8) if kept else 1
        stimulus.append({"step": step, "facets": side_by_side} | {f"sight_{name}": v for name, v in sight.items()})
        if step:
            facet = facets[sight["index"]]
            kept = {"seen_found": sight["valid"], "seen_colour": facet["colour"]}
            if config.patterns:
                odd_u, odd_v = sight["odd_u"], sight["odd_v"]
                second = (False, (odd_u + odd_v) % 2, odd_v, odd_u)[facet["kind"]]
                kept["seen_colour"] = facet["colour_2" if second else "colour"]
            if config.materials:
                kept["seen_mirror"] = facet["mirror"]
        expected.append(kept)
    outputs = leaf.run_both([*stimulus, {"step": 0}], settled=1)
    for output, wanted in zip(outputs[1:], expected, strict=True):
        assert {name: output[name] for name in wanted} == wanted, repeat()


def test_mirror_look_up(tmp_path):
    config = beam_config(screen="tiny", rectangles=5)
    leaf = Leaf(
        mirror_look_up,
        lambda: {
            "clk": bit(),
            "facets": unsigned(config.rectangles * len(facet_of(config).word)),
            "winner": winner_of(config),
            "last": Reflector(),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    for _ in range(200):
        facets, side_by_side = any_facets(random, config)
        at_mirror, index = int(random.integers(2)), int(random.integers(config.rectangles))
        stimulus.append({"facets": side_by_side, "winner_at_mirror": at_mirror, "winner_index": index})
        expected.append({"last_at_mirror": at_mirror} | {f"last_{n}": facets[index][n] for n in ("axis", "distance")})
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    assert outputs[1:] == expected, repeat()


# The cells of patterns ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spare", [0, 2])
def test_bound_tester(spare, tmp_path):
    """Ways right at a bound and beside it, of rays that run either way; a way may be wider than the bounds."""
    bits = 12
    leaf = Leaf(
        bound_tester,
        lambda: {
            "clk": bit(), "step": bit(), "back": bit(), "way": signed(bits + spare), "low": signed(bits),
            "high": signed(bits), "between": bit(),
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    most, stimulus, expected = (1 << bits - 1) - 1, [], [None]
    for number in range(3000):
        low, high = (int(random.choice([-most - 1, -1, 0, most, random.integers(-most, most)])) for _ in range(2))
        way = int(random.choice([low, high])) + int(random.integers(-1, 2))
        way = int(random.choice([way, random.integers(-most << spare, most << spare)]))
        way = int(np.clip(way, -(most + 1) << spare, most << spare))
        step, back = int(number == 0 or random.random() < 0.8), int(random.integers(2))
        words = {"way": way % (1 << bits + spare), "low": low % (1 << bits), "high": high % (1 << bits)}
        stimulus.append({"step": step, "back": back} | words)
        between = high <= way <= low if back else low <= way <= high
        expected.append(between if step else expected[-1])
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for cycle, wanted in enumerate(expected):
        assert wanted is None or bool(outputs[cycle]["between"]) == wanted, (stimulus[cycle - 1], repeat())


@pytest.mark.parametrize("place", [8, 5, 3])
def test_cell_step(place, tmp_path):
    """A quotient's bit, and what is left below it."""
    bits = 7
    leaf = Leaf(
        cell_step,
        lambda: {
            "clk": bit(), "before": CellDivision(bits, place + 1), "after": CellDivision(bits, place), "place": place
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    stimulus = []
    for _ in range(800):
        divisor = int(random.integers(1, 1 << bits))
        edge = int(random.integers(3)) * (divisor << place) + int(random.integers(-1, 2))
        rest = edge if random.random() < 0.5 else int(random.integers(divisor << place + 1))
        fields = {"rest": min(max(rest, 0), (divisor << place + 1) - 1), "divisor": divisor}
        fields |= {"cell": int(random.integers(8)), "odd": int(random.integers(2))}
        stimulus.append({f"before_{name}": value for name, value in fields.items()})
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for inputs, output in zip(stimulus, outputs[1:], strict=True):
        rest, divisor, cell, odd = (inputs[f"before_{name}"] for name in ("rest", "divisor", "cell", "odd"))
        fits = rest // (divisor << place)
        expected = rest % (divisor << place), divisor, cell, fits if 8 << cell == 1 << place else odd
        assert tuple(output[f"after_{name}"] for name in ("rest", "divisor", "cell", "odd")) == expected, repeat()


@pytest.mark.parametrize("config", [beam_config(screen="tiny", patterns=True, turn=True, reflections=2)], ids=config_id)
def test_hit_cell(config, tmp_path):
    """The cell of a coordinate (E + T) +- D n / e within the world, many of them at a cell's edge."""
    slope_bits, numerator_bits, turn_width = exact_slope_bits(config), eye_bits(config) - 1, turn_bits(config)
    leaf = Leaf(
        hit_cell,
        lambda: {
            "clk": bit(), "turn": signed(turn_width), "eye": unsigned(9), "back": bit(),
            "slope": signed(slope_bits + 1), "numerator": unsigned(numerator_bits),
            "denominator": unsigned(slope_bits), "cell_size": unsigned(3), "odd": bit(),
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    far, steepest = (1 << turn_width - 1) - 1, steepest_slope(config)
    stimulus, expected = [{}], {}
    while len(stimulus) < 8000:
        turn, eye, back = int(random.integers(-far, far + 1)), any_place(random), int(random.integers(2))
        goal = 8 * int(random.integers(64)) + int(random.choice([-1, 0, 0, 1]))
        e = int(random.choice([1, 3, steepest, random.integers(1, steepest + 1)]))
        way = (goal - eye - turn) * (-1 if back else 1) * e + int(random.integers(-1, 2))
        slope = int(random.choice([1, way, random.integers(1, steepest + 1)])) * (1 if way > 0 else -1) or 1
        slope = int(np.clip(slope, -steepest, steepest))
        n = min(abs(way // slope), (1 << numerator_bits) - 1)
        place = eye + turn + Fraction((-1 if back else 1) * slope * n, e)
        if not 0 <= place <= LAST or not n:
            continue
        cell = int(random.integers(8))
        stimulus[-1] |= {"turn": turn % (1 << turn_width), "eye": eye, "back": back, "numerator": n, "denominator": e,
                         "cell_size": cell}  # fmt: skip
        expected[len(stimulus) - 1 + CELL_LATENCY - 1] = int(place // (8 << cell)) % 2
        stimulus.append({"slope": slope % (1 << slope_bits + 1)})
    outputs = leaf.run_both([*stimulus, *[{}] * CELL_LATENCY], settled=min(expected))
    for cycle, odd in expected.items():
        assert outputs[cycle]["odd"] == odd, (stimulus[cycle - CELL_LATENCY + 1 :][:2], repeat())


def to_edge(random: np.random.Generator, config: Configuration, axis: int, plane: int, eye, turned, slope):
    """A slope with which the ray meets a plane at a cell's edge, or next to it by the least that its fraction can say.

    The sum that is divided is then a cell's edge times the divisor, plus -1, 0 or 1: (edge - E) e + more = D n.
    """
    found, steepest = np.array(slope), steepest_slope(config)
    n, sign = abs(int(plane - eye[axis])), 1 if plane > eye[axis] else -1
    u = int(random.choice(OTHER_AXES[axis]))
    way, more = 8 * int(random.integers(64)) - int(eye[u]), int(random.integers(-1, 2))
    if n == 0 or gcd(way, n) > 1:
        return found
    # The least divisor, and any that is as many times the distance more; without a turn it is what it is along x.
    least = -more * pow(way, -1, n) % n
    most = min(steepest, (steepest * n - 1) // max(abs(way), 1))
    if most < least or (not config.turn and 0 in (axis, u)):
        return found
    e = least + n * int(random.integers((most - least) // n + 1))
    if e > 0:
        # The mirrors have turned around what differs from the ray's own.
        found[axis] = sign * e * (-1 if turned[axis] != slope[axis] else 1)
        found[u] = (way * e + more) // n * (-1 if turned[u] != slope[u] else 1)
    return found


@pytest.mark.slow_sets("beam-tiny48-s2-u1-r12-m0", "beam-vga180")
@pytest.mark.parametrize(
    "config",
    [
        beam_config(screen="tiny", patterns=True, reflections=0),
        beam_config(patterns=True, rows=180),
        beam_config(screen="tiny", patterns=True, turn=True, reflections=2),
        beam_config(screen="tiny", patterns=True, reflections=4),
    ],
    ids=config_id,
)
def test_hit_cells(config, tmp_path):
    """Points of all axes, many of them right at a cell's edge; what sees nothing is don't care."""
    slope_bits, latency = exact_slope_bits(config), CELL_LATENCY
    leaf = Leaf(
        hit_cells,
        lambda: {
            "clk": bit(),
            "turn": turn_of(config),
            "nearest": candidate_of(config),
            "winner": winner_of(config),
            "slope": Direction(slope_bits + 1),
            "camera": Point(),
            "sight": Sight(index_bits(config)),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [{} for _ in range(4000)], {}
    cycle = 0
    for table, chosen, camera, ray, mirrors in beam_rays(random, config, 1200):
        for index in 8 * list(chosen):
            axis, plane, slope = int(table.axes[index]), any_place(random), ray
            eye, turned = seen_from(camera, slope, mirrors)
            u, v = OTHER_AXES[axis]
            if random.random() < 0.5:
                slope = to_edge(random, config, axis, plane, eye, turned, slope)
                eye, turned = seen_from(camera, slope, mirrors)
            elif turned[u] and random.random() < 0.5:
                t = Fraction(8 * int(random.integers(64)) - int(eye[u]), int(turned[u]))
                plane = int(eye[axis] + int(turned[axis]) * t) if turned[axis] else plane
            n, e = (plane - int(eye[axis])) * int(np.sign(turned[axis])), abs(int(turned[axis]))
            if n <= 0 or not 0 <= plane < WORLD_SIZE:
                continue
            point = [Fraction(int(eye[c]) * e + int(turned[c]) * n, e) for c in (u, v)]
            if not all(0 <= coordinate <= LAST for coordinate in point) or cycle + latency >= len(stimulus):
                continue
            cell, number = int(random.integers(6)), int(random.integers(config.rectangles))
            parities = [int(coordinate // (8 << cell)) % 2 for coordinate in point]
            fields = {"valid": 1, "numerator": n, "denominator": e, "axis": axis, "cell": cell}
            stimulus[cycle] |= {f"nearest_{name}": value for name, value in fields.items()}
            stimulus[cycle] |= {"winner_valid": 1, "winner_index": number}
            image = image_of(config, camera, slope, mirrors)
            stimulus[cycle + 1] |= {f"turn_{name}": value for name, value in image.items()}
            stimulus[cycle + 1] |= {f"camera_{name}": int(value) for name, value in zip(AXES, camera, strict=True)}
            stimulus[cycle + CELL_SLOPE_AT] |= direction_ports("slope", config, slope)
            expected[cycle + latency] = *parities, number
            cycle += 1
    assert len(expected) > 400
    outputs = leaf.run_both(stimulus, settled=1 + latency)
    for cycle, values in expected.items():
        output = outputs[cycle]
        assert output["sight_valid"]
        assert tuple(output[f"sight_{name}"] for name in ("odd_u", "odd_v", "index")) == values, (cycle, repeat())


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
    # A camera that turns looks at more places from which a second mirror is out of reach.
    for _ in range(5000):
        camera, table = random.integers(WORLD_SIZE, size=3), flat_tables(random, count)
        corners, order = table.corners.copy(), random.permutation(count)
        # The last column whose rays run down along y is the one that tells its sign from the next one's.
        column = before_centre if random.random() < 0.1 else int(random.integers(len(slopes), size=2).min())
        # After two mirrors and more the lowest bits count where a small odd slope reaches an edge exactly.
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
                # It may meet the one before the last again, which then is the other of the two.
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
        traced = ExactModel().trace(table, camera, (0, 0, 0), slopes[column : column + 1], ends, keep=True)
        if traced.bounces[-1].hits.sum() >= min(1 if by_mirror else 2, count):
            return camera, table, column
    raise AssertionError(f"no ray has two rectangles, or one by a mirror, after {ends} reflections; {repeat()}")


@pytest.mark.slow_sets(
    "beam-tiny48-s1-u1-r3-m1-c8-24",
    "beam-tiny48-s1-u1-r3-m2-c8-400",
    "beam-tiny48-s1-u1-r3-m2-c8-turn-200",
    "beam-tiny48-s1-u1-r5",
    "beam-tiny48-s2-u1-r8-m2-c8-12",
    "beam-tiny48-s2-u1-r8-m2-c8-turn-materials-patterns-12",
    "beam-tiny48-s2-u2-r3",
    "beam-tiny48-s2-u2-r5",
    "beam-vga180",
)
@pytest.mark.parametrize(
    ("config", "lines"),
    [
        (beam_config(screen="tiny", rectangles=1, reflections=0, colour_bits=4), 24),
        (beam_config(screen="tiny", rectangles=3, reflections=1, scale=1), 24),
        # Small enough for every rectangle to matter in every pass.
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1), 400),
        (beam_config(screen="tiny", rectangles=8, reflections=2), 12),
        (beam_config(screen="tiny", rectangles=5, reflections=3, scale=1), 60),
        (
            beam_config(screen="tiny", rectangles=5, reflections=4, scale=1, turn=True, materials=True, patterns=True),
            24,
        ),
        (beam_config(screen="tiny", rectangles=5, reflections=4, pixels=2), 24),
        (beam_config(rows=180, rectangles=5, reflections=1), 4),
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1, turn=True), 200),
        (beam_config(screen="tiny", rectangles=3, reflections=1, scale=1, materials=True, patterns=True), 24),
        (beam_config(screen="tiny", rectangles=8, reflections=2, turn=True, materials=True, patterns=True), 12),
        (beam_config(screen="tiny", rectangles=2, reflections=0, scale=1, materials=True, patterns=True), 24),
        (beam_config(screen="tiny", rectangles=1, reflections=0, colour_bits=4, pixels=2), 12),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2), 40),
        (beam_config(rows=180, scale=6, rectangles=5, reflections=1, pixels=2), 4),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2, turn=True, patterns=True), 24),
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
            "row_slope": signed(factor_bits(config)),
            "camera": camera_of(config),
            "picture": Picture(),
            "rects": Rects(config),
            "pixel": shown_of(config),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes, basis, horizon_row = primary_slopes(config.screen_geometry), UNTURNED, config.screen_geometry.horizon_row
    # Of a camera that turns, the rectangles are set up for each lane, and once more.
    turns = range(config.pixels + 1)
    sweeps = (
        [AIM_LATENCY - 3 + (SETUP_LATENCY + config.rectangles - 1) * turn for turn in turns] if config.turn else [0]
    )
    # Until no column is on its way, whatever the registers started from.
    stimulus, expected, fates = [{"reset": 1}] * beam_latency(config), {}, set()
    flat = [horizon_row + slope for slope in (-3, -1, 1, 3)]
    for number in range(lines):
        if config.turn:
            basis = random_basis(random)
            slopes = primary_slopes(config.screen_geometry, basis)
        row = int(random.choice([0, len(slopes) - 1, *flat, *random.integers(len(slopes), size=4)]))
        if number % 8:
            camera, table, column = race(random, config, slopes[row])
            background, reflections = random.integers(256, size=3), config.reflections
            columns = column + 1 + int(random.integers(4))
            line = slopes[row, : columns + columns % config.pixels]
        else:
            camera, table, background, reflections, _ = traced_scene(random, config, random.permutation(slopes[row]))
            line = slopes[row]
        if config.materials:
            table = random_looks(random, table)
        traced = ExactModel().trace(table, camera, background, line, reflections)
        fates |= {tuple(int(winner[column] >= 0) for winner in traced.winners) for column in range(len(line))}
        vectors = np.concatenate([camera, *(basis if config.turn else ())]).tolist()
        held = {f"camera_{name}": value for name, value in zip(camera_of(config).layout, vectors, strict=True)}
        held |= {"reset": 0, "start_line": 0, "next_column": 0}
        held |= {"picture_reflections": reflections} if config.reflections else {}
        held["picture_background"] = int.from_bytes(bytes(background.astype(np.uint8)))
        held["rects_usable"] = sum(1 << int(index) for index in np.flatnonzero(table.visible))
        if number % 16 == 4:
            # Reset ends what a line has begun.
            begun = int(random.integers(config.rectangles + 2))
            stimulus += [{**held, "start_line": 1}, *[held] * begun, {**held, "reset": 1}]
            stimulus += [held] * beam_latency(config)
        stimulus += [{**held, "start_line": 1}, held, held]
        held["row_slope"] = word(horizon_row - row, factor_bits(config))
        given = {sweep + 3 + index: index for sweep in sweeps for index in np.flatnonzero(table.visible)}
        for cycle in range(3, start_cycles(config) + int(random.integers(4))):
            rect = sorted_rect(table, given[cycle], "rects_rect", config) if cycle in given else {}
            stimulus.append({**held, **rect})
        for colours in traced.colours.reshape(-1, config.pixels, 3):
            stimulus += [held] * int(random.random() < 0.5 * (config.scale == 1 and number % 8 == 0))
            expected[len(stimulus) + beam_latency(config)] = (
                [pixel_word(config, colour) for colour in colours],
                (camera, table.corners, repeat()),
            )
            stimulus.append({**held, "next_column": 1})
        stimulus += [held] * beam_latency(config)
    outputs = leaf.run_both([*stimulus, {}], settled=min(expected))
    assert len(fates) >= config.reflections + 2
    for cycle, (pixels, case) in expected.items():
        channels = [outputs[cycle][f"pixel_{name}"] for name in ("red", "green", "blue")]
        assert pixels_of(config, channels) == pixels, (cycle, case)


def row_signals(config: Configuration) -> dict[str, object]:
    """Through which a lane, and each of its passes, get a row that was set up."""
    return {
        "start_line": bit(),
        "load": unsigned(config.rectangles),
        "start": walk_of(config),
        "aim": Direction(exact_slope_bits(config) + 1),
        "facets": unsigned(config.rectangles * len(facet_of(config).word)),
        "growths": unsigned(config.rectangles * len(stride_of(config).word)),
    }


def row_ports(config: Configuration, table: Rectangles, camera, slopes) -> tuple[dict[str, int], list[dict[str, int]]]:
    """What their ports hold in a row, and what else the cycles get in which it begins.

    slopes: of the lane's first column, and of the next one to the right.
    """
    facet, growth = facet_of(config), stride_of(config)
    begin: list[dict[str, int]] = [{"start_line": 1}]
    facets = growths = 0
    for index in range(config.rectangles):
        now, then = (products(table, index, camera, slope) for slope in slopes)
        seen = {"usable": 1, "axis": table.axes[index], "distance": now["distance"], "way_q": now["way_q"]}
        seen["colour"] = int.from_bytes(bytes(table.colours[index]))
        more = {name: config.pixels * (then[name] - now[name]) for name in WALK}
        facets |= facet.pack(seen) << index * len(facet.word)
        growths |= growth.pack(more) << index * len(growth.word)
        begin.append({f"start_{name}": word(now[name], walk_bits(config)) for name in WALK} | {"load": 1 << index})
    held = direction_ports("aim", config, slopes[0])
    return held | {"facets": facets, "growths": growths, "start_line": 0, "load": 0}, begin


@pytest.mark.parametrize("mirrors", [0, 1, 2])
def test_beam_pass(mirrors, tmp_path):
    """The rectangle that a ray meets after so many mirrors, in rows of which a set-up knows the products."""
    config = beam_config(screen="tiny", rectangles=3, reflections=2, scale=1)
    strobes = ("step", "step_way", "step_bounds", "step_slope")
    leaf = Leaf(
        beam_pass,
        lambda: {
            "clk": bit(),
            **row_signals(config),
            **{strobe: bit() for strobe in strobes},
            "fold": fold_of(config),
            "nearest": candidate_of(config),
            "winner": winner_of(config),
            "tested": range(config.rectangles),
            "reflected": mirrors > 0,
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes, quiet = primary_slopes(config.screen_geometry), dict.fromkeys(strobes, 0)
    steepest = steepest_slope(config)
    spare = steepest - int(abs(slopes[..., 1]).max())
    stimulus, expected = [quiet] * winner_latency(config), {}
    for _ in range(500):
        # Of another screen's view, from any column on, for each bit of the slopes to count.
        view = slopes[int(random.integers(len(slopes)))].copy()
        view[:, 0] = random.integers(1, steepest + 1)
        view[:, 1] += random.integers(-spare, spare + 1)
        view[:, 2] = random.integers(-steepest, steepest + 1)
        camera, table, column = race(random, config, view)
        first = int(random.integers(column + 1))
        line = view[first : column + 1 + int(random.integers(4))]
        traced = ExactModel().trace(table, camera, (0, 0, 0), line, mirrors)
        held, begin = row_ports(config, table, camera, view[first : first + 2])
        stimulus += [quiet | held | cycle for cycle in begin]
        # A column's strobes follow it; now and then a cycle is no column's.
        starts = np.cumsum(random.choice([1, 2], len(line), p=[0.8, 0.2])).tolist()
        cycles = [quiet | held for _ in range(starts[-1] + winner_latency(config) + 1)]
        for number, start in enumerate(starts):
            slope, winners = line[number], [int(winner[number]) for winner in traced.winners]
            for strobe, later in zip(strobes, (0, int(not mirrors), 1, 2), strict=True):
                cycles[start + later][strobe] = 1
            if -1 in winners[:mirrors]:
                continue
            met = [(axis := int(table.axes[winner]), int(table.low[winner, axis])) for winner in winners[:mirrors]]
            if mirrors:
                fields = folded(config, camera, slope, met)
                cycles[start] |= {f"fold_{name}": value for name, value in fields.items()}
            case = camera, table.corners, slope, met, repeat()
            values = {"winner_valid": int(winners[mirrors] >= 0)}
            if winners[mirrors] >= 0:
                eye, turned = seen_from(camera, slope, met)
                seen_by = table, winners[mirrors], eye, turned, met[-1] if met else None
                _, n, e = verdict(*seen_by, met_last(camera, slope, met))
                values |= {"winner_index": winners[mirrors], "winner_at_mirror": int(not verdict(*seen_by)[0])}
                values |= {"nearest_numerator": n, "nearest_denominator": e}
            expected[len(stimulus) + start + winner_latency(config)] = values, case
        stimulus += cycles
    outputs = leaf.run_both([*stimulus, quiet], settled=min(expected))
    for cycle, (values, case) in expected.items():
        assert {name: outputs[cycle][name] for name in values} == values, case


@pytest.mark.slow_sets("beam-tiny48-s1", "beam-tiny48-s2-u2-r3-m2-c8-1")
@pytest.mark.parametrize(
    ("config", "first", "lines"),
    [
        # Small enough for every rectangle to matter in every pass.
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1), 0, 300),
        (beam_config(screen="tiny", rectangles=3, reflections=4, scale=1), 0, 60),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2), 0, 40),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2), 1, 40),
    ],
    ids=config_id,
)
def test_beam_lane(config, first, lines, tmp_path):
    """Rows of which a set-up knows the products: every column, or every other one from the first or the second on."""
    leaf = Leaf(
        beam_lane,
        lambda: {
            "clk": bit(),
            "next_column": bit(),
            "enter": tied(0, 1),
            **row_signals(config),
            "camera": camera_of(config),
            "picture": Picture(),
            "pixel": Pixel(config.colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes, steepest = primary_slopes(config.screen_geometry), steepest_slope(config)
    spare = steepest - int(abs(slopes[..., 1]).max())
    stimulus, expected = [{"next_column": 0}] * beam_latency(config), {}
    for number in range(lines):
        view = slopes[int(random.integers(len(slopes)))].copy()
        if number % 2:
            # Of another screen's view, for each bit of the slopes to count.
            view[:, 0] = random.integers(1, steepest + 1)
            view[:, 1] += random.integers(-spare, spare + 1)
            view[:, 2] = random.integers(-steepest, steepest + 1)
        camera, table, column = race(random, config, view)
        background = random.integers(256, size=3)
        reflections = config.reflections if number % 4 else int(random.integers(config.reflections))
        line = view[: column + 1 + int(random.integers(4))]
        traced = ExactModel().trace(table, camera, background, line[first :: config.pixels], reflections)
        held, begin = row_ports(config, table, camera, view[first : first + 2])
        held |= {"next_column": 0, "picture_reflections": reflections}
        held["picture_background"] = int.from_bytes(bytes(background.astype(np.uint8)))
        stimulus += [held | cycle for cycle in begin]
        for colour in traced.colours:
            expected[len(stimulus) + beam_latency(config)] = pixel_word(config, colour), repeat()
            stimulus.append({**held, "next_column": 1})
        stimulus += [held] * beam_latency(config)
    outputs = leaf.run_both([*stimulus, {}], settled=min(expected))
    for cycle, (pixel, case) in expected.items():
        channels = [outputs[cycle][f"pixel_{name}"] for name in ("red", "green", "blue")]
        assert pixels_of(config, channels)[:1] == [pixel], (cycle, case)
