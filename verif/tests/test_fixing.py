# SPDX-License-Identifier: MIT
"""Scenes built into the hardware: only unneeded parts are left out, and no pixel changes."""

from __future__ import annotations

import dataclasses
import itertools
import json
import os
import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT, SMALL_SCENE, Bench
from rich.console import Console

from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.design.for_scene import design_for
from raycaster.errors import UserError
from raycaster.fit.fixing import SCOPES, fix, fixed_rectangle
from raycaster.fit.unneeded import at_the_edge, covered, needed, unreachable, without_mirrors
from raycaster.fixed import FixedRectangle, FixedScene
from raycaster.fpga import fit as search
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.frames import runs_of, scene_rows
from raycaster.golden.world import Rectangles
from raycaster.registers import address_bits
from raycaster.rtl.engines import ENGINES, buffered_engine_of
from raycaster.scene import Camera, Rectangle, Scene, dump_scene, load_scene
from raycaster.sim.simulator import SimulationError
from raycaster.verif.random_scenes import random_scene
from raycaster.verif.seeds import seed

SCENES = ROOT / "raycaster" / "scenes"
BOXES = SCENES / "boxes.toml"
NOTHING = '[camera]\nposition = [9, 9, 9]\n[[rect]]\ncorners = [[0, 0, 0], [0, 9, 9]]\ncolour = "#ffffff"\n'
"""Scene of a rectangle that nobody sees."""


def scene_of(*corners, matte=(), **values) -> Scene:
    """Return a scene of differently coloured rectangles, seen from the middle of the world's near side."""
    rect = [{"corners": pair, "colour": f"#{number:06x}"} for number, pair in enumerate(corners, 1)]
    for index in matte:
        rect[index]["mirror"] = 0.0
    return Scene(**{"camera": {"position": (0, 255, 100)}, "rect": rect, **values})


WALL = ((300, 0, 0), (300, 511, 511))
WINDOW = ((300, 100, 100), (300, 200, 200))
FLOOR = ((0, 0, 0), (511, 511, 0))
NEAR = ((0, 0, 0), (0, 511, 511))


# Unneeded parts -------------------------------------------------------------------------------------------------------


def test_parts_that_no_ray_meets():
    """The earlier of two in a plane covers the later. Nothing runs to x = 0 that met no other mirror on x. Nothing is
    reflected where nothing mirrors."""

    def found(find, *corners, reflections=(), matte=()):
        return find(Rectangles.of_scene(scene_of(*corners, matte=matte)), *reflections)

    beside = ((300, 0, 0), (300, 200, 511)), ((300, 100, 100), (300, 201, 511))
    assert found(covered, WALL, FLOOR, WINDOW) == {2: 0}
    assert found(covered, WINDOW, FLOOR, WALL) == found(covered, *beside) == {}
    assert found(covered, FLOOR, FLOOR, FLOOR) == {1: 0, 2: 0}
    assert found(unreachable, NEAR, FLOOR, reflections=[1]) == [{0}, {0}]
    assert found(unreachable, NEAR, WALL, reflections=[2]) == [{0}, set(), set()]
    assert found(unreachable, WALL, FLOOR, reflections=[1]) == [set(), set()]
    assert found(unreachable, NEAR, WALL, reflections=[1], matte=[1]) == [{0}, {0}]
    assert found(unreachable, NEAR, WALL, reflections=[1], matte=[0]) == [{0}, set()]
    assert found(without_mirrors, WALL, FLOOR, reflections=[2], matte=[0]) == [set(), set(), set()]
    assert found(without_mirrors, WALL, FLOOR, reflections=[2], matte=[0, 1]) == [set(), {0, 1}, {0, 1}]


def test_a_turned_camera_looks_back(tmp_path):
    """A rectangle at x = 0 is kept if the camera can turn or sees it."""
    path = tmp_path / "back.toml"
    scene = scene_of(NEAR, WALL, FLOOR, camera={"position": (200, 250, 100), "yaw": 170})
    path.write_text(dump_scene(scene))
    rects, everything = (fix(path, {"screen": "tiny"}, scope).design.configuration for scope in SCOPES)
    assert (rects.engine, rects.turn, rects.passes) == ("exact", True, (0b111, 0b111))
    assert everything.fixed.basis == scene.camera.basis
    assert (0, 0) in [(one.axis, one.position) for one in everything.fixed.rectangles]
    # Without a camera that turns, primary rays never meet it.
    path.write_text(dump_scene(scene.model_copy(update={"camera": Camera(position=(200, 250, 100))})))
    assert fix(path, {"screen": "tiny"}, "rects").design.configuration.passes == (0b110, 0b111)


