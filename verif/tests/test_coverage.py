# SPDX-License-Identifier: MIT
"""Coverage: counts are read and added up; holes are reported, and explanations without a hole."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import BUILD, SMALL_SCENE
from definition import Vector, follow, is_lit, plane_of
from rich.console import Console

from raycaster.configuration import Configuration, configure
from raycaster.errors import UserError
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import Scene, dump_scene, load_scene
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, convert, run_bench
from raycaster.verif.coverage.code import Explanation, Judgement, describe, judge, load_explanations, read_counts
from raycaster.verif.coverage.functional import (
    HITS,
    INTERSECTIONS,
    PROBES,
    RAYS,
    SHAPE,
    Cross,
    FunctionalCoverage,
    read_bins,
)
from raycaster.verif.coverage.lighting import HIT_POINTS, count_hit_points
from raycaster.verif.coverage.measure import (
    DESIGNS,
    EXTRA_SCENES,
    FLAGS,
    Run,
    export_code,
    run_all,
    show_code,
    show_functional,
    verdict,
)
from raycaster.verif.random_scenes import random_scene

SOURCE = """module counter (clk, on, value);
always @(posedge clk) begin
    if (on) begin
        value <= value + 1;
"""
NOTHING = Judgement({}, [], [])
(EXTRA_SCENE,) = (path for path in EXTRA_SCENES if path.stem == "extra_scene")


def record(directory: Path, count: int, **fields: object) -> str:
    """Format a line as Verilator does."""
    values = {"f": directory / "counter.v", "l": 3, "n": 5, "page": "v_x/counter", "h": "bench.dut"} | fields
    return "C '" + "".join(f"\1{name}\2{value}" for name, value in values.items()) + f"' {count}"


@pytest.fixture
def counts(tmp_path):
    """Counts with a branch not taken, a condition not met and three edges not seen, in two files of a run."""
    (tmp_path / "counter.v").write_text(SOURCE)
    lines = [
        record(tmp_path, 7, t="branch", o="if", S="3-4"),
        record(tmp_path, 0, t="branch", o="else", n=6),
        record(tmp_path, 0, t="expr", o="(on==0) => 0"),
        record(tmp_path, 4, t="toggle", l=1, o="value[0]:0->1"),
        record(tmp_path, 0, t="toggle", l=1, o="value[0]:1->0"),
        record(tmp_path, 0, t="toggle", l=1, o="value[15]:0->1"),
        record(tmp_path, 0, t="toggle", l=1, o="on:1->0"),
        record(tmp_path, 0, t="toggle", o="sample:1->0", page="v_toggle/bench"),
    ]
    path = tmp_path / "coverage.dat"
    path.write_text("# SystemC::Coverage-3\n" + "\n".join(lines) + "\n")
    more = tmp_path / "more.dat"
    more.write_text(record(tmp_path, 2, t="toggle", l=1, o="value[0]:1->0") + "\n")
    return read_counts(path, ["bench"]) + read_counts(more), read_counts(path, ["bench"])


def explanation(**fields: str) -> Explanation:
    return Explanation(module="count.*", reason="because", **fields)


EXPLAINED = [
    explanation(code="^else: if .on. begin$"),
    explanation(code="on==0"),
    explanation(signal="value", bits="0, 14-15"),
    explanation(signal="on", edge="1->0"),
]


def test_counts_are_read(counts):
    """Every point has its source line; points of the bench are left out."""
    _, alone = counts
    assert {(point.kind, point.what): times for point, times in alone.items()} == {
        ("branch", "if: if (on) begin"): 7,
        ("branch", "else: if (on) begin"): 0,
        ("expr", "(on==0) => 0"): 0,
        ("toggle", "value[0]:0->1"): 4,
        ("toggle", "value[0]:1->0"): 0,
        ("toggle", "value[15]:0->1"): 0,
        ("toggle", "on:1->0"): 0,
    }
    assert {point.toggle for point in alone if point.toggle} == {
        ("value", 0, "0->1"), ("value", 0, "1->0"), ("value", 15, "0->1"), ("on", None, "1->0"),
    }  # fmt: skip


def test_an_unexplained_hole_fails(counts, capsys):
    """The hole is reported with its file and line, and bits of one signal together."""
    _, alone = counts
    judgement = judge(alone, EXPLAINED[1:2])
    assert describe(judgement.unexplained) == [
        "counter.v:1: on: 1->0",
        "counter.v:1: value: [0] 1->0, [15] 0->1",
        "counter.v:3: else: if (on) begin",
    ]
    assert len(judgement.explained) == 1 and not judgement.stale
    assert verdict(judgement, 0, []) == 1
    show_code(alone, judgement, Console(width=120))
    shown = capsys.readouterr().out
    assert "not covered: counter.v:1: value: [0] 1->0, [15] 0->1" in shown
    assert "1 / 2  50.0 %" in shown and "1 / 4  25.0 %" in shown


def test_a_stale_explanation_fails(counts):
    """An explanation is stale if no hole needs it, or if one of its bits is covered or does not exist."""
    _, alone = counts
    for extra in (explanation(signal="velocity"), explanation(code="never"), explanation(signal="value", edge="0->9")):
        assert len(judge(alone, [*EXPLAINED, extra]).stale) == 2, "that, and bit 14"
    judgement = judge(alone, EXPLAINED)
    assert not judgement.unexplained
    assert judgement.stale == ["count.*: value[0, 14-15] (because): bits 14"]
    assert verdict(judgement, 0, []) == 1


def test_runs_add_up(counts, tmp_path):
    """A point that any run covers is no hole; with all others explained, the verdict is good."""
    together = counts[1] + counts[0]
    together.update(dict.fromkeys(counts[1], 0))
    judgement = judge(together, [*EXPLAINED[:2], explanation(signal="value", bits="15"), EXPLAINED[3]])
    assert judgement.unexplained == [] and judgement.stale == []
    assert verdict(judgement, 0, []) == 0
    export_code(together, judgement, tmp_path / "code.json")
    written = json.loads((tmp_path / "code.json").read_text())
    assert written["modules"] == {"counter": {"lines": [1, 2], "conditions": [0, 1], "toggles": [2, 4]}}
    assert [hole["reason"] for hole in written["holes"]] == ["because"] * 4


@pytest.mark.parametrize(
    "text", ["", "[[hole]]\nmodule = 'm'\nreason = 'r'", "[[hole]]\nmodule = 'm'\nsignal = 's'", "hole = ["]
)
def test_bad_explanations_are_refused(tmp_path, text):
    """The error names the file."""
    path = tmp_path / "holes.toml"
    path.write_text(text)
    with pytest.raises(UserError, match=r"holes\.toml"):
        load_explanations("seed", path)


def test_the_explanations_can_be_read():
    """Every explanation has a reason."""
    every = {one for engine in DESIGNS for one in load_explanations(engine)}
    assert all(len(explanation.reason) > 5 for explanation in every)


def test_explanations_name_existing_modules(output):
    """Every explanation needs a design that has its module, as it has no effect elsewhere."""
    every, there = set(), set()
    for engine, design in DESIGNS.items():
        modules, mine = {path.stem for path in convert(design, output)}, set(load_explanations(engine))
        fitting = {one for one in mine if any(re.fullmatch(one.module, module) for module in modules)}
        assert {one for one in mine if one.engine is not None} <= fitting
        every, there = every | mine, there | fitting
    assert every == there


@pytest.mark.slow
def test_verilator_counts(output):
    """A small design, from the model to the counts."""
    configuration = configure(screen="tiny", units=2, rectangles=1, reflections=0, divider_bits=3)
    small = load_scene(SMALL_SCENE)
    one = output / "one.toml"
    one.write_text(dump_scene(small.model_copy(update={"rect": small.rect[1:2]})))
    # Not optimised, as compiling takes longer than running.
    model = build_model(configuration, build=BUILD, flags=(*FLAGS, "-CFLAGS", "-O0"))
    counts, failures, _ = run_all(model, [Run("sim.frame_bench", one, 0)], output / "runs", 1, Console())
    assert failures == []
    modules = {point.module for point in counts}
    assert {"ray_caster_module", "divider_step", "scene_word"} <= modules
    assert not [module for module in modules if module.startswith(("bench", "line_sink"))]
    seen = {(point.module, point.what) for point, times in counts.items() if times}
    assert {("z_buffer", "found:0->1"), ("divider", "quotient[0]:1->0")} <= seen
    holes = {(point.module, point.what) for point in judge(counts, []).unexplained}
    # No interrupt is enabled, and with one rectangle nothing is nearer.
    assert {("avalon_interface", "irq_enable:0->1"), ("ray_caster_module", "irq:0->1")} <= holes
    assert ("avalon_interface", "if: if (progress_underrun) begin") in holes
    assert any(module == "z_buffer" and "depth < nearest" in what for module, what in holes)


SMALL = {"screen": "tiny", "units": 16, "rectangles": 7, "reflections": 2, "allow_underrun": True}


def counted(scene: Scene, config: Configuration) -> np.ndarray:
    """Count all intersections in the golden model as `read_bins` does, including those that culling would skip."""
    rectangles = Rectangles.of_scene(scene)
    slopes = primary_slopes(config.screen_geometry).reshape(-1, 3)
    position, background = scene.camera.position, scene.background
    divides = config.facts.divides
    traced = model_of(config).trace(rectangles, position, background, slopes, scene.reflections, keep=True)
    counts = np.zeros(np.prod(SHAPE), dtype=np.int64)
    for number, bounce in enumerate(traced.bounces):
        # Rays that have missed before are not counted.
        alive = bounce.alive
        nearest = np.full(alive.sum(), Fraction(1 << 40), dtype=object)
        found = np.zeros(alive.sum(), dtype=bool)
        for index in np.flatnonzero(rectangles.visible):
            axis = rectangles.axes[index]
            extent = list(OTHER_AXES[axis])
            numerator, slope = bounce.numerators[index][alive], bounce.denominators[index][alive]
            hit, depth, point = (values[index][alive] for values in (bounce.hits, bounce.depths, bounce.points))
            bounds = np.stack([rectangles.low[index], rectangles.high[index]])[:, extent]
            if divides:
                bounds = np.broadcast_to(bounds << config.fraction_bits, (len(slope), *bounds.shape))
                behind, fourth = np.sign(numerator) != np.sign(slope), ~bounce.valid[index][alive].all(axis=1)
            else:
                # Points and depths are fractions over the slope; n already includes its sign.
                bounds = bounds * slope[:, None, None]
                within = ((bounds[:, 0] <= point[:, extent]) & (point[:, extent] <= bounds[:, 1])).all(axis=1)
                behind, fourth = numerator < 0, within & ~hit
                depth = np.array([Fraction(int(n), int(e) or 1) for n, e in zip(depth, slope, strict=True)])
            on_bound = (point[:, None, extent] == bounds).any(axis=(1, 2))
            signs = np.sign(bounce.slopes[alive, axis])
            result = np.select(
                [slope == 0, numerator == 0, behind], [0, 1, 2], np.select([fourth, ~hit, on_bound], [3, 4, 5], 6)
            )
            rank = np.select([~hit, ~found, depth < nearest, depth == nearest], [0, 1, 2, 3], 4)
            places = np.ravel_multi_index((axis, signs + 1, result, rank, number), SHAPE)
            counts += np.bincount(places, minlength=counts.size)
            nearest = np.where(hit, np.minimum(nearest, depth), nearest)
            found |= hit
    return counts.reshape(SHAPE)


@pytest.mark.parametrize(
    "options",
    [
        {"divider_bits": 2},
        pytest.param({"divider_bits": 2, "culling": False}, marks=pytest.mark.slow),
        pytest.param({"divider_bits": 2, "culling": False, "fraction_bits": 3}, marks=pytest.mark.slow),
        {"engine": "exact", "culling": True},
        {"engine": "exact", "culling": False, "light": True},
        {"engine": "beam", "units": None, "rectangles": 12, "scale": 1, "allow_underrun": False},
    ],
)
def test_the_hardware_counts_its_intersections(output, options):
    """Without culling, counts are the golden model's own; with it, all hits, fewer misses, and no impossible bin."""
    config = configure(**SMALL | options)
    model = build_model(config, build=BUILD, verilog=[*convert(config, BUILD), *PROBES[config.engine]])
    cross = INTERSECTIONS[config.engine]
    hits, total = [cross.points["result"].index(name) for name in HITS], 0
    # Without a line buffer, a row is recomputed for each of its lines.
    lines = 1 if config.facts.line_buffered else config.screen_geometry.doubling
    # No random scene has two rectangles at equal depth, which would expose a wrong comparison, so add one that has.
    scenes = {
        f"seed {seed}": random_scene(seed, config.rectangles, config.reflections, config.looks) for seed in range(4)
    }
    for name, scene in (scenes | {"extra": load_scene(EXTRA_SCENE)}).items():
        directory = output / f"{config.name}-{name}"
        directory.mkdir(parents=True)
        (directory / "scene.toml").write_text(dump_scene(scene))
        job = Job(config, scene=str(directory / "scene.toml"), output=str(directory))
        run_bench(model, "raycaster.sim.frame_bench", job, directory)
        found, expected = read_bins(directory), lines * counted(scene, config)
        if config.culling:
            assert np.array_equal(found[:, :, hits], expected[:, :, hits]), name
            assert (found <= expected).all() and found.sum() < expected.sum(), name
            FunctionalCoverage(cross).add(found)
        else:
            assert np.array_equal(found, expected), name
        total += found[:, :, hits].sum()
    assert total > 1000


