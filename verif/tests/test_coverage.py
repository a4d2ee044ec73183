# SPDX-License-Identifier: MIT
"""Coverage: counts are read and added up; holes are reported, and explanations without a hole."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import BUILD, SMALL_SCENE
from definition import Stop, Vector, follow, is_lit, plane_of
from rich.console import Console

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import Camera, Rectangle, Scene, dump_scene, load_scene
from raycaster.sim.simulator import build_model, convert
from raycaster.verif.coverage.code import EVERY, Explanation, Judgement, describe, judge, load_explanations, read_counts
from raycaster.verif.coverage.functional import RAYS, Cross, FunctionalCoverage, traces
from raycaster.verif.coverage.intersections import INTERSECTIONS, count_intersections, cross_of
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


def record(directory: Path, count: int, **fields: object) -> str:
    """Format a line as Verilator does."""
    values = {"f": directory / "counter.v", "l": 3, "n": 5, "page": "v_x/counter", "h": "bench.dut"} | fields
    return "C '" + "".join(f"\1{name}\2{value}" for name, value in values.items()) + f"' {count}"


@pytest.fixture
def counts(tmp_path):
    """Counts of a run with a branch not taken, a condition not met and three edges not seen."""
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
    return read_counts(path, ["bench"])


def explanation(what: str) -> Explanation:
    return Explanation(EVERY, f"count.*: {what}", "because")


EXPLAINED = [*map(explanation, ("/^else: if .on. begin$/", "/on==0/", "value [0, 14-15]", "on 1->0"))]


def test_an_unexplained_hole_fails(counts, capsys):
    """The hole is reported with its file and line, and bits of one signal together."""
    judgement = judge(counts, EXPLAINED[1:2])
    assert describe(judgement.unexplained) == [
        "counter.v:1: on: 1->0",
        "counter.v:1: value: [0] 1->0, [15] 0->1",
        "counter.v:3: else: if (on) begin",
    ]
    assert len(judgement.explained) == 1 and not judgement.stale
    assert verdict(judgement, 0, []) == 1
    show_code(counts, judgement, Console(width=120))
    shown = capsys.readouterr().out
    assert "not covered: counter.v:1: value: [0] 1->0, [15] 0->1" in shown
    assert "1 / 2  50.0 %" in shown and "1 / 4  25.0 %" in shown


def test_a_stale_explanation_fails(counts):
    """An explanation is stale if no hole needs it, or if one of its bits is covered or does not exist."""
    for extra in ("velocity", "/never/", "value [0] 0->1"):
        assert len(judge(counts, [*EXPLAINED, explanation(extra)]).stale) == 2, "that, and bit 14"
    judgement = judge(counts, EXPLAINED)
    assert not judgement.unexplained
    assert judgement.stale == ["count.*: value [0, 14-15] (because): bits 14"]
    assert verdict(judgement, 0, []) == 1


def test_a_constant_explains_its_bits(counts):
    """Bits that are 0 never change, and those that are 1 never fall; a change of another bit is an error."""
    judgement = judge(counts, [*EXPLAINED[:2], explanation("value = 1"), explanation("on = 1")])
    assert not judgement.unexplained and not judgement.stale
    judgement = judge(counts, [*EXPLAINED[:2], explanation("value = 32768"), explanation("on = 1")])
    assert describe(judgement.unexplained) == ["counter.v:1: value: [15] 0->1"]
    assert judgement.stale == ["count.*: value = 32768 (because): value[0]:0->1 was hit"]


def test_runs_add_up(counts, tmp_path):
    """A point that any run covers is no hole; with all others explained, the verdict is good."""
    more = tmp_path / "more.dat"
    more.write_text(record(tmp_path, 2, t="toggle", l=1, o="value[0]:1->0") + "\n")
    counts.update(read_counts(more))
    judgement = judge(counts, [*EXPLAINED[:2], explanation("value [15]"), EXPLAINED[3]])
    assert judgement.unexplained == [] and judgement.stale == []
    assert verdict(judgement, 0, []) == 0
    export_code(counts, judgement, tmp_path / "code.json")
    written = json.loads((tmp_path / "code.json").read_text())
    assert written["modules"] == {"counter": {"lines": [1, 2], "conditions": [0, 1], "toggles": [2, 4]}}
    assert [hole["reason"] for hole in written["holes"]] == ["because"] * 4


@pytest.mark.parametrize(
    "text", ["hole = [", "[seed]\nr = 'm: s'", "[beam]\nr = ['m: ']", "[seed]\nr = ['m: s 0->9']", "seed = 3"]
)
def test_bad_explanations_are_refused(tmp_path, text):
    """The error names the file."""
    path = tmp_path / "holes.toml"
    path.write_text(text)
    with pytest.raises(UserError, match=r"holes\.toml"):
        load_explanations("seed", path)


def test_explanations_name_existing_modules(output):
    """Every explanation needs a design that has its module, as it has no effect elsewhere."""
    every, there = set(), set()
    for engine, design in DESIGNS.items():
        modules, mine = {path.stem for path in convert(design, output)}, set(load_explanations(engine))
        fitting = {one for one in mine if one.is_in(modules)}
        assert {one for one in mine if one.engines != EVERY} <= fitting
        every, there = every | mine, there | fitting
    assert every == there
    assert all(len(explanation.reason) > 5 for explanation in every)


@pytest.mark.slow
def test_verilator_counts(output):
    """A small design, from the model to the counts."""
    configuration = configure(screen="tiny", units=2, rectangles=1, reflections=0, divider_bits=3)
    small = load_scene(SMALL_SCENE)
    one = output / "one.toml"
    one.write_text(dump_scene(small.model_copy(update={"rect": small.rect[1:2]})))
    # Not optimised, as compiling takes longer than running.
    model = build_model(configuration, build=BUILD, flags=(*FLAGS, "-CFLAGS", "-O0"))
    counts, failures = run_all(model, [Run("sim.frame_bench", one, 0)], output / "runs", 1, Console())
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


def place_of(bins: Sequence[str], cross: Cross = INTERSECTIONS["seed"]) -> tuple[int, ...]:
    return tuple(values.index(name) for values, name in zip(cross.points.values(), bins, strict=True))


def test_bins_that_were_not_hit_are_reported(tmp_path, capsys):
    """Primary rays hit only primary bins; every other possible bin is a hole and makes the command fail."""
    seed = INTERSECTIONS["seed"]
    functional, bins = FunctionalCoverage(seed), ("z", "negative", "hit", "first", "primary")
    counts = np.zeros(seed.shape, np.int64)
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
    assert written["bins"] + sum(written["ignored"].values()) == np.prod(seed.shape)
    assert all(written["ignored"][reason] > 0 for reason in seed.impossible)
    cross = ElementTree.parse(tmp_path / "functional.xml").find("raycaster/intersections")
    assert cross.get("coverage") == str(written["covered"]) == "1"
    points = ElementTree.parse(tmp_path / "functional.xml").find("raycaster/axis")
    assert sum(int(found.get("hits")) for found in points) == sum(hits[-1] for hits in written["hits"]) == 14


@pytest.mark.parametrize(
    ("cross", "bins"),
    [
        (INTERSECTIONS["seed"], ("x", "zero", "parallel", "none", "primary")),
        (HIT_POINTS, ("x", "lit", "inside", "primary")),
        (HIT_POINTS, ("y", "shaded", "beyond point", "first")),
        (HIT_POINTS, ("z", "facing away", "edge", "second")),
    ],
)
def test_an_impossible_bin_must_not_be_hit(cross, bins):
    """A hit in such a bin means that the list is wrong."""
    counts = np.zeros(cross.shape, np.int64)
    counts[place_of(bins, cross)] = 3
    with pytest.raises(ValueError, match=f"{', '.join(bins)}: declared impossible, but found 3"):
        FunctionalCoverage(cross).add(counts)


@pytest.mark.parametrize(
    ("engine", "stem", "wanted"),
    [
        ("seed", "extra_scene", [("x", "negative", "edge", "tie")]),
        ("exact", "extra_ties", [("z", "positive", "hit", "tie"), ("z", "positive", "edge", "farther")]),
    ],
)
def test_extra_scenes_hit_their_bins(engine, stem, wanted):
    """The scenes have intersections of second reflections that random scenes rarely have."""
    (scene,) = (load_scene(path) for path in EXTRA_SCENES if path.stem == stem)
    counts = count_intersections(scene, configure(engine=engine, reflections=2))
    assert all(counts[place_of((*bins, "second"), INTERSECTIONS[engine])] >= 10 for bins in wanted)


@pytest.mark.parametrize("engine", INTERSECTIONS)
def test_a_hit_ranks_against_the_nearest_one(engine):
    """The third wall is farther than the first, though it is nearer than the second."""
    walls = tuple(Rectangle(corners=((x, 0, 0), (x, 511, 511)), colour=(0, 0, 0)) for x in (100, 300, 200))
    scene = Scene(background=(0, 0, 0), camera=Camera(position=(20, 256, 100)), rect=walls)
    counts = count_intersections(scene, configure(engine=engine, screen="tiny"))
    ranks = dict(zip(INTERSECTIONS[engine].points["rank"], counts.sum(axis=(0, 1, 2, 4)).tolist(), strict=True))
    assert ranks["first"] < ranks["farther"]
    assert ranks["nearer"] == ranks["tie"] == 0


def test_the_seed_engine_gives_rectangles_up():
    """With culling only, no ray is in a bin of a rectangle that its group gives up; hits are the same."""
    options = {"screen": "tiny", "units": 16, "rectangles": 7, "reflections": 2, "divider_bits": 2}
    culling, plain = (configure(**options, allow_underrun=True, culling=culling) for culling in (True, False))
    cross = INTERSECTIONS["seed"]
    behind = cross.points["result"].index("behind")
    for seed in (3, 5):
        scene = random_scene(seed, 7, 2, culling.looks)
        with_culling, every = count_intersections(scene, culling), count_intersections(scene, plain)
        FunctionalCoverage(cross).add(with_culling)
        assert with_culling[:, :, behind, :, 0].sum() == 0 < every[:, :, behind, :, 0].sum()
        hits = slice(cross.points["result"].index("edge"), None)
        assert np.array_equal(with_culling[:, :, hits], every[:, :, hits])
        assert (with_culling <= every).all() and with_culling.sum() > 3000


def test_a_rectangle_that_the_culler_leaves_out_is_not_counted():
    """With culling, a rectangle counts for the primary rays of a group if one of them hits it, in the picture."""
    scene = load_scene(SMALL_SCENE)
    scene = scene.model_copy(update={"rect": scene.rect[-1:], "reflections": 0})
    config = configure(engine="exact", screen="tiny", units=16, rectangles=1, reflections=0, culling=True)
    drawn = np.concatenate([trace.winners[0] == 0 for _, trace in traces(scene, config)])
    groups = drawn.reshape(-1, config.units).any(axis=1)
    assert 0 < groups.sum() < len(groups)
    assert count_intersections(scene, config).sum() == groups.sum() * config.units
    # Without culling, primary rays of this design run away from some planes; with it, none is counted for them.
    culling, plain = (configure(engine="exact", screen="tiny", culling=culling) for culling in (True, False))
    busy = random_scene(3, culling.rectangles, 1, culling.looks)
    FunctionalCoverage(cross_of(culling)).add(count_intersections(busy, culling))
    FunctionalCoverage(cross_of(plain)).add(count_intersections(busy, plain))
    with pytest.raises(ValueError, match="primary: declared impossible"):
        FunctionalCoverage(cross_of(culling)).add(count_intersections(busy, plain))


def crossing(table: Rectangles, index: int, origin: Vector, slope: Vector, t: Fraction) -> tuple[bool, bool]:
    """Say whether a line is within a rectangle's bounds at t, and whether on one of them."""
    ends = zip(table.low[index].tolist(), origin, slope, table.high[index].tolist(), strict=True)
    sides = [(low, o + d * t, high) for axis, (low, o, d, high) in enumerate(ends) if axis != plane_of(table, index)]
    return all(low <= at <= high for low, at, high in sides), any(at in (low, high) for low, at, high in sides)


