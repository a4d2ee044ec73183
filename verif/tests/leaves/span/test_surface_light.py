# SPDX-License-Identifier: MIT
"""Leaf tests of `surface_light` and `shadow_finder`: the side of the light, its slope, and shadows along a surface."""

from __future__ import annotations

from span_vectors import any_slope, chain_inputs, span_config
from vectors import by, by_axis, named

from raycaster.golden.spans import ANSWER, Chain, Line, folded
from raycaster.hdl.signals import bit
from raycaster.rtl.common.widths import index_bits
from raycaster.rtl.span.shadow_finder import shadow_finder
from raycaster.rtl.span.surface_light import surface_light


@by(turn=[False, True])
def test_shadow_finder(turn, leaf_of, random):
    """The lines are e (P - L) and e, whichever way they are asked for, and the fan's eye is the light."""
    config = span_config(screen="tiny", rectangles=4, reflections=2, turn=turn, light=True)
    leaf, asked = leaf_of(shadow_finder, config), {}
    leaf.case({"reset": 1, "answer_valid": 0})
    for _ in range(leaf.some(150)):
        slope = tuple(Line(*line) for line in zip(*any_slope(random, config), strict=True))
        column = int(random.integers(63))
        stop = int(random.integers(column + 1, 65))
        eye, backs = tuple(random.integers(-500, 1500, 3).tolist()), tuple(map(bool, random.integers(2, size=3)))
        light = random.choice([0, 511, *random.integers(512, size=3)], 3).tolist()
        axis, back, distance = int(random.integers(3)), bool(random.integers(2)), int(random.integers(1, 1500))
        inputs = chain_inputs(Chain(0, 64, eye, backs)) | by_axis("camera_light_", light)
        inputs |= named("winner", {"axis": axis, "back": int(back), "distance": distance})
        leaf.case(inputs | {"reset": 0, "start": 1, "column": column, "stop": stop, "set_up_done": 0})
        ahead, queries = folded(slope, axis, back), []
        for u in range(3):
            aside = folded(slope, u, backs[u])
            # The point is E + N D' / e.
            queries.append([(eye[u] - light[u]) * ahead.at(c) + distance * aside.at(c) for c in (column, stop - 1)])
        queries.append([ahead.at(column), ahead.at(stop - 1)])
        for number, values in enumerate(queries):
            leaf.case(
                {"start": 0},
                {"asks_ask": 1, "asks_query_number": number, "asks_query_left": column, "asks_query_right": stop - 1},
            )
            leaf.expect({"asks_query_from_light": 0, "asks_query_half_line": 0, "asks_query_strict": 0})
            asked[leaf.cycle - 1] = slope, values
        leaf.stimulus += [{}] * (ANSWER - 4)
        answers = [[int(one) for one in random.integers(-1000, 1000, 3)] for _ in range(4)]
        for number, (left, right, growth) in enumerate(answers):
            ends = {"left": left, "right": right, "growth": growth, "number": number}
            leaf.case({"answer_valid": 1, **named("answer", ends)}, {"asks_ask": 0, "begin_set_up": 0})
        wanted = {f"aim_{end}_{one}": answers[place][at] for at, end in enumerate(("left", "right", "growth"))
                  for place, one in enumerate("xyze")}  # fmt: skip
        fan = by_axis("fan_eye_", light) | {"fan_start": column, "fan_stop": stop, "fan_mirrored": 0}
        leaf.case({"answer_valid": 0}, wanted | fan | by_axis("fan_back_", (0, 0, 0)) | {"begin_set_up": 1, "done": 0})
        leaf.stimulus += [{}] * int(random.integers(5))
        leaf.case({"set_up_done": 1}, {"done": 1, "begin_set_up": 0})
        leaf.case({"set_up_done": 0}, {"done": 0, "asks_ask": 0})
    outputs = leaf.check(spare=True)
    bits = leaf.seen["asks_query_factor_1"].width
    for cycle, (slope, values) in asked.items():
        seen = outputs[cycle]
        parts = [[seen[f"asks_query_{name}_{one}"] for name in ("axis", "back", "factor")] for one in (1, 2)]
        for there, value in zip((seen["asks_query_left"], seen["asks_query_right"]), values, strict=True):
            x, y = (
                (-1 if back else 1) * slope[axis].at(there) * ((factor ^ 1 << bits - 1) - (1 << bits - 1))
                for axis, back, factor in parts
            )
            assert x - y == value, f"cycle {cycle}"


