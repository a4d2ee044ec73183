# SPDX-License-Identifier: MIT
"""Leaf tests of `set_up`, `half_lines` and `clipper`: which columns meet a rectangle, and when that is known."""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction

import numpy as np
import pytest
from span_vectors import any_chain, any_slope, chain_bench, chain_inputs, rect_inputs, span_config
from vectors import by_axis, named

from raycaster.golden.spans import ANSWER, Drawing, Line, SpanModel
from raycaster.golden.spans import Chain as Fan
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.span.clipper import clipper
from raycaster.rtl.span.first_change import division_cycles
from raycaster.rtl.span.half_lines import half_lines
from raycaster.verif.random_world import random_camera, random_rectangles

DESIGNS = [
    {"screen": "tiny", "rectangles": 5, "reflections": 0},
    {"screen": "tiny", "rectangles": 12, "reflections": 2, "turn": True},
    {"rectangles": 12, "reflections": 4, "turn": True}, {"rows": 180, "scale": 6, "rectangles": 8, "reflections": 1},
]  # fmt: skip


def met(table, index, chain, slope, column) -> bool:
    """Apply the definition to the ray of a column: it meets the rectangle's plane ahead and within the bounds, beyond
    the last mirror, or in its point if no mirror on this axis was met there."""
    axis = int(table.axes[index])
    ray = [-line.at(column) if back else line.at(column) for line, back in zip(slope, chain.back, strict=True)]
    far = int(table.low[index, axis]) - chain.eye[axis]
    if far == 0 or far * ray[axis] <= 0:
        return False
    t = Fraction(far, ray[axis])
    if chain.distance:
        last = Fraction(chain.distance, chain.ahead.at(column))
        if t < last or (t == last and axis in chain.met):
            return False
    return all(table.low[index, u] <= chain.eye[u] + ray[u] * t <= table.high[index, u] for u in OTHER_AXES[axis])


@pytest.mark.parametrize("options", DESIGNS, ids=str)
def test_set_up(options, leaf_of, random):
    """Each entry has exactly the columns that meet the rectangle, and is there when the model says so."""
    config = span_config(**options)
    leaf = leaf_of(chain_bench, config)
    leaf.case({"reset": 1, "begin_sweep": 0})
    appended, kinds, every = {}, set(), 6 if config.most_reflections else 3
    for drawn in range(500):
        if drawn >= leaf.some(75) and (leaf.few or len(kinds) == every):
            break
        table = random_rectangles(random, config.rectangles, closed=None if config.rectangles > 6 else False)
        slopes, step = any_slope(random, config)
        slope = tuple(Line(*line) for line in zip(slopes, step, strict=True))
        chain, mirror = any_chain(random, config, slope, random_camera(random, table))
        seen = np.flatnonzero(table.visible).tolist()
        held = by_axis("slope_", slopes) | by_axis("step_", step) | chain_inputs(chain, *mirror) | {"reset": 0}
        for index in seen:
            leaf.case(held | rect_inputs(table, index) | {"number": index, "store": 1})
        usable = sum(1 << index for index in seen)
        leaf.case({"store": 0, "usable": usable})
        drawing = Drawing(SpanModel(table, (0, 0, 0), (0, 0, 0), config.screen_geometry.columns, 0), slope)
        entries = drawing.set_up(chain)
        columns = range(chain.start, chain.stop)
        if len(columns) > 400:
            columns = sorted(
                {
                    *columns[:2],
                    *columns[-2:],
                    *(one + past for entry in entries for one in (entry.start, entry.stop) for past in (-1, 0)),
                    *columns[::97],
                }
                & {*columns}
            )
        for index in seen:
            there = [column for column in columns if met(table, index, chain, slope, column)]
            [*found] = [entry for entry in entries if entry.rect.index == index]
            active = [column for column in columns if found and found[0].start <= column < found[0].stop]
            assert there == active, "the model is wrong"
            kinds.add((bool(there), len(there) == 1, bool(chain.distance)))
        # The model counts up to the cycle after the set-up's end.
        leaf.stimulus += [{"begin_set_up": 1}, *[{"begin_set_up": 0}] * (drawing.now + 2)]
        leaf.expected[leaf.cycle - 4] |= {"set_up_done": 0}
        leaf.expected[leaf.cycle - 3] |= {"set_up_done": 1, "count": len(entries)}
        appended[leaf.cycle] = [
            (one.rect.index, one.rect.axis, one.distance, one.start, one.stop,
             int(chain.back[one.rect.axis] != (one.rect.plane < chain.eye[one.rect.axis]))) for one in entries
        ]  # fmt: skip
    outputs, begin = leaf.check(spare=True), 0
    for end, entries in appended.items():
        written = [
            tuple(one[f"entry_{name}"] for name in ("index", "axis", "distance", "start", "stop", "back"))
            for one in outputs[begin:end] if one["append"]
        ]  # fmt: skip
        assert written == entries
        begin = end
    assert leaf.few or len(kinds) == every