@pytest.mark.parametrize("engine", ENGINES)
def test_needed_rectangles_suffice(engine):
    """Removing the unneeded rectangles leaves the picture unchanged; removing any needed one changes it."""
    config = configure(engine=engine, screen="tiny", allow_underrun=True)
    scene = load_scene(BOXES)
    met = set().union(*needed(config, scene, 1)[0])
    model = model_of(config)
    picture = model.render(scene, config.screen_geometry, 1)

    def without(indices) -> np.ndarray:
        kept = tuple(rectangle for index, rectangle in enumerate(scene.rect) if index not in indices)
        return model.render(scene.model_copy(update={"rect": kept}), config.screen_geometry, 1)

    assert 3 <= len(met) < len(scene.rect)
    assert np.array_equal(without(set(range(len(scene.rect))) - met), picture)
    assert not any(np.array_equal(without({index}), picture) for index in met)


def test_random_cameras_need_nothing_that_was_left_out(random):
    """This holds for `rects` in random scenes with coplanar rectangles, some at x = 0, and with random cameras."""
    left_out = 0
    for _ in range(30):
        corners = random.choice([0, 60, 200, 400, 511], size=(8, 2, 3))
        flat = random.choice([0, 0, 1, 2], size=8)
        corners[np.arange(8), 1, flat] = corners[np.arange(8), 0, flat]
        position = random.choice([0, 100, 511], size=3).tolist()
        scene = scene_of(*corners.tolist(), camera={"position": position})
        for engine, reflections in itertools.product(ENGINES, (0, 1, 2)):
            config = configure(engine=engine, screen="tiny", reflections=reflections, allow_underrun=True)
            table = Rectangles.of_scene(scene)
            within, behind = set(covered(table)), unreachable(table, reflections)
            met, _ = needed(config, scene, reflections)
            for one, never in zip(met, behind, strict=True):
                assert not one & (within | never)
                left_out += len(within | never)
    assert left_out > 300


def test_shadows_need_no_more(random):
    """With random lights, rectangles that are neither seen nor shade are unneeded; those at the edge never shade."""
    config = configure(engine="exact", screen="tiny", reflections=1, materials=True, light=True, allow_underrun=True)
    shading, at_edge = 0, 0
    for number in range(20):
        scene = random_scene(int(random.integers(1 << 30)), 12, 1, ("materials", "light"))
        met, shades = needed(config, scene, 1)
        kept = set().union(*met, *shades)
        if scene.light is None or not kept:
            continue
        edge = at_the_edge(Rectangles.of_scene(scene))
        assert not edge & set().union(*shades), number
        shading, at_edge = shading + len(set().union(*shades)), at_edge + len(edge)
        fewer = scene.model_copy(update={"rect": tuple(scene.rect[index] for index in sorted(kept))})
        pictures = [ExactModel().render(one, config.screen_geometry) for one in (scene, fewer)]
        assert np.array_equal(*pictures), number
    assert min(shading, at_edge) > 5


# Fixed designs --------------------------------------------------------------------------------------------------------


def test_fixed_rectangles_are_in_order():
    rectangle = Rectangle(corners=((9, 300, 200), (500, 300, 7)), colour=(1, 2, 3))
    assert fixed_rectangle(rectangle) == FixedRectangle(1, 300, 9, 500, 7, 200, 0x010203)
    look = {"mirror": 0.25, "pattern": "rows", "colour2": (4, 5, 6), "cell": 64}
    assert fixed_rectangle(rectangle.model_copy(update=look)) == FixedRectangle(
        1, 300, 9, 500, 7, 200, 0x010203, mirror=1, kind=2, cell=3, colour_2=0x040506
    )


def test_units_are_as_few_as_possible():
    general, config = design_for(BOXES, {}).configuration, fix(BOXES, {}, "all").design.configuration
    assert (general.units, general.divider_bits, config.units, config.divider_bits) == (32, 1, 10, 3)
    assert buffered_engine_of(config).group_cycles(config) <= config.group_budget
    # Given options are kept.
    assert fix(BOXES, {"units": "40"}, "all").design.configuration.units == 40
    assert fix(BOXES, {"divider_bits": "1"}, "rects").design.configuration.divider_bits == 1
    # Too few units for an arbitrary scene may suffice for this one; the general design keeps all rectangles.
    fewer = fix(SCENES / "corners.toml", {"units": "20", "divider_bits": "1"}, "all")
    assert (fewer.design.configuration.units, fewer.general.configuration.rectangles) == (20, 12)


