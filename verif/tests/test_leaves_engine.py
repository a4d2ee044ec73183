# SPDX-License-Identifier: MIT
"""The blocks that trace whole rays, from one unit to the whole module: MyHDL's simulator, the converted Verilog and
golden on one set of scenes, and the control's steps cycle by cycle."""

from dataclasses import replace
from itertools import pairwise
from typing import Any
from unittest import mock

import numpy as np
import pytest
from fates import control_leaf, group_fate_in, mask_of, may_hit_mask, random_fate
from hard_scenes import edged, pixel_of, pixel_word, rectangles_in_view, traced_scene, tracer, with_looks

from raycaster.configuration import WORLD_SIZE, Configuration, configure
from raycaster.engines.engine import SETUP_LATENCY
from raycaster.golden.engines import model_of
from raycaster.golden.random_world import random_basis
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.program import basis_fields
from raycaster.registers import register_map
from raycaster.rtl.common.interfaces import Picture, Place, Progress, RayFate, Rects, Steps, vga_of
from raycaster.rtl.common.records import Pixel, Point, camera_of, rect_of
from raycaster.rtl.common.widths import bit, pixel_bits, unit_bits, unsigned
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.rtl.seed.ray_unit import ray_unit
from raycaster.rtl.system.camera_axis import STEP
from raycaster.rtl.system.ports import module_ports, scene_system_ports
from raycaster.rtl.system.ray_caster import ray_caster
from raycaster.rtl.system.ray_caster_module import RENDERERS, ray_caster_module
from raycaster.rtl.system.ray_caster_renderer import ray_caster_renderer
from raycaster.rtl.system.reset_release import HOLD_CYCLES
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.rtl.system.scene_system import scene_system
from raycaster.scene import UNTURNED, Basis, Camera, Rectangle, Scene
from raycaster.screens import BEAM_SCREENS, SCREENS, Screen, Span
from raycaster.sim.register_model import RegisterFile, Request
from raycaster.verif.leaf import Leaf, TraceCycle, reset_signal, slot_length, sorted_rect, trace_cycles
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
SMALL_SCREEN = Screen(
    columns=16,
    rows=4,
    horizon_row=3,
    doubling=2,
    horizontal=Span(32, 8, 24, 20, active_high=False),
    vertical=Span(8, 1, 2, 2, active_high=True),
)
"""Small enough that MyHDL's simulator shows a whole frame in seconds."""

LONG_BLANKING = replace(SMALL_SCREEN, horizontal=Span(32, 8, 24, 44, active_high=False))
"""In which a beam engine whose camera turns sets up a line."""


def config_id(config: Configuration) -> str:
    return config.name


COARSE = Screen(
    columns=8,
    rows=2,
    horizon_row=1,
    doubling=4,
    horizontal=Span(32, 8, 48, 40, active_high=False),
    vertical=Span(8, 1, 2, 2, active_high=True),
    clocks_per_pixel=1,
    distance=50,
)
"""With a clock a pixel, and half the slope ahead."""


def small_config(screen: Screen = SMALL_SCREEN, **options) -> Configuration:
    """A configuration for a screen that no name stands for."""
    beam = options.get("engine") == "beam"
    screen = replace(screen, clocks_per_pixel=1) if beam else screen
    with mock.patch.dict(BEAM_SCREENS if beam else SCREENS, {("tiny", screen.rows): screen}):
        config = configure(screen="tiny", rows=screen.rows, **options)
        shown = screen.scaled(config.scale)
        # Looked up once, and kept from here on.
        assert config.screen_geometry == (shown if config.pixels == 1 else shown.paired())
    return config


def any_config(**options) -> Configuration:
    return configure(**{"allow_underrun": True} | options)


def visible_indices(table: Rectangles) -> list[int]:
    return [int(index) for index in np.flatnonzero(table.visible)]


def usable_mask(table: Rectangles) -> int:
    return sum(1 << index for index in visible_indices(table))


def colour_word(colour) -> int:
    return int.from_bytes(bytes(np.asarray(colour, dtype=np.uint8)))


# ray_control ---------------------------------------------------------------------------------------------------------

controls = pytest.mark.parametrize(
    "config",
    [
        any_config(rectangles=rectangles, reflections=reflections, fraction_bits=bits, divider_bits=divider_bits)
        for rectangles, reflections, bits, divider_bits in (
            (1, 0, 0, 1), (1, 2, 8, 1), (2, 1, 0, 3), (3, 2, 0, 3), (5, 1, 4, 2), (8, 2, 1, 2), (12, 1, 0, 1),
            (12, 2, 0, 3), (32, 1, 8, 3),
        )
    ]
    + [any_config(rectangles=5, reflections=2, culling=False)],
    ids=config_id,
)  # fmt: skip