def place_of(bins: Sequence[str], cross: Cross = INTERSECTIONS["seed"]) -> tuple[int, ...]:
    return tuple(values.index(name) for values, name in zip(cross.points.values(), bins, strict=True))


def test_bins_that_were_not_hit_are_reported(tmp_path, capsys):
    """Primary rays hit only primary bins; every other possible bin is a hole and makes the command fail."""
    functional = FunctionalCoverage()
    counts = np.zeros(SHAPE, np.int64)
    bins = "z", "negative", "hit", "first", "primary"
    counts[place_of(bins)] = 7
    functional.add(counts)
    functional.add(counts)
    holes = set(functional.holes)
    assert bins not in holes
    assert ("z", "negative", "hit", "first", "second") in holes
    assert verdict(NOTHING, len(holes), []) == 1
    show_functional(functional, 1, Console(width=120))
    assert "not hit: z, negative, hit, first, second" in capsys.readouterr().out
    functional.export(tmp_path / "functional")
    written = json.loads((tmp_path / "functional.json").read_text())
    assert written["bins"] - written["covered"] == len(holes)
    assert written["bins"] + sum(written["ignored"].values()) == np.prod(SHAPE)
    assert all(written["ignored"][reason] > 0 for reason in INTERSECTIONS["seed"].impossible)
    cross = ElementTree.parse(tmp_path / "functional.xml").find("raycaster/intersections")
    assert cross.get("coverage") == str(written["covered"]) == "1"
    points = ElementTree.parse(tmp_path / "functional.xml").find("raycaster/axis")
    assert sum(int(found.get("hits")) for found in points) == sum(hits[-1] for hits in written["hits"]) == 14


