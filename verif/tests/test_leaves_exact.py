# SPDX-License-Identifier: MIT
"""The exact engine's blocks: MyHDL's simulator, the converted Verilog and exact arithmetic on one set of vectors."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from fates import control_leaf, group_fate_in, mask_of, random_fate
from hard_scenes import pixel_of, pixel_word, rivalled, sharpened, traced_scene, tracer, verdict

from raycaster.configuration import WORLD_SIZE, Configuration, ConfigurationError, configure
from raycaster.golden.random_world import EXTREMES, random_camera, random_rectangles
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.rtl.common.interfaces import Eye, Picture, Place, RayFate, Slope, Steps
from raycaster.rtl.common.records import Mirror, Pixel, Point, Rect, Signs, Surface
from raycaster.rtl.common.widths import (
    bit,
    exact_slope_bits,
    eye_bits,
    index_bits,
    unit_bits,
    unsigned,
)
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.engine.rect_sequencer import rect_sequencer
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.exact.exact_unit import exact_unit
from raycaster.rtl.exact.eye_register import eye_register
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.verif.leaf import EARLY_OUT_AT, Leaf, TraceCycle, ends_early, slot_length, sorted_rect, trace_cycles
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
LAST = WORLD_SIZE - 1
LATENCY = 3


def config_id(config: Configuration) -> str:
    return config.name


def exact_config(**options) -> Configuration:
    return configure(engine="exact", **{"allow_underrun": True} | options)


by_reflections = pytest.mark.parametrize("reflections", [0, 1, 2])


def two_complement(values, bits: int, prefix: str) -> dict[str, int]:
    return {f"{prefix}_{axis}": int(value) % (1 << bits) for axis, value in zip(AXES, values, strict=True)}


def slope_inputs(slope) -> dict[str, int]:
    inputs = {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
    return inputs | {f"signs_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}


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
    ],
)
def test_as_few_units_as_meet_the_row_budget(options, units, cycles):
    config = configure(engine="exact", **options)
    assert (config.units, config.group_cycles) == (units, cycles)
    assert config.groups * config.group_cycles < config.screen_geometry.row_cycles


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
            "mirror": Mirror(),
            "hit": bit(),
            "numerator": unsigned(eye_bits(config) - 1),
            "denominator": unsigned(exact_slope_bits(config)),
        },
        directory,
    )


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
            eye[axis], slope[axis], mirror = 2 * plane - eye[axis], -slope[axis], (axis, plane)
        chosen = random.choice(np.flatnonzero(table.visible), 4)
        for index in chosen:
            table = sharpened(random, table, int(index), eye, slope, mirror)
        count -= 1
        yield table, set(chosen.tolist()), eye, slope, mirror


@by_reflections
def test_rect_tester(reflections, tmp_path):
    config = exact_config(reflections=reflections)
    leaf = leaf_of_tester(config, tmp_path)
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    for table, chosen, eye, slope, mirror in mirrored_rays(random, config, 5000):
        for index in chosen:
            started = int(not stimulus or random.random() < 0.9)
            stimulus.append(
                {
                    **sorted_rect(table, index, "rect"), **two_complement(eye, eye_bits(config), "eye"),
                    **slope_inputs(slope), "mirror_active": int(mirror is not None),
                    "mirror_axis": mirror[0] if mirror else int(random.integers(3)),
                    "mirror_position": mirror[1] if mirror else int(random.integers(WORLD_SIZE)),
                    "steps_find_intersection": started,
                }
            )  # fmt: skip
            expected.append(verdict(table, index, eye, slope, mirror) if started else None)
    seen = set()
    outputs = leaf.run_both([*stimulus, *[{"steps_find_intersection": 0}] * LATENCY], settled=LATENCY)
    for cycle, wanted in enumerate(expected):
        if wanted is None:
            continue
        output = outputs[cycle + LATENCY]
        assert bool(output["hit"]) == wanted[0], (stimulus[cycle], repeat())
        if wanted[0]:
            assert (output["numerator"], output["denominator"]) == wanted[1:], (stimulus[cycle], repeat())
        seen.add((wanted[0], stimulus[cycle]["rect_axis"], stimulus[cycle]["mirror_active"]))
    assert len(seen) == (12 if reflections else 6), "hits and misses on each axis, with a mirror and without"


@by_reflections
def test_the_widths_are_just_wide_enough(reflections, tmp_path):
    """The furthest image of a camera, its greatest products, and a bit that each of them needs."""
    config = exact_config(reflections=reflections)
    far = LAST * (reflections + 1)
    assert eye_bits(config) == far.bit_length() + 1
    greatest = far * 190
    assert greatest.bit_length() == (17, 18, 19)[reflections]
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


@by_reflections
def test_nearest_hit(reflections, tmp_path):
    config = exact_config(reflections=reflections)
    numerator_bits, denominator_bits = eye_bits(config) - 1, exact_slope_bits(config)
    leaf = Leaf(
        nearest_hit,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "offered": Surface(),
            "hit": bit(),
            "numerator": unsigned(numerator_bits),
            "denominator": unsigned(denominator_bits),
            "found": bit(),
            "found_surface": Surface(),
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
            }
        )  # fmt: skip
        expected.append((best is not None, surface))
        if reset:
            best = None
        elif write and hit and (best is None or Fraction(n, e) < best):
            best, surface = Fraction(n, e), offered
            settled = settled or len(stimulus)
    outputs = leaf.run_both(stimulus, settled=settled)
    for cycle, wanted in enumerate(expected):
        if wanted is not None:
            assert bool(outputs[cycle]["found"]) == wanted[0], (cycle, repeat())
            if wanted[0]:
                assert {name: outputs[cycle][f"found_surface_{name}"] for name in wanted[1]} == wanted[1], repeat()


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
            "eye": Eye(eye_bits(config)),
            "signs": Signs(),
            "mirror": Mirror(),
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
        for bounce in range(reflections + 1):
            for _ in range(int(random.integers(1, 3))):
                axis, plane = int(random.integers(3)), int(random.choice([0, LAST, random.integers(WORLD_SIZE)]))
                if mirror is not None and random.random() < 0.5:
                    # From corner to corner the image runs as far away as it can.
                    axis, plane = mirror[0], LAST - mirror[1]
                surface = {"found_surface_axis": axis, "found_surface_position": plane}
                noise = two_complement(random.integers(WORLD_SIZE, size=3), 9, "camera")
                stimulus.append({**noise, **sight, **surface, "steps_screen_to_ray": 0, "steps_store_ray": 0})
                expected.append((list(eye), list(signs), mirror))
            if bounce < reflections:
                stimulus[-1]["steps_store_ray"] = 1
                eye[axis], signs[axis], mirror = 2 * plane - eye[axis], not signs[axis], (axis, plane)
    outputs = leaf.run_both(stimulus, settled=2)
    bits = eye_bits(config)
    for cycle, wanted in enumerate(expected):
        if wanted is None:
            continue
        eye, signs, mirror = wanted
        output = outputs[cycle]
        assert {name: output[name] for name in two_complement(eye, bits, "eye")} == two_complement(eye, bits, "eye")
        assert [bool(output[f"signs_d{axis}"]) for axis in AXES] == signs, repeat()
        assert bool(output["mirror_active"]) == (mirror is not None), repeat()
        if mirror is not None:
            assert (output["mirror_axis"], output["mirror_position"]) == mirror, repeat()


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
    masks += [int(random.integers(1 << count)) & int(random.integers(1 << count)) for _ in range(16)]
    masks += [1 << index for index in range(count)] + [1 | 1 << index for index in range(count)]
    table = Rectangles(
        random.integers(WORLD_SIZE, size=(count, 2, 3)),
        random.integers(256, size=(count, 3)).astype(np.uint8),
        np.ones(count, dtype=bool),
    )
    flat = random.integers(3, size=count)
    table.corners[np.arange(count), 1, flat] = table.corners[np.arange(count), 0, flat]
    quiet = {name: 0 for name in leaf.outputs if name.startswith("steps_") and name != "steps_initial_ray"}
    quiet["done"] = 0
    quiet_cycle = TraceCycle({}, 0)
    stimulus, expected = [], []

    def drive(inputs, wanted=None, current=None, offered=None):
        rect = sorted_rect(table, int(random.integers(count)) if current is None else current, "rects_rect")
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
            rect = sorted_rect(table, offered, "offered")
            surface = {name: rect[name] for name in ("offered_axis", "offered_position", "offered_colour")}
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


# exact_unit ---------------------------------------------------------------------------------------------------------


def held_inputs(camera, background, reflections) -> dict[str, int]:
    colour = int.from_bytes(bytes(background.astype(np.uint8)))
    return {**two_complement(camera, 9, "camera"), "picture_background": colour, "picture_reflections": reflections}


@pytest.mark.parametrize(
    "config",
    [
        exact_config(screen=screen, units=units, rectangles=rectangles, reflections=reflections, colour_bits=bits)
        for screen, units, rectangles, reflections, bits in (
            ("vga", 4, 8, 1, 8), ("vga", 5, 8, 2, 4), ("tiny", 2, 8, 0, 1), ("vga", 320, 8, 2, 8), ("vga", 1, 4, 2, 8),
        )
    ]
    + [exact_config(units=8, rectangles=8, reflections=2, culling=True)],
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
            "camera": Point(),
            "rect": Rect(),
            "offered": Surface(),
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
    for _ in range(300 if config.units == 5 else 80):
        row = int(random.choice([0, 1, config.screen_geometry.horizon_row, rows - 1, random.integers(rows)]))
        column = int(random.choice([0, 1, columns // 2, columns - 1, random.integers(columns)]))
        slope = slopes[row, column][None]
        camera, table, background, reflections, traced = traced_scene(random, config, slope)
        if random.random() < 0.5:
            table = rivalled(random, table, int(traced.winners[0][0]), camera, slope[0])
            given = {"camera": camera, "background": background, "slopes": slope, "reflections": reflections}
            traced = tracer(config, **given)(table)
        fates.add((reflections, sum(int(winner[0]) >= 0 for winner in traced.winners)))
        place = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held = {**held_inputs(camera, background, reflections), **place}
        usable = [int(index) for index in np.flatnonzero(table.visible)]
        if not usable:
            continue
        misses = [bounce for bounce, winner in enumerate(traced.winners) if winner[0] < 0]
        lost = min(misses, default=None) if config.culling else None
        for cycle in trace_cycles(config, usable, reflections, lost=lost):
            inputs = {**held, **cycle.steps}
            if cycle.alive is not None and config.culling:
                alive[len(stimulus)] = cycle.alive
            other = int(random.choice(usable))
            inputs |= sorted_rect(table, other if cycle.current is None else cycle.current, "rect")
            offered = sorted_rect(table, other if cycle.offered is None else cycle.offered, "offered")
            inputs |= {f"offered_{name}": offered[f"offered_{name}"] for name in ("axis", "position", "colour")}
            stimulus.append(inputs)
        case = f"row {row}, column {column}, camera {camera}, corners {table.corners.tolist()}; {repeat()}"
        results.append((len(stimulus), pixel_word(config, traced.colours[0]), case))
        stimulus.append({**held, **dict.fromkeys(cycle.steps, 0)})
    assert len(fates) >= 2 + 2 * config.reflections, repeat()
    outputs = leaf.run_both(stimulus, settled=results[0][0])
    for cycle, pixel, case in results:
        assert pixel_of(config, outputs[cycle]) == pixel, case
    for cycle, expected in alive.items():
        assert outputs[cycle]["fate_alive"] == expected, (cycle, repeat())
    assert not config.culling or set(alive.values()) == {0, 1}
