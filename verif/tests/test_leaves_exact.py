# SPDX-License-Identifier: MIT
"""The exact engine's blocks: MyHDL's simulator, the converted Verilog and exact arithmetic on one set of vectors."""

from fractions import Fraction
from itertools import pairwise, product
from math import gcd

import numpy as np
import pytest
from fates import control_leaf, group_fate_in, mask_of, random_fate
from hard_scenes import cornered, facing, pixel_of, pixel_word, rivalled, sharpened, traced_scene, tracer, verdict

from raycaster.configuration import WORLD_SIZE, Configuration, ConfigurationError, configure
from raycaster.engines import EXACT
from raycaster.golden.random_world import EXTREMES, random_basis, random_camera, random_looks, random_rectangles
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.common.interfaces import Eye, Picture, Place, RayFate, Slope, Steps
from raycaster.rtl.common.records import (
    Look,
    Pixel,
    Point,
    Rect,
    Signs,
    Surface,
    camera_of,
    mirror_of,
    rect_of,
    surface_of,
)
from raycaster.rtl.common.ties import unconnected
from raycaster.rtl.common.widths import (
    RGB_BITS,
    bit,
    exact_slope_bits,
    eye_bits,
    index_bits,
    signed,
    unit_bits,
    unsigned,
)
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.engine.rect_sequencer import rect_sequencer
from raycaster.rtl.exact.cell_finder import cell_finder
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.exact.exact_unit import exact_unit
from raycaster.rtl.exact.extent_tester import extent_tester
from raycaster.rtl.exact.eye_register import eye_register
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.rtl.exact.slope_component import slope_component
from raycaster.rtl.exact.turned_generator import turned_generator
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.scene import PATTERNS
from raycaster.verif.leaf import EARLY_OUT_AT, Leaf, TraceCycle, ends_early, slot_length, sorted_rect, trace_cycles
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
LAST = WORLD_SIZE - 1
LATENCY = 3


def config_id(config: Configuration) -> str:
    return config.name


def exact_config(**options) -> Configuration:
    return configure(engine="exact", **{"allow_underrun": True} | options)


by_turn = pytest.mark.parametrize("turn", [False, True])
by_reflections = pytest.mark.parametrize("reflections", [0, 1, 2])


def two_complement(values, bits: int, prefix: str) -> dict[str, int]:
    return {f"{prefix}_{axis}": int(value) % (1 << bits) for axis, value in zip(AXES, values, strict=True)}


