# SPDX-License-Identifier: MIT
"""What a ray unit is made of, but for its arithmetic: MyHDL's simulator, the converted Verilog and golden on one set of
vectors."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from raycaster.configuration import CHANNEL_BITS, WORLD_SIZE, Configuration, configure
from raycaster.golden import seed_engine
from raycaster.golden.engines import model_of
from raycaster.golden.random_world import EXTREMES, random_camera, random_looks, random_rectangles, random_slopes
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.common.interfaces import Picture, Place, Slope, Steps
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.records import Origin, Pixel, Ray, Signs, rect_of
from raycaster.rtl.common.ties import tied, unconnected
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    CELL_BITS,
    MIRROR_BITS,
    RGB_BITS,
    bit,
    position_bits,
    share_bits,
    signed,
    unit_bits,
    unsigned,
)
from raycaster.rtl.engine.colour_combiner import colour_combiner
from raycaster.rtl.engine.colour_share import colour_share
from raycaster.rtl.engine.colour_sum import colour_sum
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.seed.cell_parity import cell_parity
from raycaster.rtl.seed.intersection_finder import intersection_finder
from raycaster.rtl.seed.ray_mem import ray_mem
from raycaster.rtl.seed.z_buffer import z_buffer
from raycaster.screens import VIEW_DISTANCE
from raycaster.verif.leaf import Leaf, sorted_rect, trace_cycles
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
SLOPES = (0, 1, 2, 99, 100, 160, 190, 255, 256, 510, 511)


def config_id(config: Configuration) -> str:
    return config.name


def any_config(**options) -> Configuration:
    return configure(**{"rectangles": 4, "allow_underrun": True} | options)


fractions = pytest.mark.parametrize(
    "config", [any_config(fraction_bits=bits) for bits in (0, 3, 8)], ids=lambda config: f"F{config.fraction_bits}"
)

# The divider's bits a cycle matter here by its steps alone, so they need not meet every F.
finders = pytest.mark.parametrize(
    "config",
    [
        any_config(fraction_bits=bits, rounding=rounding, divider_bits=divider_bits)
        for bits, divider_bits in ((0, 1), (0, 3), (1, 2), (4, 3), (8, 2))
        for rounding in ("truncate", "nearest")
    ]
    + [any_config(fraction_bits=bits, materials=bits > 0, patterns=True) for bits in (0, 3)],
    ids=config_id,
)


def finder_leaf(config: Configuration, directory) -> Leaf:
    return Leaf(
        intersection_finder,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "rect": rect_of(config),
            "offered": rect_of(config),
            "ray": Ray(config),
            "slope": Slope(),
            "hit": bit(),
            "depth": unsigned(position_bits(config)),
            "point": Origin(config),
            "odd_u": bit() if config.patterns else unconnected(1),
            "odd_v": bit() if config.patterns else unconnected(1),
            "towards": bit(),
            "config": config,
        },
        directory,
    )


def ray_inputs(origin, slope) -> dict[str, int]:
    inputs = {f"ray_{axis}": int(value) for axis, value in zip(AXES, origin, strict=True)}
    inputs |= {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
    return inputs | {f"ray_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}


def finder_stimulus(config: Configuration, rays) -> tuple[list[dict[str, int]], list[tuple[int, int, int]]]:
    """One pass a ray over its table: the cycles, and (cycle, ray, rectangle) of each result."""
    stimulus, results = [], []
    for number, (origin, slope, table) in enumerate(rays):
        visible = [int(index) for index in np.flatnonzero(table.visible)]
        for cycle in trace_cycles(config, visible, 0)[1:]:
            inputs = ray_inputs(origin, slope)
            for name in ("find_intersection", "load_divider", "store_quotient"):
                inputs[f"steps_{name}"] = cycle.steps[f"steps_{name}"]
            if cycle.current is not None:
                inputs |= sorted_rect(table, cycle.current, "rect", config)
            if cycle.offered is not None:
                inputs |= sorted_rect(table, cycle.offered, "offered", config)
            if cycle.steps["steps_write_z_buf"]:
                results.append((len(stimulus), number, cycle.offered))
            stimulus.append(inputs)
    return stimulus, results


def traced_rays(config: Configuration, random: np.random.Generator, count: int) -> list:
    """Rays as the engine meets them: whole origins first, then origins with a fraction, on the mirror that was hit."""
    rays = []
    while len(rays) < count:
        table = random_rectangles(random, count=8, closed=True)
        camera, slopes = random_camera(random, table), random_slopes(random, 2)
        trace = model_of(config).trace(table, camera, (0, 0, 0), slopes, 2, keep=True)
        for bounce in trace.bounces:
            for ray in np.flatnonzero(bounce.alive):
                golden = [(bool(bounce.hits[i, ray]), bounce.depths[i, ray], bounce.points[i, ray]) for i in range(8)]
                rays.append((bounce.origins[ray], bounce.slopes[ray], table, golden))
    return rays[:count]


def meet(config: Configuration, origin, slope, axis: int, plane: int) -> tuple[np.ndarray, bool]:
    """Where a ray meets a plane of this axis, and whether it does."""
    point, valid = np.zeros(3, dtype=int), True
    point[axis] = plane << config.fraction_bits
    for other in OTHER_AXES[axis]:
        point[other], exists = seed_engine.intersect(
            origin[other], slope[other], point[axis], origin[axis], slope[axis], config.fraction_bits, config.rounding
        )
        valid = valid and bool(exists)
    return point, valid


def aimed_ray(config: Configuration, random: np.random.Generator) -> tuple:
    """A ray of any slope from anywhere, and rectangles whose bounds are at, or next to, the point that it meets."""
    fraction_bits, limit = config.fraction_bits, WORLD_SIZE - 1
    origin = np.where(
        random.random(3) < 0.4,
        random.choice(EXTREMES, 3) << fraction_bits,
        random.integers(WORLD_SIZE << fraction_bits, size=3),
    )
    slope = random.choice(SLOPES, 3) * random.choice([-1, 1], 3)
    corners = np.zeros((4, 2, 3), dtype=int)
    for low, high in corners:
        axis = int(random.integers(3))
        high[:] = limit
        low[axis] = high[axis] = random.choice([*EXTREMES, random.integers(limit), origin[axis] >> fraction_bits])
        point, _ = meet(config, origin, slope, axis, low[axis])
        for other in OTHER_AXES[axis]:
            # A bound that has another bit is seen from near it; the lowest bits from nearest.
            away = random.choice([-1, 1]) * int(random.integers(1 << int(random.integers(9))))
            near = int(np.clip((point[other] >> fraction_bits) + away, 0, limit))
            if random.random() < 0.7:
                low[other], high[other] = random.choice([(near, limit), (0, near), (near, near)])
    table = Rectangles(corners, np.zeros((4, 3), dtype=np.uint8), np.ones(4, dtype=bool))
    golden = []
    for low, high, axis in zip(table.low, table.high, table.axes, strict=True):
        point, valid = meet(config, origin, slope, axis, low[axis])
        inside = np.all((low << fraction_bits <= point) & (point <= high << fraction_bits))
        golden.append((valid and bool(inside), abs(point[0] - origin[0]), point))
    return origin, slope, table, golden


@pytest.mark.slow_sets(
    "seed-vga240-u32-r4-m1-f0n", "seed-vga240-u32-r4-m1-f0t-d3", "seed-vga240-u32-r4-m1-f1", "seed-vga240-u32-r4-m1-f4"
)
@finders
def test_intersection_finder(config, tmp_path):
    random = np.random.default_rng(seed())
    rays = [
        (origin, slope, random_looks(random, table), golden)
        for origin, slope, table, golden in traced_rays(config, random, 15)
        + [aimed_ray(config, random) for _ in range(180)]
    ]
    stimulus, results = finder_stimulus(config, [ray[:3] for ray in rays])
    outputs = finder_leaf(config, tmp_path).run_both(stimulus, settled=config.divider_steps + 5)
    seen = set()
    for cycle, ray, index in results:
        origin, slope, table, golden = rays[ray]
        hit, depth, point = golden[index]
        output = outputs[cycle]
        case = f"origin {origin}, slope {slope}, corners {table.corners[index].tolist()}: {output}; {repeat()}"
        assert output["hit"] == hit, case
        if hit:
            assert output["depth"] == depth, case
            assert [output[f"point_{axis}"] for axis in AXES] == list(point), case
            if config.patterns:
                cell = int(table.cells[index]) << config.fraction_bits
                odd = [int(point[axis]) // cell % 2 for axis in OTHER_AXES[table.axes[index]]]
                assert [output["odd_u"], output["odd_v"]] == odd, case
        seen.add((int(table.axes[index]), hit))
    assert len(seen) == 6, "each axis was to be hit and missed"


@pytest.mark.parametrize(
    "config",
    [any_config(), any_config(fraction_bits=8), any_config(materials=True), any_config(fraction_bits=3, patterns=True)],
    ids=config_id,
)
def test_z_buffer(config, tmp_path):
    width = position_bits(config)
    kept_words = ["found_axis", "found_colour", *(["found_mirror"] if config.materials else [])]
    leaf = Leaf(
        z_buffer,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "offered": rect_of(config),
            "colour": unsigned(RGB_BITS),
            "hit": bit(),
            "depth": unsigned(width),
            "point": Origin(config),
            "found": bit(),
            "found_axis": unsigned(AXIS_BITS),
            "found_colour": unsigned(RGB_BITS),
            "found_mirror": unsigned(MIRROR_BITS) if config.materials else unconnected(MIRROR_BITS),
            "found_point": Origin(config),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    limit = (1 << width) - 1
    stimulus = [{"steps_reset_z_buf": 1}]
    for number in range(1500):
        # Few depths, so that many tie; and a first hit, from which on all registers are known.
        depth = random.choice([0, 1, 255, 256, limit - 1, limit, random.integers(limit)])
        write = number == 0 or random.random() < 0.7
        stimulus.append(
            {
                "steps_reset_z_buf": int(number > 0 and random.random() < 0.15),
                "steps_write_z_buf": int(write),
                "hit": int(number == 0 or random.random() < 0.7),
                "depth": int(depth),
                "offered_axis": int(random.integers(3)),
                "colour": int(random.integers(1 << RGB_BITS)),
                **({"offered_mirror": int(random.integers(5))} if config.materials else {}),
                **{f"point_{axis}": int(random.integers(limit + 1)) for axis in AXES},
            }
        )
    outputs = leaf.run_both(stimulus, settled=2)
    kept = None
    for cycle, (inputs, output) in enumerate(zip(stimulus[1:], outputs[1:], strict=True)):
        assert output["found"] == (kept is not None), (cycle, repeat())
        if kept is not None:
            for name in kept_words:
                of_port = name.replace("found", "offered")
                assert output[name] == kept["colour" if name == "found_colour" else of_port], (cycle, repeat())
            for axis in AXES:
                assert output[f"found_point_{axis}"] == kept[f"point_{axis}"], (cycle, repeat())
        if inputs["steps_reset_z_buf"]:
            kept = None
        elif inputs["steps_write_z_buf"] and inputs["hit"] and (kept is None or inputs["depth"] < kept["depth"]):
            kept = inputs


@fractions
def test_ray_mem(config, tmp_path):
    leaf = Leaf(
        ray_mem,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "found_axis": unsigned(AXIS_BITS),
            "found_point": Origin(config),
            "ray": Ray(config),
            "reflected": Ray(config),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    values = [*EXTREMES, (1 << position_bits(config)) - 1]
    stimulus = [
        {
            "steps_store_ray": int(number == 0 or random.random() < 0.7),
            "found_axis": number % 3,
            **{f"found_point_{axis}": int(random.choice(values)) for axis in AXES},
            **{f"ray_d{axis}": int(random.integers(2)) for axis in AXES},
            **{f"ray_{axis}": int(random.choice(values)) for axis in AXES},
        }
        for number in range(300)
    ]
    outputs = leaf.run_both(stimulus, settled=1)
    for inputs, output in zip(stimulus[:-1], outputs[1:], strict=True):
        if inputs["steps_store_ray"]:
            expected = {f"reflected_{axis}": inputs[f"found_point_{axis}"] for axis in AXES}
            for number, axis in enumerate(AXES):
                expected[f"reflected_d{axis}"] = inputs[f"ray_d{axis}"] ^ (inputs["found_axis"] == number)
        assert output == expected, (inputs, repeat())


@pytest.mark.parametrize(
    "config",
    [
        any_config(screen=screen, rows=rows, units=units)
        for screen, rows, units in (
            ("vga", 240, 1), ("vga", 240, 5), ("vga", 240, 32), ("vga", 240, 40), ("vga", 240, 320),
            ("vga", 200, 20), ("vga", 200, 64), ("tiny", 48, 1), ("tiny", 48, 16), ("tiny", 48, 64),
        )
    ],
    ids=config_id,
)  # fmt: skip
def test_ray_generator(config, tmp_path):
    leaf = Leaf(
        ray_generator,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "place": Place(config),
            "column_base": unsigned(unit_bits(config)),
            "initial_signs": Signs(),
            "slope": Slope(),
            "config": config,
        },
        tmp_path,
    )
    screen = config.screen_geometry
    horizon, last_row, last_column = screen.horizon_row, screen.rows - 1, screen.columns - 1
    rays = {(row, column) for row in (0, 1, horizon, last_row) for column in range(screen.columns)}
    rays |= {(row, column) for row in range(screen.rows) for column in (0, screen.centre_column, last_column)}
    stimulus = [
        {
            "place_row": row,
            "place_column_offset": column // config.units,
            "column_base": column % config.units,
            "steps_screen_to_ray": load,
        }
        for number, (row, column) in enumerate(sorted(rays))
        # Not every ray is loaded; the one before it must then stay.
        for load in ([1] if number % 8 == 0 else [0] if number % 8 == 1 else [0, 1])
    ]
    # The counters rest one past their last value; nothing there may overflow.
    stimulus.append({"place_row": screen.rows, "place_column_offset": config.groups, "column_base": config.units - 1})
    outputs = leaf.run_both(stimulus, settled=1)
    slopes = primary_slopes(screen)
    loaded = 0
    for inputs, output in zip(stimulus[:-1], outputs[1:], strict=True):
        if inputs["steps_screen_to_ray"]:
            loaded += 1
            column = inputs["place_column_offset"] * config.units + inputs["column_base"]
            slope = slopes[inputs["place_row"], column]
            expected = {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
            expected |= {f"initial_signs_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}
            assert expected["slope_dx"] == VIEW_DISTANCE
        assert output == expected, inputs
    assert loaded > len(rays) * 3 // 4


@pytest.mark.parametrize(("value_bits", "bits"), [(2, 1), (5, 4), (10, 9), (13, 9)])
def test_magnitude(value_bits, bits, tmp_path):
    """Of each value whose magnitude fits."""
    leaf = Leaf(magnitude, lambda: {"value": signed(value_bits), "result": unsigned(bits)}, tmp_path)
    values = range(1 - (1 << bits), 1 << bits)
    outputs = leaf.run_both([{"value": value % (1 << value_bits)} for value in values])
    assert [output["result"] for output in outputs] == [abs(value) for value in values]


def mirrored(random: np.random.Generator, run_time: int) -> list[tuple[bool, int]]:
    """What becomes of a ray and its reflections: whether it hits something, and how much that mirrors, in quarters."""
    return [(bool(random.random() < 0.75), int(random.integers(5))) for _ in range(run_time + 1)]


def plain_shares(hits: list[tuple[bool, int]]) -> list[Fraction]:
    """How much what each ray saw counts: a mirror passes its quarters on, a miss and the last hit pass on nothing."""
    shares, left = [], Fraction(1)
    for number, (found, quarters) in enumerate(hits):
        passed_on = Fraction(quarters, 4) if found and number < len(hits) - 1 else Fraction(0)
        shares.append(left * (1 - passed_on))
        left *= passed_on
    return shares


def cases(random: np.random.Generator, run_time: int, one_ray: list) -> list[tuple]:
    """What each ray of a pixel may be: all that there is, or some where that is too much."""
    if len(one_ray) ** (run_time + 1) <= 1000:
        return list(product(one_ray, repeat=run_time + 1))
    return [tuple(one_ray[i] for i in random.integers(len(one_ray), size=run_time + 1)) for _ in range(300)]


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
def test_colour_share(reflections, materials, tmp_path):
    """Of each mirror after each other one, and misses among them."""
    config = any_config(reflections=reflections, materials=materials)
    leaf = Leaf(
        colour_share,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "found": bit(),
            "found_mirror": unsigned(MIRROR_BITS) if materials else tied(0, MIRROR_BITS),
            "share": unsigned(share_bits(config)),
            "missed": bit(),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
    one_ray = list(product((False, True), range(5) if materials else [2]))
    whole = 1 << (share_bits(config) - 1)
    stimulus, results = [], []
    for run_time in range(reflections + 1):
        for hits in cases(random, run_time, one_ray):
            stimulus.append({**idle, "steps_reset_colour": 1})
            missed = False
            # Without materials the background of a miss counts as it would have with all that follows.
            weighing = hits if materials else [(True, 2)] * len(hits)
            for number, ((found, quarters), share) in enumerate(zip(hits, plain_shares(weighing), strict=True)):
                # Only what is found in the cycle of the addition counts.
                other = {"found": int(random.integers(2)), "found_mirror": int(random.integers(5))}
                stimulus += [{**idle, **other}] * int(random.integers(2))
                results.append((len(stimulus), share * whole, missed, hits))
                ray = {"found": int(found), "found_mirror": quarters, "steps_store_ray": int(number < run_time)}
                stimulus.append({**idle, **ray, "steps_add_colour": 1})
                missed = missed or not found or quarters == 0
            if run_time < reflections:
                stimulus.append(idle)
    stimulus = [{name: value for name, value in cycle.items() if name in leaf.given} for cycle in stimulus]
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, share, missed, hits in results:
        assert outputs[cycle]["share"] == share, (hits, repeat())
        assert outputs[cycle]["missed"] == missed, (hits, repeat())


@pytest.mark.slow_sets("1", "8")
@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
def test_colour_sum(colour_bits, reflections, materials, tmp_path):
    """Of all shares that a pixel may have, or some of four reflections."""
    config = any_config(reflections=reflections, colour_bits=colour_bits, materials=materials)
    leaf = Leaf(
        colour_sum,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "seen": unsigned(CHANNEL_BITS),
            "share": unsigned(share_bits(config)),
            "blended": unsigned(colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0}
    one = 1 << (share_bits(config) - 1)
    stimulus, results = [], []
    for run_time in range(reflections + 1):
        for quarters in cases(random, run_time, list(range(5)) if materials else [2]):
            shares = plain_shares([(True, quarter) for quarter in quarters])
            for values in ([255] * len(shares), *random.integers(256, size=(8, len(shares))).tolist()):
                stimulus.append({**idle, "steps_reset_colour": 1})
                for share, value in zip(shares, values, strict=True):
                    stimulus += [{**idle, "seen": int(random.integers(256))}] * int(random.integers(2))
                    stimulus.append({**idle, "seen": value, "share": int(share * one), "steps_add_colour": 1})
                total = sum(share * value for share, value in zip(shares, values, strict=True))
                results.append((len(stimulus), int(total) >> (CHANNEL_BITS - colour_bits), (quarters, values)))
                stimulus.append(idle)
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, expected, case in results:
        assert outputs[cycle]["blended"] == expected, (case, repeat())


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
def test_colour_combiner(colour_bits, reflections, materials, tmp_path):
    config = any_config(colour_bits=colour_bits, reflections=reflections, materials=materials)
    leaf = Leaf(
        colour_combiner,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "found": bit(),
            "found_colour": unsigned(RGB_BITS),
            "found_mirror": unsigned(MIRROR_BITS) if materials else tied(0, MIRROR_BITS),
            "picture": Picture(),
            "missed": bit(),
            "pixel": Pixel(colour_bits),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, results = [], []
    for _ in range(200):
        run_time = int(random.integers(reflections + 1))
        palette = random.choice([0, 1, 255, 128, *random.integers(256, size=4)], (run_time + 2, 3)).astype(np.uint8)
        *words, background = (int.from_bytes(bytes(colour)) for colour in palette)
        held = {"picture_background": background, "steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
        stimulus.append({**held, "steps_reset_colour": 1})
        # After its end a ray goes on and may find something, which must not count.
        hits = mirrored(random, run_time) if materials else [(found, 2) for found, _ in mirrored(random, run_time)]
        for number, ((found, quarters), word) in enumerate(zip(hits, words, strict=True)):
            ray = {**held, "found": int(found), "found_colour": word}
            if materials:
                ray["found_mirror"] = quarters
            # Only what is found in the cycle of the addition counts.
            stimulus += [{**ray, "found": int(random.integers(2))}] * int(random.integers(2))
            stimulus.append({**ray, "steps_add_colour": 1, "steps_store_ray": int(number < run_time)})
            missed = any(not found or quarters == 0 for found, quarters in hits[: number + 1])
            if number < run_time or not materials:
                results.append((len(stimulus), None, missed, hits))
        seen = [palette[number] if found else palette[-1] for number, (found, _) in enumerate(hits)]
        pixel = sum(share * colour.astype(object) for share, colour in zip(plain_shares(hits), seen, strict=True))
        results.append((len(stimulus), [int(channel) for channel in pixel], None, hits))
        stimulus.append({**held, "found": int(random.integers(2))})
    stimulus = [{name: value for name, value in cycle.items() if name in leaf.given} for cycle in stimulus]
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, pixel, missed, hits in results:
        assert missed is None or outputs[cycle]["missed"] == missed, (hits, repeat())
        for name, channel in zip(("red", "green", "blue"), pixel or (), strict=pixel is not None):
            assert outputs[cycle][f"pixel_{name}"] == channel >> (CHANNEL_BITS - colour_bits), (hits, repeat())


@pytest.mark.parametrize("fraction_bits", [0, 1, 8])
def test_cell_parity(fraction_bits, tmp_path):
    """Of each coordinate at the borders of cells, and next to them."""
    config = any_config(fraction_bits=fraction_bits, patterns=True)
    leaf = Leaf(
        cell_parity,
        lambda: {
            "value": signed(position_bits(config) + 2), "size": unsigned(CELL_BITS), "odd": bit(), "config": config,
        },
        tmp_path,
    )  # fmt: skip
    one = 1 << fraction_bits
    values = {border * one + beside for border in range(0, WORLD_SIZE, 8) for beside in (-1, 0, 1, one // 2, 7 * one)}
    cases = [(value, size) for value in sorted(values) if value >= 0 for size in range(8)]
    outputs = leaf.run_both([{"value": value, "size": size} for value, size in cases])
    for (value, size), output in zip(cases, outputs, strict=True):
        assert output["odd"] == value // (one * (8 << size)) % 2, (value, size)