def test_an_impossible_bin_must_not_be_hit():
    """A hit in such a bin means that the list is wrong."""
    for cross, bins in (
        (INTERSECTIONS["seed"], ("x", "zero", "parallel", "none", "primary")),
        (HIT_POINTS, ("x", "lit", "inside", "primary")),
        (HIT_POINTS, ("y", "shaded", "beyond point", "first")),
        (HIT_POINTS, ("z", "facing away", "edge", "second")),
    ):
        counts = np.zeros(cross.shape, np.int64)
        counts[place_of(bins, cross)] = 3
        with pytest.raises(ValueError, match=f"{', '.join(bins)}: declared impossible, but found 3"):
            FunctionalCoverage(cross).add(counts)


def test_the_extra_scene_hits_its_bin():
    """The scene has ties on an edge in a second reflection along negative x."""
    scene = load_scene(EXTRA_SCENE)
    bins = "x", "negative", "edge", "tie", "second"
    assert counted(scene, configure(reflections=scene.reflections))[place_of(bins)] >= 10


def kind_of(table: Rectangles, light: Vector, index: int, point: Vector, slope: Vector) -> tuple[str, str]:
    """Return the bins of a hit point for `light` and `passes`, by the definition."""
    plane = plane_of(table, index)
    if light[plane] == point[plane]:
        return "in plane", "none"
    if (light[plane] - point[plane]) * slope[plane] > 0:
        return "facing away", "none"
    passed = ["none"]
    for other in set(range(len(table))) - {index}:
        across = plane_of(table, other)
        if across is None or point[across] == light[across]:
            continue
        low, high = table.low[other].tolist(), table.high[other].tolist()
        t = Fraction(low[across] - light[across]) / (point[across] - light[across])
        sides = [(low[i], light[i] + (point[i] - light[i]) * t, high[i]) for i in range(3) if i != across]
        if all(first <= at <= last for first, at, last in sides):
            edge = any(at in (first, last) for first, at, last in sides)
            where = {t < 0: "behind light", t == 0: "at light", t == 1: "at point", t > 1: "beyond point"}
            passed.append(where.get(True, "edge" if edge else "inside"))
    kinds = HIT_POINTS.points["passes"]
    return "lit" if is_lit(table, light, index, point, slope) else "shaded", max(passed, key=kinds.index)


def test_hit_points_are_counted_by_the_definition():
    """Counts in the golden model are those of fractions; the scenes have hit points of every kind."""
    config, kinds = configure(screen="tiny", engine="exact", light=True, reflections=2), set()
    for seed in (5, 16, 179):
        scene = random_scene(seed, 7, 2, ["light"])
        table, expected = Rectangles.of_scene(scene), Counter()
        for slope in primary_slopes(config.screen_geometry).reshape(-1, 3).tolist():
            path = follow(table, scene.background, scene.camera.position, slope, scene.reflections, scene.light)
            for ray, stop in zip(RAYS, path, strict=False):
                if stop.winner >= 0:
                    axis, point = plane_of(table, stop.winner), stop.points[stop.winner]
                    kind = kind_of(table, scene.light.position, stop.winner, point, slope)
                    expected["xyz"[axis], *kind, ray] += 1
                    slope[axis] *= -1
        counts = count_hit_points(scene, config)
        found = {HIT_POINTS.bins_at(place): int(counts[tuple(place)]) for place in np.argwhere(counts)}
        assert found == expected, scene.title
        kinds |= {bins[1:3] for bins in expected}
    assert kinds == {bins[1:3] for bins in FunctionalCoverage(HIT_POINTS).bins}