def intersections_of(table: Rectangles, stop: Stop, origin: Vector, slope: Vector, travelled: Fraction):
    """Yield the bins of a ray and each rectangle, by the definition; the ray's path already is as long as travelled."""
    nearest = None
    for index, point in enumerate(stop.points):
        axis = plane_of(table, index)
        if axis is None or slope[axis] == 0:
            if axis is not None:
                yield "xyz"[axis], "zero", "parallel", "none"
            continue
        t = Fraction(table.low[index].tolist()[axis] - origin[axis]) / slope[axis]
        within, edge = crossing(table, index, origin, slope, t)
        result, rank = "before mirror" if within else "miss", "none"
        if t + travelled <= 0:
            result = "on plane" if t + travelled == 0 else "behind"
        elif point is not None:
            ranks = {nearest is None: "first", nearest == t: "tie"}
            rank = ranks.get(True) or ("nearer" if t < nearest else "farther")
            result, nearest = "edge" if edge else "hit", t if nearest is None else min(t, nearest)
        yield "xyz"[axis], "negative" if slope[axis] < 0 else "positive", result, rank


def hit_point_of(table: Rectangles, light: Vector, index: int, point: Vector, slope: Vector) -> tuple[str, str, str]:
    """Return the bins of a hit point, by the definition."""
    plane = plane_of(table, index)
    if light[plane] == point[plane]:
        return "xyz"[plane], "in plane", "none"
    if (light[plane] - point[plane]) * slope[plane] > 0:
        return "xyz"[plane], "facing away", "none"
    passed, ray = ["none"], [to - start for start, to in zip(light, point, strict=True)]
    for other in set(range(len(table))) - {index}:
        across = plane_of(table, other)
        if across is None or ray[across] == 0:
            continue
        t = Fraction(table.low[other].tolist()[across] - light[across]) / ray[across]
        within, edge = crossing(table, other, light, ray, t)
        if within:
            where = {t < 0: "behind light", t == 0: "at light", t == 1: "at point", t > 1: "beyond point"}
            passed.append(where.get(True, "edge" if edge else "inside"))
    light_there = "lit" if is_lit(table, light, index, point, slope) else "shaded"
    return "xyz"[plane], light_there, max(passed, key=HIT_POINTS.points["passes"].index)