def test_surface_light(leaf_of, random):
    """Surfaces on either side of the light and in its plane; shadows from their first column to their last."""
    config = span_config(screen="tiny", rectangles=6, reflections=1, light=True)
    leaf = leaf_of(surface_light, config, read_place=index_bits(config), step=bit)
    leaf.case({"reset": 1, "answer_valid": 0, "set_up_done": 0, "step": 0, "paint": 0})
    seen, kept = set(), {}

    def scan(shadows, column, stop):
        """Add the cycles of a scan, and return what it finds."""
        leaf.case({"set_up_done": 0}, {"read": 1, "read_place": 0, "busy": 1})
        for number, (start, end) in enumerate(shadows, 1):
            leaf.case({"tested_start": start, "tested_stop": end}, {"read": 1, "read_place": number})
        leaf.case({}, {"read": 0})
        there = [end for start, end in shadows if start <= column < end]
        later = [start for start, _ in shadows if start > column]
        return bool(there), max(there) if there else min(later, default=stop)

    for number in range(leaf.some(200)):
        level, axis = number % 2, int(random.integers(3))
        column = int(random.integers(50))
        stop = int(random.integers(column + 1, 65))
        plane, back, flipped = int(random.integers(512)), int(random.integers(2)), int(random.integers(2))
        light = random.integers(512, size=3)
        light[axis] = max(0, min(511, plane + int(random.choice([-200, -1, 0, 1, 200]))))
        shining, unseen = int(random.random() < 0.8), int(random.random() < 0.2)
        backs = [int(random.integers(2)) for _ in range(3)]
        backs[axis] = flipped
        inputs = by_axis("chain_back_", backs) | by_axis("camera_light_", light.tolist()) | {"camera_light_on": shining}
        inputs |= {"winner_axis": axis, "winner_back": back, "rect_position": plane, "unseen": unseen, "level": level}
        # n = k - E is negative if e has another sign than the slope after the mirrors.
        front = light[axis] > plane if back != flipped else light[axis] < plane
        lit = bool(shining and front and not unseen)
        dark, until, shadows = bool(shining and not front and not unseen), stop, []
        leaf.case(inputs | {"reset": 0})
        leaf.case({"paint": 1, "column": column, "stop": stop, "seen": level})
        leaf.expect({"painted": int(not lit), "busy": 0})
        if lit:
            leaf.stimulus += [{"paint": 0}, *[{}] * (ANSWER + 1)]
            for answer in range(4):
                leaf.case({"answer_valid": 1, "answer_number": answer})
            leaf.case({"answer_valid": 0}, {"begin_set_up": 1, "busy": 1, "looked": level})
            places = [column, column, stop, *random.integers(column, stop + 1, 4).tolist()]
            pairs = (sorted(random.choice(places, 2).tolist()) for _ in range(int(random.integers(6))))
            shadows = [pair for pair in pairs if pair[0] < pair[1]]
            leaf.case({"set_up_done": 1, "entry_count": len(shadows)}, {"painted": 0})
            dark, until = scan(shadows, column, stop)
            leaf.expect({"painted": 1})
        leaf.case({"paint": 0, "set_up_done": 0}, {"dark": int(dark), "next_column": until, "busy": 0})
        kept[level] = dark, until
        while until < stop and lit:
            place = until
            leaf.case({"step": 1, "place": place}, {"stepped": 0})
            dark, until = scan(shadows, place, stop)
            leaf.case({}, {"stepped": 1, "dark": int(dark), "next_column": until})
            leaf.case({"step": 0})
            kept[level] = dark, until
        other = 1 - level
        if other in kept:
            leaf.case({"seen": other}, {"dark": int(kept[other][0]), "next_column": kept[other][1]})
        seen.add((lit, bool(shadows), dark))
    leaf.check(spare=True)
    assert len(seen) >= 5