def slope_inputs(slope, which: str = "") -> dict[str, int]:
    inputs = {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
    return inputs | {f"{which}signs_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}


# The configuration ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "units", "cycles"),
    [
        ({"reflections": 0}, 4, 20),
        ({}, 4, 36),
        ({"reflections": 2}, 8, 52),
        ({"rectangles": 32}, 8, 76),
        ({"screen": "tiny"}, 4, 36),
        ({"units": 16}, 16, 36),
        ({"patterns": True}, 5, 48),
        ({"patterns": True, "reflections": 0}, 4, 26),
        ({"patterns": True, "reflections": 2}, 8, 70),
    ],
)
def test_as_few_units_as_meet_the_row_budget(options, units, cycles):
    config = configure(engine="exact", **options)
    assert (config.units, config.group_cycles) == (units, cycles)
    assert config.groups * config.group_cycles < config.screen_geometry.row_cycles


@pytest.mark.parametrize("reflections", [1, 2])
def test_a_room_that_does_not_mirror_takes_fewer_cycles(reflections):
    """As test_controls holds the control to these cycles: at most 60 % of those of a room of mirrors."""
    config = configure(engine="exact", reflections=reflections, materials=True)
    every = range(config.rectangles)
    matte, mirrors = (len(trace_cycles(config, every, reflections, lost=lost)) + 3 for lost in (0, None))
    assert mirrors == config.group_cycles
    assert matte == config.rectangles + config.pass_latency + reflections + EXACT.GROUP_OVERHEAD <= 0.6 * mirrors


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"fraction_bits": 4}, "^fraction_bits: the exact engine has none, not 4$"),
        ({"rounding": "nearest"}, "^rounding: the exact engine does not round; leave out nearest$"),
        ({"divider_bits": 2}, "^divider_bits: the exact engine has no divider; leave out 2$"),
        (
            {"units": 2},
            "^row budget: a group of 2 columns takes 36 cycles with 12 rectangles, 1 reflections and 1 cycles a",
        ),
        ({"reflections": 0, "units": 2}, "leaves it 19 .less than 3200 cycles over 160 groups.; take more units"),
    ],
)
def test_what_an_engine_without_quotients_has_not(options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        configure(engine="exact", **options)


# turned_generator -----------------------------------------------------------------------------------------------------


def basis_inputs(basis) -> dict[str, int]:
    inputs = {}
    for vector, components in zip(("forward", "right", "up"), basis, strict=True):
        inputs |= two_complement(components, 10, f"camera_{vector}")
    return inputs


def test_slope_component(tmp_path):
    config = exact_config(turn=True, units=8)
    screen = config.screen_geometry
    leaf = Leaf(
        slope_component,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            **{name: signed(10) for name in ("forward", "right", "up", "column", "row")},
            "column_base": unsigned(unit_bits(config)),
            "size": unsigned(exact_slope_bits(config)),
            "negative": bit(),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected, component = [], [], 0
    for _ in range(1000):
        forward, right, up = (int(value) for value in random_basis(random)[0])
        column = int(random.choice([0, screen.columns - config.units, random.integers(screen.columns)]))
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        given = {"column": column - screen.centre_column, "row": screen.horizon_row - row}
        given |= {"column_base": int(random.integers(config.units)), "forward": forward, "right": right, "up": up}
        load = int(not stimulus or random.random() < 0.8)
        for strobe in (0, load):
            stimulus.append({**given, "steps_screen_to_ray": strobe})
            expected.append(component)
        if load:
            across = given["column"] + given["column_base"]
            component = screen.view_distance * forward + across * right + given["row"] * up
    outputs = leaf.run_both([*stimulus, {"steps_screen_to_ray": 0}], settled=2)
    for cycle, wanted in enumerate([*expected, component]):
        if cycle >= 2:
            assert (outputs[cycle]["size"], outputs[cycle]["negative"]) == (abs(wanted), int(wanted < 0)), repeat()


@pytest.mark.parametrize(
    "config",
    [exact_config(turn=True, units=units, screen=screen) for units, screen in ((4, "vga"), (5, "vga"), (2, "tiny"))],
    ids=config_id,
)
def test_turned_generator(config, tmp_path):
    """Place and camera come a cycle before the ray is loaded; one that is not loaded changes nothing."""
    leaf = Leaf(
        turned_generator,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "place": Place(config),
            "column_base": unsigned(unit_bits(config)),
            "camera": camera_of(config),
            "initial_signs": Signs(),
            "slope": Slope(exact_slope_bits(config)),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    screen = config.screen_geometry
    stimulus, expected, slope = [], [], None
    for number in range(500):
        basis = random_basis(random)
        row = int(random.choice([0, screen.horizon_row, screen.rows - 1, random.integers(screen.rows)]))
        column = int(random.choice([0, screen.centre_column, screen.columns - 1, random.integers(screen.columns)]))
        load = int(number == 0 or random.random() < 0.8)
        held = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held |= basis_inputs(basis)
        for strobe in (0, load):
            stimulus.append({**held, "steps_screen_to_ray": strobe})
            expected.append(slope)
        if load:
            place = [screen.view_distance, column - screen.centre_column, screen.horizon_row - row]
            slope = np.array(place) @ np.array(basis)
    # The counters rest one past their last value; nothing there may overflow.
    stimulus.append({**held, "place_row": screen.rows, "place_column_offset": config.groups})
    expected.append(slope)
    outputs = leaf.run_both(stimulus, settled=2)
    for cycle, wanted in enumerate(expected):
        assert wanted is None or outputs[cycle] == slope_inputs(wanted, "initial_"), (stimulus[cycle - 1], repeat())


# extent_tester --------------------------------------------------------------------------------------------------------


@by_reflections
def test_extent_tester(reflections, tmp_path):
    """Where the ray is when it meets the plane, as a fraction: before, at and beyond the bounds and the mirror."""
    config = exact_config(reflections=reflections)
    eye_width, slope_bits = eye_bits(config), exact_slope_bits(config)
    leaf = Leaf(
        extent_tester,
        lambda: {
            "clk": bit(), "step": bit(), "low": unsigned(9), "high": unsigned(9), "eye": signed(eye_width),
            "back": bit(), "slope": unsigned(slope_bits), "on_mirror": bit(),
            "mirror_distance": unsigned(eye_width - 1), "n": unsigned(eye_width - 1), "e": unsigned(slope_bits),
            "ahead": bit(), "between": bit(), "in_mirror": bit(),
        },
        tmp_path,
    )  # fmt: skip
    random = np.random.default_rng(seed())
    far, steepest = LAST * (reflections + 1), (1 << slope_bits) - 1
    stimulus, aheads, expected, late = [], {}, {}, {}
    for cycle in range(6000):
        low, high = sorted(int(random.choice([0, 1, LAST, random.integers(WORLD_SIZE)])) for _ in range(2))
        eye = int(random.choice([0, LAST, far, far - LAST, LAST - far, random.integers(LAST - far, far + 1)]))
        eye = int(np.clip(eye, LAST - far, far))
        back, on_mirror = (int(value) for value in random.integers(2, size=2))
        slope, e = (int(random.choice([1, 2, steepest, random.integers(1, steepest + 1)])) for _ in range(2))
        near, beyond = (eye - high, eye - low) if back else (low - eye, high - eye)
        mirror = max(0, int(random.choice([near, near - 1, near + 1, beyond, beyond + 1, random.integers(far + 1)])))
        # Near one of the places that count, where a product can get there.
        goal = int(random.choice([near, beyond, mirror, random.integers(far + 1)]))
        n = goal * e // slope + int(random.integers(-1, 2))
        if goal * e % slope and random.random() < 0.5:
            e, n = slope, goal
        n = int(np.clip(n, 1, (1 << eye_width - 1) - 1))
        step = int(cycle == 0 or random.random() < 0.9)
        stimulus.append(late | {
            "step": step, "low": low, "high": high, "eye": eye % (1 << eye_width), "back": back, "slope": slope,
            "on_mirror": on_mirror,
        })  # fmt: skip
        late = {"mirror_distance": min(mirror, (1 << eye_width - 1) - 1), "n": n, "e": e}
        aheads[cycle] = beyond >= 0
        if step and beyond >= 0:
            at, mirror = Fraction(slope * n, e), late["mirror_distance"]
            behind_mirror = on_mirror and near <= mirror and at < mirror
            expected[cycle + 2] = near <= at <= beyond and not behind_mirror, bool(on_mirror and near <= mirror == at)
    outputs = leaf.run_both([*stimulus, late, {}], settled=2)
    assert {value for pair in expected.values() for value in pair} == {False, True}
    for cycle, ahead in aheads.items():
        assert bool(outputs[cycle]["ahead"]) == ahead or cycle < 2, (cycle, repeat())
    for cycle, wanted in expected.items():
        assert tuple(bool(outputs[cycle][name]) for name in ("between", "in_mirror")) == wanted, (
            stimulus[cycle - 2 : cycle], repeat()
        )  # fmt: skip


# rect_tester ----------------------------------------------------------------------------------------------------------


def leaf_of_tester(config: Configuration, directory) -> Leaf:
    return Leaf(
        rect_tester,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "rect": Rect(),
            "eye": Eye(eye_bits(config)),
            "signs": Signs(),
            "slope": Slope(exact_slope_bits(config)),
            "mirror": mirror_of(config),
            "hit": bit(),
            "at_mirror": bit(),
            "numerator": unsigned(eye_bits(config) - 1),
            "denominator": unsigned(exact_slope_bits(config)),
        },
        directory,
    )


def mirror_time(eye, slope, mirror) -> Fraction:
    """t of the mirror that the ray left last."""
    axis, position = mirror
    return Fraction(int(position - eye[axis]), int(slope[axis]))


def mirrored_rays(random: np.random.Generator, config: Configuration, count: int):
    """Tables, rectangles of them to look at, eyes, slopes and mirrors: as the engine meets them, and as extreme as its
    widths allow."""
    reflections, steepest = config.reflections, (1 << exact_slope_bits(config)) - 1
    while count > 0:
        table = random_rectangles(random, count=8, closed=True)
        eye = random_camera(random, table).astype(np.int64)
        steep = random.choice([0, 1, 2, 99, 100, 160, 190, steepest, int(random.integers(steepest))], 3)
        # Equal slopes lead to points with whole coordinates.
        slope = (steep if random.random() < 0.6 else steep[[0, 0, 0]]) * random.choice([-1, 1], 3)
        mirror = None
        for _ in range(int(random.integers(reflections + 1))):
            axis = int(random.integers(3))
            slope[axis] = slope[axis] or 1
            plane = int(random.choice([random.choice(EXTREMES), random.integers(WORLD_SIZE)]))
            if mirror is not None and random.random() < 0.5:
                # From corner to corner the image runs as far away as it can.
                axis, plane = mirror[0], LAST - mirror[1]
            if plane != eye[axis]:
                # A mirror is ahead of the eye, whichever image it is.
                slope[axis] = abs(slope[axis]) * (1 if eye[axis] < plane else -1)
                eye[axis], slope[axis], mirror = 2 * plane - eye[axis], -slope[axis], (axis, plane)
        chosen = random.choice(np.flatnonzero(table.visible), 4)
        for index in chosen:
            table = sharpened(random, table, int(index), eye, slope, mirror)
        count -= 1
        yield table, set(chosen.tolist()), eye, slope, mirror


@by_turn
@by_reflections
def test_rect_tester(reflections, turn, tmp_path):
    """The hit and its t; after two mirrors in one point, what is hit in that point, and that it was there."""
    config = exact_config(reflections=reflections, turn=turn)
    leaf = leaf_of_tester(config, tmp_path)
    random = np.random.default_rng(seed())
    stimulus, expected, distance = [], [], 0
    for table, chosen, eye, slope, mirror in mirrored_rays(random, config, 1500):
        met = {mirror[0]} if mirror else set()
        if mirror and reflections > 1 and random.random() < 0.5:
            met |= set(random.choice(3, int(random.integers(3))).tolist())
        mask = {f"mirror_met_{axis}": int(place in met) for place, axis in enumerate(AXES)}
        for index in chosen:
            started = int(not stimulus or random.random() < 0.9)
            stimulus.append(
                {
                    **sorted_rect(table, index, "rect"), **two_complement(eye, eye_bits(config), "eye"),
                    **{name: value for name, value in mask.items() if name in leaf.given},
                    **slope_inputs(slope), "mirror_active": int(mirror is not None),
                    "mirror_axis": mirror[0] if mirror else int(random.integers(3)),
                    "mirror_distance": distance, "steps_find_intersection": started,
                }
            )  # fmt: skip
            # It is read a cycle after all else.
            distance = abs(int(mirror[1] - eye[mirror[0]])) if mirror else int(random.integers(WORLD_SIZE))
            hit, n, e = verdict(table, index, eye, slope, mirror, met)
            meets = hit and mirror is not None and Fraction(n, e) == mirror_time(eye, slope, mirror)
            expected.append((hit, n, e, meets) if started else None)
    seen, corners = set(), set()
    stimulus += [{"mirror_distance": distance, "steps_find_intersection": 0}] * LATENCY
    outputs = leaf.run_both(stimulus, settled=LATENCY)
    for cycle, wanted in enumerate(expected):
        if wanted is None:
            continue
        output = outputs[cycle + LATENCY]
        assert bool(output["hit"]) == wanted[0], (stimulus[cycle], repeat())
        if wanted[0]:
            assert (output["numerator"], output["denominator"]) == wanted[1:3], (stimulus[cycle], repeat())
            assert bool(output["at_mirror"]) == wanted[3], (stimulus[cycle], repeat())
        corners.add(wanted[3])
        seen.add((wanted[0], stimulus[cycle]["rect_axis"], stimulus[cycle]["mirror_active"]))
    assert len(seen) == (12 if reflections else 6), "hits and misses on each axis, with a mirror and without"
    assert corners == {False, reflections > 0}, "hits in the mirror's plane and beyond it"


@by_turn
@by_reflections
def test_the_widths_are_just_wide_enough(reflections, turn, tmp_path):
    """The furthest image of a camera, its greatest products, and a bit that each of them needs."""
    config = exact_config(reflections=reflections, turn=turn)
    far = LAST * (reflections + 1)
    assert eye_bits(config) == far.bit_length() + 1
    greatest = far * (450 * 512 if turn else 190)
    assert greatest.bit_length() == (27, 28, 29)[reflections] if turn else (17, 18, 19)[reflections]
    leaf = leaf_of_tester(config, tmp_path)
    steepest = (1 << exact_slope_bits(config)) - 1
    corners = np.array([[[0, 0, 0], [0, LAST, LAST]], [[0, 0, 0], [LAST, 0, LAST]], [[0, 0, LAST], [LAST, LAST, LAST]]])
    table = Rectangles(corners, np.zeros((3, 3), dtype=np.uint8), np.ones(3, dtype=bool))
    stimulus, expected = [], []
    for place in (far, -LAST * reflections):
        for other in (far, -LAST * reflections, 0):
            for sign in (1, -1):
                for axis in range(3):
                    eye = [other] * 3
                    eye[axis] = place
                    slope = [sign * steepest] * 3
                    slope[axis] = -steepest if place > 0 else steepest
                    for index in range(3):
                        rect = sorted_rect(table, index, "rect")
                        eyes = two_complement(eye, eye_bits(config), "eye")
                        stimulus.append({**rect, **eyes, **slope_inputs(slope), "steps_find_intersection": 1})
                        expected.append(verdict(table, index, eye, slope, None))
    outputs = leaf.run_both([*stimulus, *[{}] * LATENCY], settled=LATENCY)
    for cycle, wanted in enumerate(expected):
        assert bool(outputs[cycle + LATENCY]["hit"]) == wanted[0], stimulus[cycle]
        if wanted[0]:
            assert (outputs[cycle + LATENCY]["numerator"], outputs[cycle + LATENCY]["denominator"]) == wanted[1:]
    assert any(wanted[0] for wanted in expected)


# nearest_hit ----------------------------------------------------------------------------------------------------------


@by_turn
@by_reflections
def test_nearest_hit(reflections, turn, tmp_path):
    config = exact_config(reflections=reflections, turn=turn)
    numerator_bits, denominator_bits = eye_bits(config) - 1, exact_slope_bits(config)
    leaf = Leaf(
        nearest_hit,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "offered": Surface(),
            "hit": bit(),
            "at_mirror": bit(),
            "numerator": unsigned(numerator_bits),
            "denominator": unsigned(denominator_bits),
            "found": bit(),
            "found_surface": Surface(),
            "found_distance": unsigned(numerator_bits),
            "found_slope": unsigned(denominator_bits),
            "found_at_mirror": bit(),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [{"steps_reset_z_buf": 1}], [None]
    best, surface, settled = None, None, None
    for _ in range(12000):
        reset, write, hit = (int(random.random() < chance) for chance in (0.1, 0.8, 0.6))
        factor = int(random.integers(1, 4))
        n, e = (
            int(random.choice([1, 2, 3, 100, random.integers(1, 1 << bits - 2), (1 << bits) - 1]))
            for bits in (numerator_bits, denominator_bits)
        )
        if best is not None and random.random() < 0.6:
            # As near as the nearest, by other numbers.
            n, e = best.numerator * factor, best.denominator * factor
            if n >= 1 << numerator_bits or e >= 1 << denominator_bits:
                n, e = best.numerator, best.denominator
            if random.random() < 0.5:
                # Next to it, over another denominator.
                e = int(random.integers(1, 1 << denominator_bits))
                n = int(best * e)
            n = min(max(n + int(random.integers(-1, 2)), 1), (1 << numerator_bits) - 1)
        offered = {
            "axis": int(random.integers(3)),
            "position": int(random.integers(512)),
            "colour": int(random.integers(1 << 24)),
        }
        stimulus.append(
            {
                "steps_reset_z_buf": reset, "steps_write_z_buf": write, "hit": hit, "numerator": n, "denominator": e,
                **{f"offered_{name}": value for name, value in offered.items()},
                "at_mirror": int(random.integers(2)),
            }
        )  # fmt: skip
        expected.append((best is not None, surface))
        if reset:
            best = None
        elif write and hit and (best is None or Fraction(n, e) < best):
            best = Fraction(n, e)
            surface = {f"surface_{name}": value for name, value in offered.items()}
            surface |= {"distance": n, "slope": e} | {
                name: value for name, value in stimulus[-1].items() if name == "at_mirror"
            }
            settled = settled or len(stimulus)
    outputs = leaf.run_both(stimulus, settled=settled)
    for cycle, wanted in enumerate(expected):
        if wanted is not None:
            assert bool(outputs[cycle]["found"]) == wanted[0], (cycle, repeat())
            if wanted[0]:
                assert {name: outputs[cycle][f"found_{name}"] for name in wanted[1]} == wanted[1], repeat()


# eye_register ---------------------------------------------------------------------------------------------------------


@by_reflections
def test_eye_register(reflections, tmp_path):
    config = exact_config(reflections=reflections)
    leaf = Leaf(
        eye_register,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "camera": Point(),
            "initial_signs": Signs(),
            "found_surface": Surface(),
            "found_distance": unsigned(eye_bits(config) - 1),
            "found_at_mirror": bit() if reflections > 1 else unconnected(1),
            "eye": Eye(eye_bits(config)),
            "signs": Signs(),
            "mirror": mirror_of(config),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [{"steps_screen_to_ray": 1}, {"steps_screen_to_ray": 0, "steps_store_ray": 1}], [None, None]
    for _ in range(400):
        camera = random.choice([0, LAST, int(random.integers(WORLD_SIZE))], 3)
        initial = random.integers(2, size=3)
        sight = {f"initial_signs_d{axis}": int(value) for axis, value in zip(AXES, initial, strict=True)}
        stimulus.append({**two_complement(camera, 9, "camera"), "steps_screen_to_ray": 1, "steps_store_ray": 0})
        expected.append(None)
        eye, signs, mirror = [int(value) for value in camera], [bool(value) for value in initial], None
        met, distance = set(), 0
        for bounce in range(reflections + 1):
            for _ in range(int(random.integers(1, 3))):
                axis, plane = int(random.integers(3)), int(random.choice([0, LAST, random.integers(WORLD_SIZE)]))
                if mirror is not None and random.random() < 0.5:
                    # From corner to corner the image runs as far away as it can.
                    axis, plane = mirror[0], LAST - mirror[1]
                surface = {"found_surface_axis": axis, "found_surface_position": plane}
                surface |= {"found_distance": abs(plane - eye[axis])}
                noise = two_complement(random.integers(WORLD_SIZE, size=3), 9, "camera")
                stimulus.append({**noise, **sight, **surface, "steps_screen_to_ray": 0, "steps_store_ray": 0})
                if reflections > 1:
                    stimulus[-1]["found_at_mirror"] = int(random.integers(2))
                expected.append((list(eye), list(signs), mirror and (mirror[0], distance), set(met)))
            if bounce < reflections:
                stimulus[-1]["steps_store_ray"] = 1
                eye[axis], signs[axis], mirror = 2 * plane - eye[axis], not signs[axis], (axis, plane)
                distance = abs(plane - eye[axis])
                met = met | {axis} if stimulus[-1].get("found_at_mirror") else {axis}
    outputs = leaf.run_both(stimulus, settled=2)
    bits = eye_bits(config)
    for cycle, wanted in enumerate(expected):
        if wanted is None:
            continue
        eye, signs, mirror, met = wanted
        output = outputs[cycle]
        assert {name: output[name] for name in two_complement(eye, bits, "eye")} == two_complement(eye, bits, "eye")
        assert [bool(output[f"signs_d{axis}"]) for axis in AXES] == signs, repeat()
        assert bool(output["mirror_active"]) == (mirror is not None), repeat()
        if mirror is not None:
            assert (output["mirror_axis"], output["mirror_distance"]) == mirror, repeat()
        if reflections > 1:
            assert {place for place, axis in enumerate(AXES) if output[f"mirror_met_{axis}"]} == met, repeat()


# rect_sequencer, ray_sequencer, exact_control -------------------------------------------------------------------------


@pytest.mark.parametrize("slot_cycles", [1, 3, 9])
@pytest.mark.parametrize("count", [1, 5, 12])
def test_rect_sequencer(count, slot_cycles, tmp_path):
    config = exact_config(rectangles=count)
    leaf = Leaf(
        rect_sequencer,
        lambda: {
            "clk": bit(),
            "reset_ray_caster": bit(),
            "start_ray": bit(),
            "wanted": unsigned(count),
            "early_out": bit(),
            "index": unsigned(index_bits(config)),
            "fetch": bit(),
            "fetched": bit(),
            "starting": bit(),
            "slot_cycles": slot_cycles,
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []

    def drive(reset, start, mask, current=None, first=False, early_out=0):
        """A cycle in which `current` is at hand."""
        stimulus.append({"reset_ray_caster": reset, "start_ray": start, "wanted": mask, "early_out": early_out})
        expected.append((current, first))

    every = (1 << count) - 1
    for number in range(60):
        mask = every if number % 7 == 0 else int(random.integers(1 << count)) & int(random.integers(1 << count))
        if number % 3 == 1:
            mask = 1 << number // 3 % count
        if number % 5 == 0:
            drive(1, 0, mask)
        for _ in range(int(random.integers(1, 3))):
            drive(0, 0, mask)
        drive(0, 1, mask)
        slots = []
        for index in range(count):
            if mask >> index & 1:
                # Some end early, in any cycle of their slot.
                last = int(random.integers(slot_cycles)) if random.random() < 0.3 else slot_cycles - 1
                ends = last < slot_cycles - 1
                slots += [(index, cycle == 0, int(ends and cycle == last)) for cycle in range(last + 1)]
        # Only a reset comes before the end.
        for current, first, early_out in slots[: int(random.integers(len(slots) + 1))] if number % 5 == 4 else slots:
            drive(0, 0, mask, current, first, early_out)
        if number % 5 != 4:
            drive(0, 0, mask)
    outputs = leaf.run_both(stimulus, settled=4)
    held_by_memory = None
    for cycle, (output, (current, first)) in enumerate(zip(outputs, expected, strict=True)):
        if cycle >= 4 and not stimulus[cycle]["reset_ray_caster"]:
            assert (bool(output["fetched"]), bool(output["starting"])) == (current is not None, first), (
                cycle,
                repeat(),
            )
            assert current is None or held_by_memory == current, (cycle, repeat())
        if output["fetch"]:
            held_by_memory = output["index"]


def seed_config(**options) -> Configuration:
    return configure(allow_underrun=True, **options)


@pytest.mark.parametrize(
    ("function", "config"),
    [
        *(
            (exact_control, exact_config(rectangles=n, reflections=r))
            for n, r in ((1, 0), (1, 2), (3, 2), (12, 2), (32, 0))
        ),
        (exact_control, exact_config(rectangles=5, reflections=2, patterns=True)),
        (exact_control, exact_config(rectangles=2, reflections=2, materials=True)),
        *((ray_sequencer, exact_config(rectangles=n, reflections=r)) for n, r in ((2, 1), (12, 2))),
        *(
            (ray_sequencer, seed_config(rectangles=n, reflections=2, divider_bits=b))
            for n, b in ((3, 3), (12, 3), (5, 1))
        ),
    ],
    ids=lambda value: value.name if isinstance(value, Configuration) else value.__name__,
)
def test_controls(function, config, tmp_path):
    write_at = 2 if config.engine == "exact" else slot_length(config) + 3
    leaf = control_leaf(function, config, tmp_path)
    random = np.random.default_rng(seed())
    count = config.rectangles
    every = (1 << count) - 1
    masks = [every, 0, 1, 1 << (count - 1), every]
    masks += [int(random.integers(1 << count)) & int(random.integers(1 << count)) for _ in range(24)]
    masks += [1 << index for index in range(count)] + [1 | 1 << index for index in range(count)]
    table = Rectangles(
        random.integers(WORLD_SIZE, size=(count, 2, 3)),
        random.integers(256, size=(count, 3)).astype(np.uint8),
        np.ones(count, dtype=bool),
    )
    flat = random.integers(3, size=count)
    table.corners[np.arange(count), 1, flat] = table.corners[np.arange(count), 0, flat]
    table = random_looks(random, table)
    quiet = {name: 0 for name in leaf.outputs if name.startswith("steps_") and name != "steps_initial_ray"}
    quiet["done"] = 0
    quiet_cycle = TraceCycle({}, 0)
    stimulus, expected = [], []

    def drive(inputs, wanted=None, current=None, offered=None):
        rect = sorted_rect(table, int(random.integers(count)) if current is None else current, "rects_rect", config)
        stimulus.append({**inputs, **{name: value for name, value in rect.items() if name in leaf.given}})
        expected.append((wanted, current, offered))

    for number, mask in enumerate(masks):
        usable = [index for index in range(count) if mask >> index & 1]
        reflections = config.reflections if number < 2 else int(random.integers(config.reflections + 1))
        held = {"rects_usable": mask, "picture_reflections": reflections}
        fate = random_fate(random, usable, reflections, number)
        # What is not usable is not visited, whatever the mask has for it.
        held["fate_may_hit"] = mask_of(fate["may_hit"]) | int(random.integers(1 << count)) & ~mask
        for _ in range(2):
            drive({**held, "reset_ray_caster": 1, "enable": int(random.integers(2))})
        for _ in range(int(random.integers(3))):
            drive({**held, "reset_ray_caster": 0, "enable": 0}, quiet)
        drive({**held, "reset_ray_caster": 0, "enable": 1}, quiet)
        trace = trace_cycles(config, usable, reflections, **fate)
        if number == 0:
            assert len(trace) + 3 == config.group_cycles, "with done and the reset of two cycles"
        # A row may be abandoned at any moment; what was under way must not come out later.
        abandoned = number > 4 and number % 2
        for before, cycle in pairwise([quiet_cycle, *trace][: int(random.integers(len(trace))) if abandoned else None]):
            wanted = {name: value for name, value in cycle.steps.items() if name in leaf.outputs} | {"done": 0}
            if cycle.steps["steps_screen_to_ray"]:
                del wanted["steps_initial_ray"]
            inputs = {**held, "reset_ray_caster": 0, "enable": int(random.integers(2))}
            inputs |= (
                {"early_out": int(ends_early(config) and before.towards == 0)} if function is ray_sequencer else {}
            )
            drive(inputs | group_fate_in(random, cycle, leaf), wanted, cycle.current, cycle.offered)
        if not abandoned:
            for _ in range(int(random.integers(1, 4))):
                # Nothing is rendered any more, so that reflections may change.
                after = {"picture_reflections": int(random.integers(config.reflections + 1))}
                after |= {"reset_ray_caster": 0, "enable": int(random.integers(2))}
                drive({**held, **after}, {**quiet, "done": 1})

    settled = next(cycle for cycle, (_, _, offered) in enumerate(expected) if offered is not None)
    outputs = leaf.run_both(stimulus, settled=settled)
    held_by_memory = None
    for cycle, (output, (wanted, current, offered)) in enumerate(zip(outputs, expected, strict=True)):
        if wanted is not None:
            assert {name: output[name] for name in wanted} == wanted, (cycle, repeat())
        if current is not None:
            assert held_by_memory == current, f"cycle {cycle}: it fetched another rectangle; {repeat()}"
        if function is ray_sequencer and wanted is not None:
            # Bit i follows find_intersection by i + 1 cycles, unless a reset came between.
            started = [
                outputs[before]["steps_find_intersection"] for before in range(cycle - 1, cycle - write_at - 2, -1)
            ]
            resets = [stimulus[before]["reset_ray_caster"] for before in range(cycle - 1, cycle - write_at - 2, -1)]
            alive = started[: resets.index(1)] if 1 in resets else started
            # What ended early is not in flight from the next cycle on.
            for place in range(EARLY_OUT_AT, len(alive)):
                alive[place] &= not stimulus[cycle - 1 - place + EARLY_OUT_AT].get("early_out", 0)
            assert output["in_flight"] == sum(bit << place for place, bit in enumerate(alive)), (cycle, repeat())
        elif offered is not None:
            rect = sorted_rect(table, offered, "offered", config)
            surface = {name: value for name, value in rect.items() if name in output}
            assert {name: output[name] for name in surface} == surface, (cycle, repeat())
        if output["rects_fetch"]:
            held_by_memory = output["rects_index"]


@pytest.mark.parametrize(
    ("function", "config"),
    [
        (ray_control, seed_config(rectangles=5, reflections=2, divider_bits=1)),
        (exact_control, exact_config(rectangles=5, reflections=2, culling=True)),
    ],
    ids=lambda value: value.name if isinstance(value, Configuration) else value.__name__,
)
def test_fate_is_read_in_one_cycle(function, config, tmp_path):
    """What the units say holds in the cycle that ray_sequencer states, and is the opposite in the cycles beside it.

    So a register more between the units and what the control does with it, or one less, is found.
    """
    leaf = control_leaf(function, config, tmp_path)
    random = np.random.default_rng(seed())
    usable, reflections = list(range(config.rectangles)), config.reflections
    held = {"rects_usable": mask_of(usable), "fate_may_hit": mask_of(usable), "picture_reflections": reflections}
    stimulus, expected = [], []
    for lost in (None, 0, 1, None):
        behind = [(bounce, index) for bounce in range(reflections + 1) for index in usable if random.random() < 0.5]
        trace = trace_cycles(config, usable, reflections, behind=behind, lost=lost)
        stimulus += [{**held, "reset_ray_caster": 1, "enable": 0}, {**held, "reset_ray_caster": 0, "enable": 1}]
        # In the first cycle initial_ray is don't care.
        expected += [None, None, None, *(cycle.steps | {"done": 0} for cycle in trace[1:]), {"done": 1}]
        said = {
            "fate_any_towards": opposite_beside([cycle.towards for cycle in trace]),
            "fate_any_alive": opposite_beside([cycle.alive for cycle in trace]),
        }
        cycles = [dict(zip(said, values, strict=True)) for values in zip(*said.values(), strict=True)]
        stimulus += [{name: value for name, value in cycle.items() if name in leaf.inputs} for cycle in [*cycles, {}]]
    outputs = leaf.run_both(stimulus, settled=len(trace))
    for cycle, wanted in enumerate(expected):
        if wanted is not None:
            assert {name: outputs[cycle][name] for name in wanted} == wanted, (cycle, repeat())


def opposite_beside(values: list[int | None]) -> list[int]:
    """Bits, and where there is none the opposite of one that is there in the cycle before or after."""
    padded = [None, *values, None]
    return [
        value if value is not None else 1 - next((one for one in (before, after) if one is not None), 1)
        for before, value, after in zip(padded, values, padded[2:], strict=False)
    ]


# cell_finder ----------------------------------------------------------------------------------------------------------


@by_turn
@by_reflections
def test_cell_finder(reflections, turn, tmp_path):
    """The cells of points by fractions; of each size, and on the cells' borders."""
    config = exact_config(reflections=reflections, turn=turn, patterns=True)
    leaf = Leaf(
        cell_finder,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "eye": Eye(eye_bits(config)),
            "signs": Signs(),
            "slope": Slope(exact_slope_bits(config)),
            "found_surface": surface_of(config),
            "found_distance": unsigned(eye_bits(config) - 1),
            "found_slope": unsigned(exact_slope_bits(config)),
            "odd_u": bit(),
            "odd_v": bit(),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected, borders = [], [], 0
    far, steepest = LAST * (reflections + 1), (1 << exact_slope_bits(config)) - 1
    while len(expected) < 300:
        axis, size = int(random.integers(3)), int(random.integers(8))
        n = int(random.choice([1, 8, far, random.integers(1, far + 1)]))
        e = int(random.choice([1, 2, min(n, steepest), steepest, random.integers(1, steepest + 1)]))
        eye, slope = random.integers(WORLD_SIZE, size=3), random.integers(-steepest, steepest + 1, 3)
        for q in OTHER_AXES[axis]:
            # A whole point on the border of a cell or elsewhere, and slopes that miss it by as little as they can.
            place = int(random.choice([8 * random.integers(64), random.integers(WORLD_SIZE)]))
            times = int(random.integers(-4, 5))
            slope[q] = times * (e // gcd(n, e)) + int(random.choice([-1, 0, 0, 1]))
            eye[q] = place - times * (n // gcd(n, e))
        point = [int(eye[q]) + Fraction(int(slope[q]) * n, e) for q in OTHER_AXES[axis]]
        if not all(0 <= place <= LAST for place in point) or abs(slope).max() > steepest:
            continue
        if eye.min() < -LAST * reflections or eye.max() > far:
            continue
        cells = [place / (8 << size) for place in point]
        borders += any(cell.denominator == 1 for cell in cells)
        held = {"found_surface_axis": axis, "found_surface_cell": size, "found_distance": n, "found_slope": e}
        held |= {**two_complement(eye, eye_bits(config), "eye"), **slope_inputs(slope)}
        for cycle in range(7):
            stimulus.append({**held, "steps_load_divider": int(cycle == 0), "steps_store_quotient": int(cycle == 3)})
        expected.append((len(stimulus) - 1, [int(cell) % 2 for cell in cells]))
    outputs = leaf.run_both(stimulus, settled=6)
    for cycle, odd in expected:
        assert [outputs[cycle]["odd_u"], outputs[cycle]["odd_v"]] == odd, (stimulus[cycle], repeat())
    assert borders > 30, repeat()


# pattern_colour -----------------------------------------------------------------------------------------------------


def test_pattern_colour(tmp_path):
    """Each pattern in each kind of cell; two colours that no bit has in common, and random ones."""
    leaf = Leaf(
        pattern_colour,
        lambda: {
            "look": Look(materials=True, patterns=True),
            "odd_u": bit(),
            "odd_v": bit(),
            "colour": unsigned(RGB_BITS),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    for kind, odd_u, odd_v in product(range(len(PATTERNS)), range(2), range(2)):
        second = (0, (odd_u + odd_v) % 2, odd_v, odd_u)[kind]
        for colours in ((0, (1 << RGB_BITS) - 1), ((1 << RGB_BITS) - 1, 0), random.integers(1 << RGB_BITS, size=2)):
            look = {"kind": kind, "colour": int(colours[0]), "colour_2": int(colours[1])}
            look |= {"mirror": int(random.integers(5)), "cell": int(random.integers(8))}
            stimulus.append({**{f"look_{name}": one for name, one in look.items()}, "odd_u": odd_u, "odd_v": odd_v})
            expected.append(int(colours[second]))
    outputs = leaf.run_both(stimulus)
    assert [output["colour"] for output in outputs] == expected, repeat()


# exact_unit ---------------------------------------------------------------------------------------------------------


def held_inputs(camera, background, reflections) -> dict[str, int]:
    colour = int.from_bytes(bytes(background.astype(np.uint8)))
    return {**two_complement(camera, 9, "camera"), "picture_background": colour, "picture_reflections": reflections}


@pytest.mark.slow_sets("exact-vga240-u1-", "exact-vga240-u5")
@pytest.mark.parametrize(
    "config",
    [
        exact_config(screen=screen, units=units, rectangles=rectangles, reflections=reflections, colour_bits=bits)
        for screen, units, rectangles, reflections, bits in (
            ("vga", 4, 8, 1, 8), ("vga", 5, 8, 2, 8), ("tiny", 2, 8, 0, 1), ("vga", 320, 8, 2, 4), ("vga", 1, 4, 2, 8),
            ("vga", 8, 8, 4, 8),
        )
    ]
    + [exact_config(units=8, rectangles=8, reflections=2, culling=True)]
    + [
        exact_config(units=units, rectangles=8, reflections=reflections, **dict.fromkeys(switches, True))
        for units, reflections, *switches in (
            (4, 1, "turn"), (8, 2, "turn"), (5, 1, "patterns"), (8, 2, "materials"),
            (5, 2, "turn", "materials", "patterns"), (8, 4, "turn", "materials", "patterns"),
            (4, 0, "turn", "materials", "patterns"),
        )
    ],
    ids=config_id,
)  # fmt: skip
def test_exact_unit(config, tmp_path):
    leaf = Leaf(
        exact_unit,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "place": Place(config),
            "column_base": unsigned(unit_bits(config)),
            "camera": camera_of(config),
            "rect": rect_of(config),
            "offered": surface_of(config),
            "picture": Picture(),
            "pixel": Pixel(config.colour_bits),
            "fate": RayFate(),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    slopes = primary_slopes(config.screen_geometry)
    rows, columns, _ = slopes.shape
    stimulus, results, fates, alive = [], [], set(), {}
    ends = config.culling or config.materials
    for _ in range(500 if config == exact_config(units=5, rectangles=8, reflections=2) else 80):
        basis = random_basis(random) if config.turn else None
        if basis is not None:
            slopes = primary_slopes(config.screen_geometry, basis)
        row = int(random.choice([0, 1, config.screen_geometry.horizon_row, rows - 1, random.integers(rows)]))
        column = int(random.choice([0, 1, columns // 2, columns - 1, random.integers(columns)]))
        hard = random.choice(["none", "rivalled", "cornered", "facing"], p=[0.3, 0.3, 0.3, 0.1])
        if hard == "facing":
            # A ray along x, so that it does not leave the world between the walls.
            row, column = (
                min(max(middle + int(random.integers(-20, 21)), 0), count - 1)
                for middle, count in ((config.screen_geometry.horizon_row, rows), (columns // 2, columns))
            )
        slope = slopes[row, column][None]
        camera, table, background, reflections, traced = traced_scene(random, config, slope)
        if hard != "none":
            if hard == "rivalled":
                table = rivalled(random, table, int(traced.winners[0][0]), camera, slope[0])
            elif hard == "cornered":
                table = cornered(random, table, camera, slope[0])
            else:
                table = facing(random, table, camera, slope[0])
            given = {"camera": camera, "background": background, "slopes": slope, "reflections": reflections}
            traced = tracer(config, **given)(table)
        fates.add((reflections, sum(int(winner[0]) >= 0 for winner in traced.winners)))
        place = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held = {**held_inputs(camera, background, reflections), **place}
        if basis is not None:
            held |= basis_inputs(basis)
        held = {name: value for name, value in held.items() if name in leaf.given}
        usable = [int(index) for index in np.flatnonzero(table.visible)]
        if not usable:
            continue
        endings = [
            bounce
            for bounce, winner in enumerate(traced.winners)
            if winner[0] < 0 or (config.materials and table.mirrors[winner[0]] == 0)
        ]
        lost = min(endings, default=None) if ends else None
        cycles = trace_cycles(config, usable, reflections, lost=lost)
        # The place stands before the ray is loaded.
        stimulus.append({**held, **{name: 0 for name in cycles[0].steps if name in leaf.given}})
        for cycle in cycles:
            if cycle.alive is not None and ends:
                alive[len(stimulus)] = cycle.alive
            other = int(random.choice(usable))
            inputs = {**held, **cycle.steps}
            inputs |= sorted_rect(table, other if cycle.current is None else cycle.current, "rect", config)
            inputs |= sorted_rect(table, other if cycle.offered is None else cycle.offered, "offered", config)
            stimulus.append({name: value for name, value in inputs.items() if name in leaf.given})
        case = f"row {row}, column {column}, camera {camera}, corners {table.corners.tolist()}; {repeat()}"
        results.append((len(stimulus), pixel_word(config, traced.colours[0]), case))
        stimulus.append({**held, **{name: 0 for name in cycle.steps if name in leaf.given}})
    assert len(fates) >= 2 + 2 * config.reflections, repeat()
    outputs = leaf.run_both(stimulus, settled=results[0][0])
    for cycle, pixel, case in results:
        assert pixel_of(config, outputs[cycle]) == pixel, case
    for cycle, expected in alive.items():
        assert outputs[cycle]["fate_alive"] == expected, (cycle, repeat())
    assert not ends or set(alive.values()) == {0, 1}