@pytest.mark.parametrize(
    "options",
    [{"screen": "tiny", "rectangles": 100}, *DESIGNS[:3], {"screen": "tiny", "reflections": 1, "light": True}],
    ids=str,
)
def test_half_lines(options, leaf_of, random):
    """The lines of one rectangle have the values of the contract at the ends of the chain, and come in its order."""
    config = span_config(**options)
    leaf = leaf_of(half_lines, config)
    leaf.case({"reset": 1, "answer_half_line": 0, "done": 0})
    numbers, asked_lines = set(), {}
    for _ in range(leaf.some(300)):
        table = random_rectangles(random, 6, closed=False)
        seen = np.flatnonzero(table.visible)
        slopes, step = any_slope(random, config)
        slope = tuple(Line(*line) for line in zip(slopes, step, strict=True))
        chain, mirror = any_chain(random, config, slope, random_camera(random, table))
        from_light, surface = int(config.light and random.random() < 0.5), None
        if from_light:
            # A fan of rays with any slope, to a surface that is always ahead.
            chain = Fan(chain.start, chain.stop, tuple(random.integers(512, size=3).tolist()), (False, False, False))
            surface = Line(int(random.integers(1, 1000)), int(random.integers(10)))
        if not len(seen):
            continue
        place, index = int(random.integers(config.rectangles)), int(random.choice(seen))
        if random.random() < 0.3:
            corners = table.corners.copy()
            corners[index, 1] = corners[index, 0]
            table = Rectangles(corners, table.colours, table.enabled)
        elif chain.distance and table.axes[index] != chain.mirror[0] and random.random() < 0.7:
            # The rectangle reaches the last mirror's plane.
            axis, plane = chain.mirror
            corners = table.corners.copy()
            corners[index, :, axis] = min(plane, corners[index, 0, axis]), max(plane, corners[index, 1, axis])
            table = Rectangles(corners, table.colours, table.enabled)
        rect = rect_inputs(table, index, "rects_rect")
        leaf.stimulus += [
            chain_inputs(chain, *mirror)
            | rect
            | {"reset": 0, "start": 1, "rects_usable": 1 << place, "from_light": from_light}
        ]
        leaf.stimulus += [{"start": 0}] * ANSWER
        ends = [(line.at(chain.start), line.at(chain.stop - 1)) for line in slope]
        for axis, (left, right) in enumerate(ends):
            asked = {
                "left": chain.start,
                "right": chain.stop - 1,
                "axis_1": axis,
                "back_1": 0,
                "factor_1": 1,
                "factor_2": 0,
            }
            leaf.expected[leaf.cycle - ANSWER] |= named("asks_query", asked) | {"asks_ask": 1, "asks_query_strict": 0}
            leaf.case({"answer_valid": 1, **named("answer", {"number": axis, "left": left, "right": right})})
        leaf.case({"answer_valid": 0})
        drawing = Drawing(SpanModel(table, (0, 0, 0), (0, 0, 0), config.screen_geometry.columns, 0), slope)
        lines = drawing.half_lines(
            chain, next(one for one in drawing.model.table if one.index == index), slope, surface
        )
        leaf.expect({"opened": int(bool(lines)), "asks_ask": 0})
        for number, line in lines.items():
            numbers.add(number)
            leaf.case({}, {"asks_ask": 1, "asks_query_half_line": 1, "asks_query_number": number, "walked": 0})
            leaf.expect({"asks_query_last": int(number == max(lines))})
            leaf.expect({"asks_query_left": chain.start, "asks_query_right": chain.stop - 1})
            asked_lines[leaf.cycle - 1] = (*slope, surface), line
        leaf.case({"done": 1}, {"walked": 1, "asks_ask": 0})
        leaf.case({"done": 0}, {"walked": 0})
    outputs = leaf.check(spare=True)
    # A point lies across x, where the slope of a camera that does not turn never changes its sign.
    assert leaf.few or numbers == {
        *range(1, 5),
        *([0] if config.turn or config.light else []),
        *([5] if config.most_reflections else []),
    }
    for cycle, (slope, line) in asked_lines.items():
        seen = outputs[cycle]
        components = [
            (slope[seen[f"asks_query_axis_{one}"]], -1 if seen[f"asks_query_back_{one}"] else 1) for one in (1, 2)
        ]
        bits = leaf.seen["asks_query_factor_1"].width
        factors = [(seen[f"asks_query_factor_{one}"] ^ 1 << bits - 1) - (1 << bits - 1) for one in (1, 2)]
        for column in (seen["asks_query_left"], seen["asks_query_right"]):
            x, y = (component.at(column) * sign for component, sign in components)
            assert factors[0] * x - factors[1] * y - seen["asks_query_strict"] == line.at(column), f"cycle {cycle}"