def test_kinds_are_counted_by_the_definition():
    """Counts in the golden model are those of fractions; the scenes have hit points of every kind."""
    config, kinds = configure(screen="tiny", engine="exact", light=True, reflections=2), set()
    for seed in (5, 16, 179):
        scene = random_scene(seed, 7, 2, ["light"])
        table, intersections, hit_points = Rectangles.of_scene(scene), Counter(), Counter()
        for slope in primary_slopes(config.screen_geometry).reshape(-1, 3).tolist():
            origin, travelled = scene.camera.position, Fraction(0)
            path = follow(table, scene.background, origin, slope, scene.reflections, scene.light)
            for ray, stop in zip(RAYS, path, strict=False):
                bins = intersections_of(table, stop, origin, slope, travelled)
                intersections.update((*bin, ray) for bin in bins)
                if stop.winner < 0:
                    break
                point, axis = stop.points[stop.winner], plane_of(table, stop.winner)
                hit_points[*hit_point_of(table, scene.light.position, stop.winner, point, slope), ray] += 1
                travelled += (point[0] - origin[0]) / slope[0]
                origin = point
                slope[axis] *= -1
        for cross, expected, counts in (
            (INTERSECTIONS["exact"], intersections, count_intersections(scene, config)),
            (HIT_POINTS, hit_points, count_hit_points(scene, config)),
        ):
            found = {cross.bins_at(place): int(counts[tuple(place)]) for place in np.argwhere(counts)}
            assert found == expected, scene.title
        kinds |= {bins[1:3] for bins in hit_points}
    assert kinds == {bins[1:3] for bins in FunctionalCoverage(HIT_POINTS).bins}