@pytest.mark.slow_sets("seed-vga240-u32-r12", "seed-vga240-u32-r32", "seed-vga240-u32-r8")
@controls
def test_ray_control(config, tmp_path):
    leaf = control_leaf(ray_control, config, tmp_path)
    random = np.random.default_rng(seed())
    count = config.rectangles
    every = (1 << count) - 1
    masks = [every, 0, 1, 1 << (count - 1), every]
    masks += [int(random.integers(1 << count)) & int(random.integers(1 << count)) for _ in range(6)]
    masks += [1 << index for index in range(count)] + [1 | 1 << index for index in range(count)]
    table = Rectangles(
        random.integers(WORLD_SIZE, size=(count, 2, 3)),
        random.integers(256, size=(count, 3)).astype(np.uint8),
        np.ones(count, dtype=bool),
    )
    flat = random.integers(3, size=count)
    table.corners[np.arange(count), 1, flat] = table.corners[np.arange(count), 0, flat]

    stimulus, expected = [], []

    def drive(inputs, wanted=None, current=None):
        shown = int(random.integers(count)) if current is None else current
        stimulus.append({**inputs, **sorted_rect(table, shown, "rects_rect")})
        expected.append(wanted)

    first_known = None
    for number, mask in enumerate(masks):
        usable = [index for index in range(count) if mask >> index & 1]
        reflections = config.reflections if number < 2 else int(random.integers(config.reflections + 1))
        held = {"rects_usable": mask, "picture_reflections": reflections}
        fate = random_fate(random, usable, reflections, number)
        # What is not usable is not visited, whatever the mask has for it.
        held["fate_may_hit"] = mask_of(fate["may_hit"]) | int(random.integers(1 << count)) & ~mask
        quiet = ({f"steps_{name}": 0 for name in vars(Steps()) if name != "initial_ray"} | {"done": 0}, None, None)
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
        for cycle in trace[: int(random.integers(len(trace))) if abandoned else None]:
            wanted = cycle.steps | {"done": 0}
            if cycle.steps["steps_screen_to_ray"]:
                del wanted["steps_initial_ray"]
            if cycle.offered is not None and first_known is None:
                first_known = len(stimulus)
            inputs = {**held, "reset_ray_caster": 0, "enable": int(random.integers(2))}
            inputs |= group_fate_in(random, cycle, leaf)
            drive(inputs, (wanted, cycle.current, cycle.offered), cycle.current)
        if not abandoned:
            for _ in range(int(random.integers(1, 4))):
                wanted = {**quiet[0], "done": 1}
                drive({**held, "reset_ray_caster": 0, "enable": int(random.integers(2))}, (wanted, None, None))

    outputs = leaf.run_both(stimulus, settled=first_known)
    held_by_memory = None
    for cycle, (output, wanted) in enumerate(zip(outputs, expected, strict=True)):
        if wanted is not None:
            signals, current, offered = wanted
            assert {name: output[name] for name in signals} == signals, (cycle, repeat())
            if current is not None:
                assert held_by_memory == current, f"cycle {cycle}: it fetched another rectangle; {repeat()}"
            if offered is not None:
                rect = sorted_rect(table, offered, "offered")
                assert {name: output[name] for name in rect} == rect, (cycle, repeat())
        if output["rects_fetch"]:
            held_by_memory = output["rects_index"]


def fate_of(config: Configuration, golden, table: Rectangles) -> dict[str, Any]:
    """What the control is told of a group that golden has traced: the keyword arguments of `trace_cycles`."""
    if not (config.culling or config.materials):
        return {}
    behind = {
        (number, index)
        for number, bounce in enumerate(golden.bounces)
        for index in range(len(bounce.numerators))
        if not np.any(bounce.alive & (bounce.numerators[index] * bounce.denominators[index] > 0))
    }
    winners = np.array(golden.winners)
    ended = np.logical_or.accumulate((winners < 0) | (table.mirrors[winners] == 0))
    return {"behind": behind, "lost": next(iter(np.flatnonzero(ended.all(axis=1))), None)}


# ray_unit ------------------------------------------------------------------------------------------------------------


def rects_shown(config: Configuration, cycle, table: Rectangles) -> dict[str, int]:
    """What the control and the memory show all units in a cycle."""
    inputs = {}
    if cycle.current is not None:
        inputs |= sorted_rect(table, cycle.current, "rect", config)
    if cycle.offered is not None:
        inputs |= sorted_rect(table, cycle.offered, "offered", config)
    return inputs


def unrelated_inputs(random: np.random.Generator, config: Configuration) -> dict[str, int]:
    """What a unit reads in one step only, the pixel's place and the plane, as it may be in the other cycles."""
    return {
        "place_row": int(random.integers(config.screen_geometry.rows)),
        "place_column_offset": int(random.integers(config.groups)),
        "rect_axis": int(random.integers(3)),
        "rect_position": int(random.integers(WORLD_SIZE)),
    }


def ray_unit_leaf(config: Configuration, directory) -> Leaf:
    return Leaf(
        ray_unit,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "place": Place(config),
            "column_base": unsigned(unit_bits(config)),
            "camera": Point(),
            "rect": rect_of(config),
            "offered": rect_of(config),
            "picture": Picture(),
            "pixel": Pixel(config.colour_bits),
            "fate": RayFate(),
            "config": config,
        },
        directory,
    )