def test_clipper(leaf_of, random):
    """Lines of one rectangle after the other, each answered, divided and used while others are asked for."""
    config = span_config(screen="tiny", rectangles=8, reflections=1)
    leaf, cycles, kinds = leaf_of(clipper, config), division_cycles(config), set()
    quiet = {"reset": 0, "opened": 0, "answer_valid": 0, "answer_half_line": 1, "answer_last": 0}
    leaf.case(quiet | {"reset": 1})
    for _ in range(leaf.some(60)):
        start = int(random.integers(60))
        stop = int(random.integers(start + 1, 65))
        inputs, outputs, opened, ended = defaultdict(dict), defaultdict(dict), 1, 0
        for _ in range(int(random.integers(1, 9))):
            distance, low, high, lines = int(random.integers(1, 512)), start, stop, []
            for _ in range(int(random.integers(4, 7))):
                growth, place = int(random.integers(-20, 21)), int(random.integers(start, stop + 1))
                line = Line(int(random.integers(20)) - growth * place, growth)
                whole = Line(1280 + growth, growth), Line(-1280 - growth, growth)
                lines.append((line, *whole)[int(random.choice(3, p=(0.3, 0.65, 0.05)))])
            inputs[opened] |= {"opened": 1, "met_distance": distance}
            for cycle, line in enumerate(lines, opened + 1 + ANSWER):
                ends = {"left": line.at(start), "right": line.at(stop - 1), "growth": line.growth}
                inputs[cycle] |= {"answer_valid": 1, **named("answer", ends | {"last": int(line is lines[-1])})}
                given = {"value": line.at(start), "growth": line.growth}
                outputs[cycle] |= {"asks_divide": 1, **named("asks_division", given)}
                change = [column for column in range(start, stop) if (line.at(column) < 0) != (line.at(start) < 0)]
                inputs[cycle + cycles]["answer_columns"] = int(random.integers(64))
                if change:
                    inputs[cycle + cycles]["answer_columns"] = change[0] - start
                    low, high = (max(low, change[0]), high) if line.at(start) < 0 else (low, min(high, change[0]))
            inside = [column for column in range(start, stop) if all(line.at(column) >= 0 for line in lines)]
            rejected = any(line.at(start) < 0 and line.at(stop - 1) < 0 for line in lines)
            assert inside == ([] if rejected else [*range(low, high)])
            ended = opened + ANSWER + len(lines) + cycles + 1
            outputs[ended] |= {"append": int(bool(inside))}
            if inside:
                outputs[ended] |= named("entry", {"start": low, "stop": high, "distance": distance})
            kinds.add((rejected, bool(inside), inside == [*range(start, stop)]))
            opened += len(lines) + int(random.choice([0, 0, 3]))
        for cycle in range(ended + 2):
            seen = {"append": 0, "asks_divide": 0, "idle": int(cycle < 2 or cycle > ended)} | outputs[cycle]
            leaf.case(quiet | {"chain_start": start, "chain_stop": stop} | inputs[cycle], seen)
    leaf.check(spare=True)
    assert len(kinds) == 4