def test_a_list_holds_the_built_in_scene():
    """There is no entry to spare but one, as their number is even; a camera that moves may need the usual list."""
    options = {"engine": "span", "screen": "tiny"}
    design = fix(BOXES, options, "all").design
    runs = runs_of(scene_rows(design.scene, design.configuration))
    assert 0 <= design.configuration.list - runs <= 1
    usual = configure(**options).list
    assert fix(BOXES, options, "rects").design.configuration.list == usual > runs
    assert fix(BOXES, {**options, "list": "4000"}, "all").design.configuration.list == 4000


def test_passes_count_for_the_budget():
    rectangle = fixed_rectangle(load_scene(BOXES).rect[0])
    fixed = FixedScene((rectangle,) * 4, (0b0011, 0b1000))
    config = configure(fixed=fixed, units=32, divider_bits=1)
    assert buffered_engine_of(config).group_cycles(config) == (2 * 9 + 6) + (9 + 6) + 4
    with pytest.raises(UserError, match="for 1 reflections, not 2"):
        configure(fixed=fixed, reflections=2)


def test_names_differ_where_scenes_do(tmp_path):
    names = {fix(BOXES, {}, scope).design.configuration.name for scope in SCOPES}
    moved = tmp_path / "boxes.toml"
    moved.write_text(BOXES.read_text().replace("[5, 251, 113]", "[6, 251, 113]"))
    names |= {fix(moved, {}, scope).design.configuration.name for scope in SCOPES}
    assert len(names) == 3  # `rects` does not fix the camera


def test_omissions_say_why():
    def omissions(name, scope, **options):
        return dict(fix(SCENES / f"{name}.toml", options, scope).omissions)

    assert omissions("boxes", "all", screen="tiny")["ceiling"] == "no ray of the picture meets it first"
    assert "tests of the reflection against green slab, side" in omissions("floor", "all")


# Whole designs --------------------------------------------------------------------------------------------------------


MIRRORS = "facing_mirrors"
FRAMES = [
    *((engine, "boxes", scope, {}) for engine in ENGINES for scope in SCOPES),
    *(("exact", "lamplight", scope, {}) for scope in SCOPES),
    *((engine, MIRRORS, "all", {}) for engine in ENGINES),
    ("seed", MIRRORS, "all", {"fraction_bits": 2, "rounding": "nearest"}),
    *((engine, "nothing", "all", {}) for engine in ENGINES),
]


@pytest.mark.slow_sets(quick=["exact-lamplight-all"])
@pytest.mark.parametrize(
    ("engine", "name", "scope", "options"), FRAMES, ids=["-".join([*one[:3], *one[3]]) for one in FRAMES]
)
def test_no_pixel_changes(bench: Bench, tmp_path, engine, name, scope, options):
    """Scenes with a light, with two reflections, or with nothing in sight are among them."""
    scene = SCENES / f"{name}.toml"
    if name == "nothing":
        scene = tmp_path / scene.name
        scene.write_text(f'background = "#123456"\n{NOTHING}')
    design = fix(scene, {"engine": engine, "screen": "tiny", **options}, scope).design
    assert design.reflections == (2 if name == MIRRORS else 1)
    result = json.loads((bench("sim.frame_bench", design.configuration, "icarus", scene) / "result.json").read_text())
    assert result["wrong_vs_golden"] == 0
    if not (config := design.configuration).facts.whole_frames:
        assert result["worst_group_cycles"] <= buffered_engine_of(config).group_cycles(config)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_any_camera_may_look_at_fixed_rectangles(bench: Bench, tmp_path, engine):
    """The scene has coplanar rectangles and some at x = 0 that `rects` leaves out; a camera may be in any corner."""
    path, places = SCENES / "mirror_room.toml", list(itertools.product((0, 511), repeat=3))
    places += np.random.default_rng(seed()).integers(512, size=(24, 3)).tolist()
    paths = [tmp_path / f"{number}.toml" for number in range(len(places))]
    for one, place in zip(paths, places, strict=True):
        one.write_text(dump_scene(load_scene(path).model_copy(update={"camera": Camera(position=place)})))
    design = fix(path, {"engine": engine, "screen": "tiny"}, "rects").design
    given = os.pathsep.join(map(str, paths))
    bench("verif.soak.bench", design.configuration, "verilator", given, seeds=tuple(range(len(paths))))


@pytest.mark.slow_sets("all")
@pytest.mark.parametrize("scope", SCOPES)
def test_fixed_words_ignore_writes(bench: Bench, scope):
    assert address_bits(0) == 4
    design = fix(SMALL_SCENE, {"engine": "exact", "screen": "tiny"}, scope).design
    bench("verif.benches.fixed_bench", design.configuration, "icarus", SMALL_SCENE)