def check_ray_unit(leaf: Leaf, config: Configuration, rays: int = 24) -> None:
    """Rays through a unit as its control leads them: MyHDL, Verilog and golden."""
    random = np.random.default_rng(seed())
    slopes = primary_slopes(config.screen_geometry)
    rows, columns, _ = slopes.shape
    stimulus, results, told = [], [], []
    # How many mirrors a ray meets: none, one, and all that it may.
    fates, every_fate = set(), set(range(config.reflections + 2))
    while len(results) < rays or fates != every_fate:
        row = int(random.choice([0, 1, config.screen_geometry.horizon_row, rows - 1, random.integers(rows)]))
        column = int(random.choice([0, 1, columns // 2, columns - 1, random.integers(columns)]))
        camera, table, background, reflections, golden = traced_scene(random, config, slopes[row, column][None])
        fate = sum(int(winner[0]) >= 0 for winner in golden.winners)
        if len(results) >= rays and fate in fates:
            continue
        fates.add(fate)
        held = {
            "place_row": row,
            "place_column_offset": column // config.units,
            "column_base": column % config.units,
            "picture_background": colour_word(background),
            **{f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)},
        }
        fated = fate_of(config, golden, table)
        for cycle in trace_cycles(config, visible_indices(table), reflections, **fated):
            inputs = {**held, **cycle.steps, **rects_shown(config, cycle, table)}
            if config.culling or config.materials:
                told.append((len(stimulus), cycle.towards, cycle.alive))
            if not cycle.steps["steps_screen_to_ray"] and not cycle.steps["steps_find_intersection"]:
                inputs |= unrelated_inputs(random, config)
            stimulus.append(inputs)
        case = f"row {row}, column {column}, camera {camera}, corners {table.corners.tolist()}; {repeat()}"
        results.append((len(stimulus), pixel_word(config, golden.colours[0]), case))
        # done: the pixel stands, whatever comes.
        stimulus.append({**dict.fromkeys(stimulus[-1], 0), "picture_background": held["picture_background"]})
    outputs = leaf.run_both(stimulus, settled=results[0][0])
    for cycle, pixel, case in results:
        assert pixel_of(config, outputs[cycle]) == pixel, case
    for cycle, towards, alive in told:
        assert towards is None or outputs[cycle].get("fate_towards", towards) == towards, (cycle, repeat())
        assert alive is None or outputs[cycle]["fate_alive"] == alive, (cycle, repeat())


@pytest.mark.slow_sets(
    "seed-tiny48-u16",
    "seed-vga240-u16-r8-m1-f0t-d2-c8-materials",
    "seed-vga240-u16-r8-m2-f0t-d2-c8-k0",
    "seed-vga240-u32-r8-m1-f0t-d1-c8",
    "seed-vga240-u320",
    "seed-vga240-u40",
    "seed-vga240-u5",
    quick=["seed-vga240-u16-r8-m2-f0t-d2-c8-k0-materials-patterns"],
)
@pytest.mark.parametrize(
    "config",
    [
        any_config(
            screen=screen, units=units, rectangles=rectangles, reflections=reflections, fraction_bits=bits,
            rounding=rounding, divider_bits=divider_bits, colour_bits=colour_bits,
        )
        for screen, units, rectangles, reflections, bits, rounding, divider_bits, colour_bits in (
            ("vga", 32, 8, 1, 0, "truncate", 1, 8), ("vga", 5, 8, 2, 0, "nearest", 3, 4),
            ("tiny", 2, 3, 0, 0, "truncate", 2, 8), ("vga", 1, 8, 2, 1, "truncate", 2, 5),
            ("vga", 320, 7, 2, 4, "nearest", 3, 8), ("vga", 64, 8, 1, 4, "truncate", 1, 1),
            ("tiny", 16, 8, 2, 8, "nearest", 2, 8), ("vga", 40, 8, 2, 8, "truncate", 3, 8),
        )
    ]
    + [any_config(units=16, rectangles=8, reflections=2, culling=False)]
    + [
        any_config(units=units, rectangles=8, reflections=reflections, fraction_bits=bits, **options)
        for units, reflections, bits, options in (
            (16, 1, 0, {"materials": True}), (32, 2, 3, {"materials": True, "patterns": True}),
            (64, 1, 8, {"patterns": True}), (16, 2, 0, {"materials": True, "patterns": True, "culling": False}),
        )
    ],
    ids=config_id,
)  # fmt: skip
def test_ray_unit(config, tmp_path):
    check_ray_unit(ray_unit_leaf(config, tmp_path), config, rays=120 if config.fraction_bits == 0 else 40)


# ray_caster ----------------------------------------------------------------------------------------------------------


def place_after(config: Configuration, place: tuple[int, int]) -> tuple[int, int]:
    """The row and the group that follow in a frame."""
    row, offset = place
    return (row, offset + 1) if offset < config.groups - 1 else (row + 1, 0)


def places_before(random: np.random.Generator, config: Configuration, place: tuple[int, int]) -> list[tuple[int, int]]:
    """Groups that a frame comes by on its way to this one: its first, at times its second, mostly the one before this.

    The rows between are abandoned.
    """
    row, offset = place
    before = (row, offset - 1) if offset else (row - 1, config.groups - 1)
    second = [(0, 1)] * int(random.random() < 0.2)
    return [(0, 0), *second, *([before] if random.random() < 0.8 else [])]


def remembered(config: Configuration, cycles: list[TraceCycle], usable: list[int]) -> list[int]:
    """The rectangle that the memory holds in each cycle of a trace, in that of done and in the next.

    The control fetches one for each slot and each pass, whether anybody waits for it or not; where none is left, the
    lowest.
    """
    queue = [*usable, *[0] * len(cycles)]
    held, blends, indices = 0, 0, []
    for before, cycle in pairwise([None, *cycles]):
        if cycle.current is not None:
            held = cycle.current
        elif blends:
            held = queue[blends - 1]
        elif before is not None and (before.current is not None or before.steps["steps_screen_to_ray"]):
            held = 0
        blends = blends + 1 if cycle.steps["steps_add_colour"] else 0
        indices.append(held)
    # A slot of one cycle is over in that of done.
    return [*indices, queue[blends - 1], queue[blends - (slot_length(config) > 1)]]


@pytest.mark.slow_sets(
    "exact-vga240-u1-r4-m2",
    "exact-vga240-u4-r6-m2",
    "exact-vga240-u5",
    "seed-vga240-u1-",
    "seed-vga240-u4-r5-m2-f0t-d3-c8-k0",
    "seed-vga240-u5",
)
@pytest.mark.parametrize(
    "config",
    [
        any_config(units=1, rectangles=4, reflections=1, divider_bits=3),
        any_config(units=2, rectangles=8, reflections=2, fraction_bits=4, rounding="nearest", divider_bits=3),
        any_config(units=5, rectangles=5, reflections=1, fraction_bits=1, divider_bits=2, colour_bits=4),
        any_config(engine="exact", units=1, rectangles=4, reflections=2),
        any_config(engine="exact", units=2, rectangles=8, reflections=1),
        any_config(engine="exact", units=5, rectangles=7, reflections=0, colour_bits=4),
        any_config(units=4, rectangles=6, reflections=2, divider_bits=1, culling=False),
        any_config(engine="exact", units=4, rectangles=6, reflections=2, culling=True),
        any_config(units=2, rectangles=6, reflections=2, divider_bits=3, materials=True, patterns=True),
        any_config(units=4, rectangles=5, reflections=2, divider_bits=3, materials=True, culling=False),
        any_config(engine="exact", units=2, rectangles=6, reflections=2, materials=True),
        any_config(engine="exact", units=4, rectangles=6, reflections=1, turn=True, culling=True),
    ],
    ids=config_id,
)
def test_ray_caster(config, tmp_path):
    """Of either engine: pixels, and the cycle in which they are done.

    Where groups are culled, a group comes after others of its frame, in which its rectangles were tested or not.
    """
    leaf = Leaf(
        ray_caster,
        lambda: {
            "clk": bit(),
            "reset_ray_caster": bit(),
            "enable": bit(),
            "place": Place(config),
            "camera": camera_of(config),
            "picture": Picture(),
            "rects": Rects(config),
            "done": bit(),
            "pixels": unsigned(config.units * pixel_bits(config)),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    predicts = config.culling and not config.turn
    stimulus, results, shown, culled = [], [], {}, 0
    for _ in range((160 if config.engine == "exact" else 80) if config.units == 1 else 12):
        basis = random_basis(random) if config.turn else UNTURNED
        groups = primary_slopes(config.screen_geometry, basis)
        groups = groups.reshape(len(groups), config.groups, config.units, 3)
        last = int(random.integers(1, len(groups))), int(random.integers(config.groups))
        camera, table, background, reflections, _ = traced_scene(random, config, groups[last])
        trace = tracer(config, camera=camera, background=background, reflections=reflections)
        usable = visible_indices(table)
        scene = {
            "picture_background": colour_word(background),
            "picture_reflections": reflections,
            "rects_usable": usable_mask(table),
            **{f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)},
        }
        if config.turn:
            for name, vector in zip(("forward", "right", "up"), basis, strict=True):
                scene |= {f"camera_{name}_{axis}": part for axis, part in zip(AXES, vector, strict=True)}
        rects = {index: sorted_rect(table, index, "rects_rect", config) for index in usable}
        following, at_hand = None, 0
        places = [*places_before(random, config, last), last] if config.culling else [last]
        for place in places:
            golden = trace(table, slopes=groups[place])
            fate = fate_of(config, golden, table)
            if predicts and place == following:
                mask = may_hit_mask(config, table, camera, *place)
                fate["may_hit"] = [index for index in usable if mask >> index & 1]
                culled += len(usable) - len(fate["may_hit"])
            held = {**scene, "place_row": place[0], "place_column_offset": place[1]}
            if place == places[0]:
                stimulus.append({**held, "reset_ray_caster": 1, "enable": 1})
            stimulus.append({**held, **rects.get(at_hand, {}), "reset_ray_caster": 1, "enable": 1})
            stimulus += [{**held, "reset_ray_caster": 0, "enable": 0}] * int(random.integers(3))
            stimulus.append({**held, "reset_ray_caster": 0, "enable": 1})
            cycles = trace_cycles(config, usable, reflections, **fate)
            *indices, at_hand = remembered(config, cycles, usable)
            shown |= {len(stimulus) + number: index for number, index in enumerate(indices) if number}
            for index in indices:
                rect = rects.get(index, {})
                stimulus.append({**held, **rect, "reset_ray_caster": 0, "enable": int(random.integers(2))})
            # In a frame the cycle of done is the first of a reset.
            stimulus[-1]["reset_ray_caster"] = int(place != last)
            colours = [pixel_word(config, colour) for colour in golden.colours]
            case = f"group {place} of {places}, camera {camera}, corners {table.corners.tolist()}; {repeat()}"
            results.append((len(stimulus) - 1, colours, case))
            # In the first the rectangles are copied; the others test them if they take long enough.
            tests = place != (0, 0) and len(cycles) >= config.rectangles + SETUP_LATENCY
            following = place_after(config, place) if tests else None
        stimulus.append({})
        results.append((len(stimulus) - 1, *results[-1][1:]))
    outputs = leaf.run_both(stimulus, settled=results[0][0])
    width = pixel_bits(config)
    done = {cycle for cycle, *_ in results}
    for cycle, colours, case in results:
        assert outputs[cycle]["done"], case
        assert outputs[cycle - 1]["done"] == (cycle - 1 in done), case
        units = [outputs[cycle]["pixels"] >> width * unit & (1 << width) - 1 for unit in range(config.units)]
        assert units == colours, case
    for cycle, index in shown.items():
        before = next(past for past in range(cycle - 1, -1, -1) if outputs[past]["rects_fetch"])
        assert outputs[before]["rects_index"] == index, f"cycle {cycle}: it fetched another rectangle; {repeat()}"
    assert bool(culled) == predicts, "some groups were to be culled"


# The picture ---------------------------------------------------------------------------------------------------------


def monitored(outputs: list[dict[str, int]], config: Configuration) -> list[np.ndarray]:
    """The frames that a monitor sees, as rows of pixel words; it samples where its clock has risen.

    Of two pixels in a clock, the left one is in the low half of each colour. With a clock a pixel that is before each
    clock, where outputs are recorded.
    """
    every_cycle = config.screen_geometry.clocks_per_pixel == 1
    horizontal, vertical = config.screen_geometry.horizontal, config.screen_geometry.vertical
    words, shift = [], config.colour_bits
    for before, output in pairwise(outputs):
        if output["vga_clk"] and (every_cycle or not before["vga_clk"]) and output["vga_blank_n"]:
            for low in range(0, shift * config.pixels, shift):
                red, green, blue = (output[f"vga_{channel}"] >> low & (1 << shift) - 1 for channel in "rgb")
                words.append((red << shift | green) << shift | blue)
    size = horizontal.visible * vertical.visible
    return [
        np.array(words[start : start + size]).reshape(vertical.visible, horizontal.visible)
        for start in range(0, len(words) - size + 1, size)
    ]


def golden_words(config: Configuration, colours: np.ndarray) -> np.ndarray:
    screen = config.screen_geometry
    words = [pixel_word(config, colour) for colour in colours.reshape(-1, 3)]
    return np.array(words).reshape(screen.rows, screen.columns)


def doubled(config: Configuration, words: np.ndarray) -> np.ndarray:
    return words.repeat(config.screen_geometry.doubling, axis=0).repeat(config.screen_geometry.doubling, axis=1)


def without_one(random: np.random.Generator, config: Configuration, scene: tuple) -> tuple:
    """The scene without one of the rectangles that its picture shows, if it shows any."""
    camera, table, background, reflections, words = scene
    slopes = primary_slopes(config.screen_geometry).reshape(-1, 3)
    for index in random.permutation(np.flatnonzero(table.visible)):
        less = Rectangles(table.corners, table.colours, table.enabled & (np.arange(len(table)) != index))
        trace = tracer(config, camera=camera, background=background, reflections=reflections)
        left = golden_words(config, trace(less, slopes=slopes).colours)
        if not np.array_equal(left, words):
            return camera, less, background, reflections, left
    return scene


def start_screen_cycle(screen: Screen) -> int:
    """Cycles from the end of reset to the first StartScreen."""
    return (screen.vertical.blank - screen.doubling) * screen.line_cycles


def renderer_leaf(config: Configuration, directory) -> Leaf:
    return Leaf(
        RENDERERS.get(config.engine, ray_caster_renderer),
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "picture": Picture(),
            "camera": Point(),
            "rects": Rects(config),
            "progress": Progress(),
            "vga": vga_of(config),
            "config": config,
        },
        directory,
    )


@pytest.mark.slow_sets("seed-tiny4-u4-r1-m2")
@pytest.mark.parametrize(
    "config",
    [
        small_config(units=4, rectangles=1, reflections=1, colour_bits=8, culling=False),
        small_config(units=2, rectangles=1, reflections=0, fraction_bits=4, rounding="nearest", culling=False),
        small_config(units=4, rectangles=1, reflections=2, divider_bits=3, colour_bits=2, culling=False),
        small_config(units=4, rectangles=1, reflections=2, colour_bits=4),
        small_config(COARSE, units=4, rectangles=1, reflections=1, culling=False),
        # 16 groups of 27 cycles, of which a row of 336 has time for twelve.
        small_config(
            units=1, rectangles=1, reflections=0, fraction_bits=8, divider_bits=1, allow_underrun=True, culling=False
        ),
    ],
    ids=config_id,
)
def test_ray_caster_renderer(config, tmp_path):
    """One rectangle, so that the memory's answer never changes; the first frame shows none, the third is black."""
    screen = config.screen_geometry
    random = np.random.default_rng(seed())
    camera = np.array([100, 200, 100])
    # At twice the distance of the viewing rectangle, a column is two units wide, and a row two high.
    table = Rectangles(
        np.array([[(301, 511, 104), (301, 192, 100)]]),
        random.integers(1, 256, size=(1, 3)).astype(np.uint8),
        np.ones(1, dtype=bool),
    )
    background = random.integers(1, 256, size=3)
    scene = {
        "picture_background": colour_word(background),
        "picture_reflections": config.reflections,
        **{f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)},
        **sorted_rect(table, 0, "rects_rect"),
    }
    start, frame = start_screen_cycle(screen), screen.frame_cycles
    # From the cycle after each StartScreen on, the next scene.
    stimulus = [{**scene, "reset": 1}] * 2 + [{"reset": 0, "picture_run": 1, "rects_usable": 0}] * (start + 1 + frame)
    stimulus += [{"rects_usable": 1}] * frame + [{"picture_run": 0}] * (frame // 2)
    # What the control asks the memory for is known from the first group on.
    outputs = renderer_leaf(config, tmp_path).run_both(stimulus, settled=2 + start + 6)[2:]

    slopes = primary_slopes(screen).reshape(-1, 3)
    colours = model_of(config).trace(table, camera, background, slopes, config.reflections).colours
    golden = golden_words(config, colours)
    assert len(set(golden.flat)) > 1, "the rectangle was to have an edge in view"
    empty = np.full_like(golden, pixel_word(config, background))
    group = len(trace_cycles(config, [0], config.reflections)) + 3
    assert group == config.group_cycles
    groups_in_time = min(config.groups, (screen.row_cycles - 1) // group)
    shown = golden.copy()
    # Columns that were not written in time keep what that half of the buffer held: the empty scene's.
    shown[:, groups_in_time * config.units :] = empty[:, groups_in_time * config.units :]
    frames = monitored(outputs, config)
    assert len(frames) == 2
    assert np.array_equal(frames[0], doubled(config, empty))
    assert np.array_equal(frames[1], doubled(config, shown))
    assert (groups_in_time < config.groups) == config.allow_underrun

    assert not any(output[f"vga_{channel}"] for output in outputs[start + 2 * frame + 1 :] for channel in "rgb")

    strobes = [cycle for cycle, output in enumerate(outputs) if output["progress_start_screen"]]
    assert strobes == [start, start + frame, start + 2 * frame]
    late = [cycle for cycle, output in enumerate(outputs) if output["progress_underrun"]]
    rows = [start + frame + row * screen.row_cycles for row in range(1, screen.rows + 1)]
    assert late == (rows if config.allow_underrun else [])
    in_second = outputs[start + frame + 1 : start + 2 * frame]
    busy = sum(output["progress_busy"] for output in in_second)
    if config.culling:
        # In the first two groups nothing is known yet.
        assert 2 * group < busy < screen.rows * config.groups * group / 2
        return
    if not config.allow_underrun:
        assert (
            max(output["progress_row_cycles"] for output in in_second if output["progress_busy"])
            == config.groups * group
        )
        assert busy == screen.rows * config.groups * group
        times = [output["progress_group_cycles"] for output in in_second]
        finished = [before for before, after in pairwise(times) if after < before]
        assert finished == [group] * screen.rows * config.groups
    assert max(output["progress_group_cycles"] for output in in_second) == group


TINY_SCREEN = Screen(
    columns=8,
    rows=2,
    horizon_row=1,
    doubling=2,
    horizontal=Span(16, 8, 24, 20, active_high=False),
    vertical=Span(4, 1, 2, 2, active_high=True),
)
"""With many frames in little time."""

LONG_LINE = replace(TINY_SCREEN, horizontal=Span(16, 8, 24, 60, active_high=False))
"""In which two pixels a clock leave time to set up a line."""


def scene_in_view(random: np.random.Generator, config: Configuration, axis: int) -> tuple:
    """Camera, table, background, reflections and the picture; most show several colours and a plane of this axis, and
    are another picture from a camera one unit away along it."""
    slopes = primary_slopes(config.screen_geometry).reshape(-1, 3)
    anything = random.random() < 0.2
    for _ in range(2000):
        camera = random.integers(WORLD_SIZE, size=3) // [random.choice([1, 2]), 1, 1]
        table = rectangles_in_view(random, camera, slopes, config.rectangles, None if anything else axis)
        enabled = random.random(config.rectangles) < 0.7
        enabled[0] |= not anything
        table = Rectangles(table.corners, table.colours, enabled)
        background = random.integers(256, size=3)
        reflections = int(random.integers(config.reflections + 1))
        trace = tracer(config, background=background, reflections=reflections)
        ray = slopes[random.integers(len(slopes))][None]
        table = edged(random, config, trace(table, camera=camera, slopes=ray), table)
        words = golden_words(config, trace(table, camera=camera, slopes=slopes).colours)
        beside = camera ^ (np.arange(3) == axis)
        moved = golden_words(config, trace(table, camera=beside, slopes=slopes).colours)
        if anything or (
            len(np.unique(words)) > 1 and axis in table.axes[table.visible] and not np.array_equal(moved, words)
        ):
            return camera, table, background, reflections, words
    raise AssertionError(f"no scene shows where its camera is along {AXES[axis]}; {repeat()}")


@pytest.mark.slow_sets("beam-tiny2-s2-u2", "seed")
@pytest.mark.parametrize(
    "config",
    [
        small_config(TINY_SCREEN, units=2, rectangles=1, reflections=1, divider_bits=1),
        small_config(TINY_SCREEN, engine="beam", rectangles=1, reflections=1, scale=1),
        small_config(LONG_LINE, engine="beam", rectangles=1, reflections=1, pixels=2),
    ],
    ids=config_id,
)
def test_ray_caster_renderer_scenes(config, tmp_path):
    """A scene a frame, of one rectangle, wherever it may stand, and once disabled; of either renderer."""
    screen = config.screen_geometry
    random = np.random.default_rng(seed())
    scenes = [scene_in_view(random, config, number % 3) for number in range(50 if config.engine == "beam" else 30)]
    camera, table, background, reflections, words = next(scene for scene in scenes if len(np.unique(scene[-1])) > 1)
    disabled = Rectangles(table.corners, table.colours, np.zeros(1, dtype=bool))
    empty = golden_words(config, np.broadcast_to(background, (words.size, 3)))
    scenes.insert(0, (camera, disabled, background, reflections, empty))
    stimulus = [{"reset": 1, "picture_run": 1}] * 2
    start = start_screen_cycle(screen)
    for number, (camera, table, background, reflections, _) in enumerate(scenes):
        scene = {
            "reset": 0,
            "picture_background": colour_word(background),
            "picture_reflections": reflections,
            "rects_usable": usable_mask(table),
            **{f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)},
        }
        if table.axes[0] >= 0:
            scene |= sorted_rect(table, 0, "rects_rect")
        # From the cycle after each StartScreen on, the next scene.
        stimulus += [scene] * (screen.frame_cycles if number else start + 1 + screen.frame_cycles)
    stimulus += [{"picture_run": 0}] * screen.frame_cycles
    shown = len(stimulus) - 2
    if config.engine == "beam":
        # A reset right after a row was announced, which must not begin in the blanking that follows.
        stimulus += [{"picture_run": 1}] * (screen.doubling * screen.line_cycles + 2)
        stimulus += [{"reset": 1}] * 2 + [{"reset": 0}] * 3 * screen.line_cycles
    stimulus += [{"reset": 1}] * 2
    outputs = renderer_leaf(config, tmp_path).run_both(stimulus, settled=2 + start + 6)[2:]
    assert not any(output["progress_busy"] for output in outputs[shown:])
    frames = monitored(outputs[:shown], config)
    assert len(frames) >= len(scenes)
    for number, (frame, (_, table, _, _, words)) in enumerate(zip(frames, scenes, strict=False)):
        assert np.array_equal(frame, doubled(config, words)), (number, table.corners.tolist(), repeat())


# The module ----------------------------------------------------------------------------------------------------------


class Bus:
    """Writes the stimulus of a bus master, and remembers when the answer to each read comes."""

    def __init__(self, config: Configuration):
        self.config, self.registers = config, register_map(config.rectangles)
        self.stimulus: list[dict[str, int]] = []
        self.reads: dict[str, int] = {}
        self._idle = {"avs_s0_write": 0, "avs_s0_read": 0}

    def wait(self, cycles: int, **signals: int) -> None:
        self.stimulus += [{**self._idle, **signals}] * cycles

    def write(self, name: str, **fields: int) -> None:
        transfer = {"avs_s0_address": self.registers[name].address, "avs_s0_byteenable": 15}
        transfer["avs_s0_writedata"] = self.registers[name].pack(**{key: int(value) for key, value in fields.items()})
        self.stimulus.append({**self._idle, **transfer, "avs_s0_write": 1})

    def write_word(self, name: str, word: int, lanes: int) -> None:
        """Any word, in some of its bytes."""
        transfer = {"avs_s0_address": self.registers[name].address, "avs_s0_writedata": word}
        self.stimulus.append({**self._idle, **transfer, "avs_s0_byteenable": lanes, "avs_s0_write": 1})

    def read(self, name: str) -> None:
        self.reads[name] = len(self.stimulus) + 2
        self.stimulus.append({**self._idle, "avs_s0_address": self.registers[name].address, "avs_s0_read": 1})

    def write_scene(
        self, camera, background, reflections: int, table: Rectangles, run: bool = True, basis: Basis = UNTURNED
    ) -> None:
        self.write("camera", **dict(zip(AXES, camera, strict=True)))
        if self.config.turn:
            for name, fields in basis_fields(basis):
                self.write(name, **fields)
        self.write("background", **dict(zip(("red", "green", "blue"), background, strict=True)))
        for index, (corners, colour, enabled) in enumerate(
            zip(table.corners, table.colours, table.enabled, strict=True)
        ):
            for number, corner in enumerate(corners):
                self.write(f"rectangle[{index}].corner_{number}", **dict(zip(AXES, corner, strict=True)))
            channels, channels_2 = (
                dict(zip(("red", "green", "blue"), one, strict=True)) for one in (colour, table.colours_2[index])
            )
            if self.config.patterns:
                cell = int(table.cells[index]).bit_length() - 4
                self.write(f"rectangle[{index}].pattern", kind=table.kinds[index], cell=cell, **channels_2)
            self.write(f"rectangle[{index}].surface", enable=enabled, mirror=table.mirrors[index], **channels)
        self.write("control", run=run, commit=1, reflections=reflections)


def check_bus(config: Configuration, stimulus: list[dict[str, int]], outputs: list[dict[str, int]]) -> int:
    """Hold the bus against the registers' model in every cycle; returns how many reads were answered."""
    model, inputs, answers = RegisterFile(config), {}, 0
    for cycle, (given, output) in enumerate(zip(stimulus, outputs, strict=True)):
        inputs |= given
        if cycle >= 2:
            expected = {"avs_s0_waitrequest": model.agent.waiting, "avs_s0_readdatavalid": model.agent.answer[0]}
            assert {name: output[name] for name in expected} == expected, (cycle, repeat())
            if output["avs_s0_readdatavalid"]:
                model.check_answer(output["avs_s0_readdata"])
                answers += 1
        reads, writes = inputs["avs_s0_read"], inputs["avs_s0_write"]
        word = inputs["avs_s0_writedata"] if writes else None
        request = Request(inputs.get("avs_s0_address", 0), word, inputs.get("avs_s0_byteenable", 0))
        model.clock(bool(inputs["reset"]), request if reads or writes else None)
    return answers


@pytest.mark.slow_sets(
    "",
    quick=[
        "beam-tiny4-s1-u1-r2-m1-c8-turn",
        "exact-tiny4-u4-r3-m2-c8-turn",
        "seed-tiny4-u4-r3-m1-f0t-d1-c8-materials-patterns",
    ],
)
@pytest.mark.parametrize(
    "config",
    [
        small_config(units=4, rectangles=3, reflections=1),
        small_config(units=4, rectangles=2, reflections=2, fraction_bits=4, rounding="nearest", colour_bits=4),
        small_config(units=2, rectangles=5, reflections=0, divider_bits=3, colour_bits=6),
        small_config(engine="beam", rectangles=3, reflections=1, scale=1),
        small_config(engine="beam", rectangles=2, reflections=2, scale=2, colour_bits=4),
        small_config(units=4, rectangles=3, reflections=1, materials=True, patterns=True),
        small_config(engine="exact", units=4, rectangles=3, reflections=2, turn=True, materials=True, patterns=True),
        small_config(
            LONG_BLANKING, engine="beam", rectangles=2, reflections=1, scale=1, turn=True, materials=True, patterns=True
        ),
    ],
    ids=config_id,
)
def test_ray_caster_module(config, tmp_path):
    """Two scenes over the bus, one shown after the other; each output of each cycle, and each pixel."""
    random = np.random.default_rng(seed())
    screen = config.screen_geometry
    bus = Bus(config)
    pictures = []
    bus.wait(2, reset=1)
    bus.wait(3, reset=0)
    for _ in range(2):
        # Most of what is random cannot be told from a wall.
        for _ in range(1000):
            camera = random.integers(WORLD_SIZE, size=3) // [2, 1, 1]
            basis = random_basis(random) if config.turn else UNTURNED
            slopes = primary_slopes(screen, basis).reshape(-1, 3)
            table = with_looks(random, config, rectangles_in_view(random, camera, slopes, config.rectangles))
            background = random.integers(256, size=3)
            colours = model_of(config).trace(table, camera, background, slopes, config.reflections).colours
            if len(np.unique(colours, axis=0)) > min(config.rectangles, 3):
                break
        else:
            raise AssertionError(f"no scene shows more than {min(config.rectangles, 3)} colours; {repeat()}")
        pictures.append(golden_words(config, colours))
        bus.write_scene(camera, background, config.reflections, table, basis=basis)
        # To the cycle after the next StartScreen.
        so_far = len(bus.stimulus) - 2 - start_screen_cycle(screen) - 1
        bus.wait(-so_far % screen.frame_cycles)
    bus.wait(screen.frame_cycles - 50)
    for name in ("status", "cycles", "engine", "size"):
        bus.read(name)
    bus.wait(60)
    leaf = Leaf(ray_caster_module, lambda: {**module_ports(config), "config": config}, tmp_path)
    outputs = leaf.run_both(bus.stimulus, settled=2)

    frames = monitored(outputs[2:], config)
    assert len(frames) == 2
    for number, (frame, picture) in enumerate(zip(frames, pictures, strict=True)):
        assert np.array_equal(frame, doubled(config, picture)), f"frame {number}; {repeat()}"
    answers = {}
    assert check_bus(config, bus.stimulus, outputs) == len(bus.reads)
    for name, cycle in bus.reads.items():
        answers[name] = bus.registers[name].unpack(outputs[cycle]["avs_s0_readdata"])
    assert answers["status"] == {"busy": 0, "underrun": 0, "bad_rectangle": 0, "frame": 2}
    assert answers["cycles"]["group"] <= config.group_cycles
    assert answers["size"] == {"units": config.units, "rectangles": config.rectangles, "rows": config.rows}
    assert answers["engine"]["fraction_bits"] == config.fraction_bits


@pytest.mark.slow
@pytest.mark.parametrize(
    "config",
    [
        small_config(TINY_SCREEN, units=2, rectangles=3, reflections=1, divider_bits=2),
        small_config(TINY_SCREEN, engine="beam", rectangles=3, reflections=1, scale=2),
    ],
    ids=config_id,
)
def test_ray_caster_module_scenes(config, tmp_path):
    """A scene a frame over the bus, which is never idle: words are read back, and written in part.

    Some frames are black, as the module does not run.
    """
    screen = config.screen_geometry
    random = np.random.default_rng(seed())
    bus = Bus(config)
    bus.wait(2, reset=1)
    bus.wait(3, reset=0)
    pictures = []

    def traffic(until: int) -> None:
        while len(bus.stimulus) < until:
            name = str(random.choice([name for name in bus.registers if name != "control"]))
            if random.random() < 0.6:
                bus.read(name)
            else:
                bus.write_word(name, int(random.integers(1 << 32)), int(random.choice([1, 2, 4, 8, 3, 12, 15])))

    for number in range(40):
        scene = scene_in_view(random, config, number % 3)
        if number % 4 == 3:
            scene = without_one(random, config, scene)
        camera, table, background, reflections, words = scene
        run = random.random() < 0.9
        pictures.append(words * run)
        start = 2 + start_screen_cycle(screen) + number * screen.frame_cycles
        # Whatever is committed before the scene is never shown; whatever is written after it waits for a commit.
        traffic(start - screen.frame_cycles + int(random.integers(10, 400)))
        bus.write("control", run=1, commit=1, reflections=0)
        bus.read("status")
        traffic(start - int(random.integers(50, 290)))
        bus.write_scene(camera, background, reflections, table, run)
        traffic(start + 1)
    bus.wait(screen.frame_cycles)
    leaf = Leaf(ray_caster_module, lambda: {**module_ports(config), "config": config}, tmp_path)
    outputs = leaf.run_both(bus.stimulus, settled=2)
    assert check_bus(config, bus.stimulus, outputs) > 1000
    frames = monitored(outputs[2:], config)
    assert len(frames) == len(pictures)
    for number, (frame, picture) in enumerate(zip(frames, pictures, strict=True)):
        assert np.array_equal(frame, doubled(config, picture)), f"frame {number}; {repeat()}"


def test_scene_system(tmp_path):
    """A scene that loads itself, and the camera that buttons move from frame to frame."""
    config = small_config(TINY_SCREEN, units=2, rectangles=3, reflections=1, divider_bits=2)
    screen = config.screen_geometry
    slopes = primary_slopes(screen).reshape(-1, 3)
    random = np.random.default_rng(seed())
    frames, ready = 15, 5
    start = ready + 2 + HOLD_CYCLES  # the first cycle without reset
    for _ in range(2000):
        camera, table, background, *_ = scene_in_view(random, config, 0)
        table = Rectangles(table.corners, table.colours, np.ones(config.rectangles, dtype=bool))
        holds = np.repeat(random.integers(1 << len(BUTTONS), size=frames // 3), 3)
        positions = walk(camera, holds)
        pictures = [
            model_of(config).trace(table, position, background, slopes, config.reflections).colours
            for position in positions
        ]
        # Most of what is random looks the same from everywhere.
        if len({picture.tobytes() for picture in pictures}) > frames // 2:
            break
    else:
        raise AssertionError(f"no walk shows another picture in most frames; {repeat()}")
    scene = Scene(
        reflections=config.reflections,
        background=tuple(map(int, background)),
        camera=Camera(position=tuple(map(int, camera))),
        rect=tuple(
            Rectangle(corners=corners, colour="#{:02x}{:02x}{:02x}".format(*colour))
            for corners, colour in zip(table.corners.tolist(), table.colours, strict=True)
        ),
    )
    stimulus = [{"ready": 0, "buttons": 0}] * ready
    for number, held in enumerate(holds):
        # Until the cycle after StartScreen, where they count.
        until = start + start_screen_cycle(screen) + number * screen.frame_cycles + 2
        stimulus += [{"ready": 1, "buttons": int(held)}] * (until - len(stimulus))
    stimulus += [{"ready": 1, "buttons": 0}] * screen.frame_cycles
    leaf = Leaf(scene_system, lambda: {**scene_system_ports(config), "config": config, "scene": scene}, tmp_path)
    shown = monitored(leaf.run_both(stimulus, settled=ready)[start:], config)
    assert len(shown) == frames
    for number, (frame, picture) in enumerate(zip(shown, pictures, strict=True)):
        assert np.array_equal(frame, doubled(config, golden_words(config, picture))), f"frame {number}; {repeat()}"


def walk(camera: np.ndarray, holds: np.ndarray) -> list[np.ndarray]:
    """Where the camera is in each frame, with these buttons held at the StartScreen of each."""
    position, positions = camera, []
    for held in holds:
        positions.append(position)
        forward, back, left, right, up, down = (held >> place & 1 for place in range(len(BUTTONS)))
        target = position + STEP * np.array([forward - back, right - left, up - down])
        position = np.where((target >= 0) & (target < WORLD_SIZE), target, position)
    return positions
