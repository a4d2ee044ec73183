# SPDX-License-Identifier: MIT
"""Leaf tests of `fold`, `corner_finder` and `chain_stack`: the chain behind a mirror, and the way back."""

from __future__ import annotations

from span_vectors import NOTHING, any_chain, any_slope, chain_inputs, span_config
from vectors import any_fields, by, by_axis, named

from raycaster.golden.spans import ANSWER, Drawing, Entry, Line, Rect, SpanModel
from raycaster.rtl.span.chain_stack import chain_stack
from raycaster.rtl.span.corner_finder import corner_finder
from raycaster.rtl.span.fold import fold
from raycaster.rtl.span.records import Frame


def a_rect(random, axis: int, plane: int) -> Rect:
    return Rect(int(random.integers(4)), axis, plane, (0, 0, 0), (0, 0, 0), 2, 0, 32, (0, 0, 0), (0, 0, 0))


@by(reflections=[1, 4])
def test_fold(reflections, leaf_of, random):
    """The mirrored eye, in two's complement, and the axes that are met in one point."""
    config = span_config(screen="tiny", rectangles=4, reflections=reflections)
    leaf = leaf_of(fold, config)
    model = SpanModel(NOTHING, (0, 0, 0), (0, 0, 0), 64, reflections)
    for _ in range(500):
        slope = tuple(Line(*line) for line in zip(*any_slope(random, config), strict=True))
        chain, mirror = any_chain(random, config, slope, random.choice([0, 511, *random.integers(512, size=3)], 3))
        if max(chain.eye) > 511 * reflections or min(chain.eye) < -511 * (reflections - 1):
            continue
        axis, corner, weight = (
            int(random.integers(3)),
            int(random.integers(2)),
            int(random.integers(4**reflections + 1)),
        )
        plane = int(random.choice([0, 511, int(random.integers(512))]))
        far = plane - chain.eye[axis]
        back = int(chain.back[axis] != (far < 0))
        start, stop = sorted(random.integers(65, size=2).tolist())
        winner = {"axis": axis, "back": back, "distance": abs(far)}
        inputs = {"column": start, "stop": stop, "corner": corner, "weight": weight} | named("winner", winner)
        entry = Entry(a_rect(random, axis, plane), start, stop, abs(far), Line(0, 0))
        folded = Drawing(model, slope).behind(chain, entry, start, stop, bool(corner))
        assert folded.eye[axis] == 2 * plane - chain.eye[axis]
        wanted = chain_inputs(folded, axis, back) | {"chain_weight": weight, "chain_mirrored": far != 0}
        leaf.case(chain_inputs(chain, *mirror) | inputs)
        leaf.expect({f"folded_{name.removeprefix('chain_')}": value for name, value in wanted.items()}, when=far)
    leaf.check(spare=True)


def test_corner_finder(leaf_of, random):
    """Lines that are 0 at both ends of a span, at one of them, or at none, in spans of one column and more.

    After a reset, no answer is awaited.
    """
    config = span_config(screen="tiny", rectangles=4, reflections=2)
    leaf = leaf_of(corner_finder, config)
    leaf.case({"reset": 1, "answer_valid": 0})
    seen, bits = set(), leaf.inputs["answer_left"].width
    for _ in range(leaf.some(300)):
        column = int(random.integers(64))
        stop = int(random.choice([column + 1, int(random.integers(column + 1, 65))]))
        axis, mirrored, met = int(random.integers(3)), int(random.random() < 0.8), random.integers(2, size=3).tolist()
        needed = int(mirrored and not met[axis])
        ends = [0 if random.random() < 0.5 else 1 << int(random.integers(bits - 1)) for _ in range(2)]
        if stop == column + 1:
            ends[1] = ends[0]
        fields = {
            "axis": int(random.integers(3)),
            "back": int(random.integers(2)),
            "distance": int(random.integers(1, 900)),
        }
        winner = {"axis": axis, "back": int(random.integers(2)), "distance": int(random.integers(1, 900))}
        held = named("chain", fields | {"mirrored": mirrored}) | by_axis("chain_met_", met) | named("winner", winner)
        leaf.case(held | {"reset": 0, "start": 1, "column": column, "stop": stop}, {"needed": needed, "asks_ask": 0})
        asked = {"left": column, "right": stop - 1, "strict": 0, "half_line": 0}
        asked |= {f"{name}_1": fields[name] for name in ("axis", "back")} | {"factor_1": winner["distance"]}
        asked |= {f"{name}_2": winner[name] for name in ("axis", "back")} | {"factor_2": fields["distance"]}
        part, corner = stop, 0
        leaf.case({"start": 0}, {"asks_ask": needed, "done": 0})
        leaf.expect(named("asks_query", asked), when=needed)
        if needed:
            if random.random() < 0.1:
                leaf.case({"reset": 1})
                leaf.case({"reset": 0, "answer_valid": 1}, {"done": 0})
                leaf.case({"answer_valid": 0}, {"done": 0})
                continue
            leaf.case({}, {"asks_ask": 0})
            leaf.stimulus += [{}] * (ANSWER - 2)
            leaf.case({"answer_valid": 1, "answer_left": ends[0], "answer_right": ends[1]}, {"done": 1})
            leaf.case({"answer_valid": 0})
            corner = int(ends[0] == 0)
            # The columns of the corner are the first one or all; otherwise all without the last one if it is a corner.
            part = column + 1 if corner and ends[1] else stop - 1 if not corner and not ends[1] else stop
        leaf.expect({"corner": corner, "part_stop": part, "done": 0})
        seen.add((needed, corner, part == stop))
    leaf.check(spare=True)
    assert len(seen) == 5


@by(reflections=[1, 2, 4])
def test_chain_stack(reflections, leaf_of, random):
    config = span_config(screen="tiny", rectangles=4, reflections=reflections)
    leaf, stack, record = leaf_of(chain_stack, config), [], Frame(config)
    for _ in range(200):
        push = int(len(stack) < reflections and random.random() < 0.6)
        frame = any_fields(random, record)
        leaf.case({"push": push, "level": len(stack)} | named("kept", frame))
        if stack:
            leaf.expect(named("frame", stack[-1]))
        if push:
            stack.append(frame)
        elif stack:
            stack.pop()
    leaf.check()