@pytest.mark.slow_sets("exact", "seed")
@pytest.mark.parametrize("engine", [name for name, engine in ENGINES.items() if not engine.facts.whole_frames])
def test_a_rectangle_wrongly_left_out_is_caught(bench: Bench, engine):
    """Only one pass lacks the rectangle, which is the smallest possible fault. Spans have the same in all passes."""
    config = fix(SMALL_SCENE, {"engine": engine, "screen": "tiny"}, "all").design.configuration
    primary, reflected = config.fixed.passes
    fewer = dataclasses.replace(config.fixed, passes=(primary, reflected & reflected - 1))
    assert fewer != config.fixed
    broken = dataclasses.replace(config, fixed=fewer)
    with pytest.raises(SimulationError, match="pixels are wrong"):
        bench("sim.frame_bench", broken, "icarus", SMALL_SCENE)


@pytest.mark.slow_sets("exact", "seed")
@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("engine", ENGINES)
def test_fixed_rectangles_have_no_memory(engine, scope, tmp_path):
    files = write_verilog(fix(BOXES, {"engine": engine}, scope).design.configuration, tmp_path / "verilog")
    names = {path.stem for path in files}
    assert not {"rect_mem", "rect_slot", "rect_sorter"} & names
    assert ("camera_mem" in names) == (scope == "rects")


# Smallest designs -----------------------------------------------------------------------------------------------------


def test_the_least_fraction_that_meets_an_error():
    """The search finds it for each rounding; engines that do not round have no error."""
    options = {"screen": "tiny"}
    found = list(search.candidates(BOXES, options, ("all",), 0.001))
    seeds = [one for one in found if one.configuration.engine == "seed" and one.scope == "all"]
    assert {one.configuration.rounding for one in seeds} == {"truncate", "nearest"}
    for one in seeds:
        assert 0 <= one.error <= 0.001
        less = {**one.options, "fraction_bits": one.configuration.fraction_bits - 1, "allow_underrun": True}
        assert one.configuration.fraction_bits == 0 or search.error_of(design_for(BOXES, less)) > 0.001
    assert [one.error for one in found if one.configuration.engine != "seed"] == 2 * (len(ENGINES) - 1) * [0]
    assert [one.scope for one in found] == len(found) // 2 * ["general", "all"]
    # An engine given as an option is the only candidate.
    assert {one.configuration.engine for one in search.candidates(BOXES, {"engine": "span"}, (), None)} == {"span"}


@pytest.mark.slow
def test_units_and_lists_that_a_scene_takes():
    """The fewest units that draw a frame in time, by the model; more runs than a list holds are known beforehand."""
    options = {"engine": "span", "rows": 240, "scale": 1}
    mirrors = SCENES / f"{MIRRORS}.toml"
    [found] = search.candidates(mirrors, options, (), None)
    config, scene = found.configuration, found.design.scene
    cycles = [search.cycles_a_frame(replace(config, units=units), scene) for units in range(1, config.units + 1)]
    assert [count <= config.screen_geometry.frame_cycles for count in cycles] == [False] * (config.units - 1) + [True]
    assert found.options["units"] == config.units > 1
    runs = runs_of(scene_rows(scene, config))
    assert found.options.keys() == {*options, "units"}
    [found] = search.candidates(mirrors, {**options, "list": str(runs + runs % 2)}, (), None)
    assert found.configuration.list == runs + runs % 2
    with pytest.raises(UserError, match=f"{MIRRORS}.toml: a frame has {runs:,} runs of one colour"):
        list(search.candidates(mirrors, {**options, "list": str(runs // 2 * 2 - 2)}, (), None))


@pytest.mark.slow
def test_more_rectangles_than_the_default_has(tmp_path):
    """The general design then has a larger table."""
    scene, text = tmp_path / "many.toml", BOXES.read_text()
    scene.write_text(f"{text}[[rect]]{text.split('[[rect]]')[1]}")
    found = list(search.candidates(scene, {"screen": "tiny"}, ("all",), None))
    assert {one.configuration.rectangles for one in found if one.scope == "general"} == {13}
    assert max(one.configuration.rectangles for one in found if one.scope == "all") <= 12


@pytest.mark.slow
def test_the_smallest_is_found(tmp_path, capfd):
    """The complete search works on a small scene and one engine."""
    output = tmp_path / "fit"
    console = Console(width=120)
    search.search(SMALL_SCENE, {"engine": "exact", "screen": "tiny"}, "all", None, output, console)
    shown = capfd.readouterr().out
    assert re.search(r"exact +all .* fit", shown)
    assert "rectangles are constants" in shown
    assert f"to build it: raycaster verilog {SMALL_SCENE} --engine exact --screen tiny --fix all" in shown.replace(
        "\n", ""
    )
