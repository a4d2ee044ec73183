# SPDX-License-Identifier: MIT
"""Leaf tests of `surface_cells`, `cell_walker`, `shadow_scan` and `surface_table`: what changes along a surface."""

from __future__ import annotations

from span_vectors import NOTHING, cells_bench, chain_inputs, span_config
from vectors import LAST, any_fields, by, by_axis, named

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.spans import ANSWER, Cells, Chain, Drawing, Line, SpanModel, combined, folded
from raycaster.golden.world import OTHER_AXES
from raycaster.hdl.signals import bit
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.widths import index_bits, step_bits
from raycaster.rtl.span import records
from raycaster.rtl.span.shadow_scan import shadow_scan
from raycaster.rtl.span.surface_table import surface_table

COLUMNS = 64


def any_surface(random, mirrors: int):
    """Return slopes, and an axis, distance, eye and span such that all points of the span are in the world."""
    while True:
        slope = tuple(Line(int(random.integers(-2000, 2000)), int(random.integers(-50, 51))) for _ in range(3))
        axis, eye = int(random.integers(3)), tuple(random.integers(-100, 600, 3).tolist())
        distance, back = int(random.choice([1, 50, 200, int(random.integers(1, 900))])), bool(random.integers(2))
        backs = tuple(bool(one) for one in random.integers(2, size=3))
        if not mirrors:
            # The camera itself, often at the world's edge.
            eye, backs = tuple(random.choice([0, LAST, *random.integers(WORLD_SIZE, size=2)], 3).tolist()), (False,) * 3
            distance = min(distance, LAST)
        if random.random() < 0.5:
            # Points at whole coordinates, some of them at edges of cells.
            size = int(random.choice([1, 2, 8]))
            slope = tuple(Line(int(random.integers(-40, 40)), int(random.integers(-3, 4))) for _ in range(3))
            slope = (*slope[:axis], Line(-size if back else size, 0), *slope[axis + 1 :])
            distance, eye = size * int(random.choice([1, 2, 8])), tuple(one // 8 * 8 for one in eye)
        ahead = folded(slope, axis, back)
        there = [
            column
            for column in range(COLUMNS)
            if ahead.at(column) > 0
            and all(
                0
                <= eye[u] * ahead.at(column) + distance * folded(slope, u, backs[u]).at(column)
                <= 511 * ahead.at(column)
                for u in OTHER_AXES[axis]
            )
        ]
        if len(there) > 1 and there[-1] - there[0] == len(there) - 1:
            return slope, axis, distance, back, ahead, eye, backs, there[0], there[-1] + 1


@by(reflections=[0, 1])
def test_surface_cells(reflections, leaf_of, random):
    """The cell of each column, in as many cycles as the model says; several levels are apart; a reset ends a walk."""
    config = span_config(screen="tiny", rectangles=4, reflections=reflections, turn=True, patterns=True)
    leaf = leaf_of(cells_bench, config, step_slope=lambda: Vector(step_bits(config)), step=bit, kind=2)
    leaf.case({"reset": 1})
    turns, painted = 0, {}
    for number in range(leaf.some(240)):
        slope, axis, distance, back, ahead, eye, backs, start, stop = any_surface(random, reflections)
        kind, size, level = int(random.integers(4)), int(random.integers(6)), number % (reflections + 1)
        inputs = by_axis("slope_", (one.at_0 for one in slope)) | by_axis("step_slope_", (one.growth for one in slope))
        inputs |= chain_inputs(Chain(0, COLUMNS, eye, backs)) | {"rect_cell": size, "reset": 0, "paint": 1}
        inputs |= named("winner", {"axis": axis, "back": int(back), "distance": distance})
        inputs |= {"level": level, "seen": level, "column": start, "stop": stop, "step": 0}
        if number % 3 == 0:
            # A reset ends the painting of a checker.
            leaf.stimulus += [inputs | {"kind": 1}, *[{"paint": 0}] * (number // 3 % 32), {"reset": 1}]
            kind *= int(random.integers(2))
        leaf.case(inputs | {"kind": kind})
        drawing = Drawing(SpanModel(NOTHING, (0, 0, 0), (0, 0, 0), COLUMNS, 0), slope)
        along, cells = OTHER_AXES[axis], {}
        for place in ((), (0, 1), (1,), (0,))[kind]:
            u = along[place]
            edge = combined(distance, folded(slope, u, backs[u]), -eye[u], ahead)
            cells[place] = Cells((edge, combined(8 << size, ahead, 0, ahead)))
            drawing.now += ANSWER + 3 + drawing.division
            cells[place].cell = edge.at(start) // ((8 << size) * ahead.at(start))
            drawing.follow(cells[place], start, stop)
        leaf.expect({"painted": int(not cells)})
        leaf.stimulus += [{"paint": 0}] * drawing.now
        leaf.expect({"painted": 1}, when=cells)
        for other, shown in painted.items():
            leaf.case({"paint": 0, "seen": other}, shown if other != level else {})
        leaf.case({"paint": 0, "seen": level})
        column = start
        while True:
            # The definition, in each column up to the next change.
            until = min([stop, *(one.next for one in cells.values())])
            for place, one in cells.items():
                for there in range(column, until):
                    point = eye[along[place]] * ahead.at(there)
                    point += distance * folded(slope, along[place], backs[along[place]]).at(there)
                    assert point // ((8 << size) * ahead.at(there)) == one.cell, "the model is wrong"
            odd = {f"odd_{axis}": cells[place].cell % 2 for place, axis in enumerate("uv") if place in cells}
            leaf.case({"step": 0}, odd | {"next_column": until, "stepped": 0})
            if until == stop:
                painted[level] = odd | {"next_column": stop}
                leaf.case({"step": 1, "place": stop - 1}, {"stepped": 1})
                break
            turns, column, drawing.now = turns + 1, until, 0
            for one in cells.values():
                while one.next == column:
                    drawing.now += 1
                    one.cell += 1 if one.rises else -1
                    drawing.follow(one, column, stop)
            leaf.stimulus += [{"step": 1, "place": column}] * drawing.now
            leaf.expect({"stepped": 0})
            leaf.case({}, {"stepped": 1})
    leaf.check(spare=True)
    assert turns > 20


def test_shadow_scan(leaf_of, random):
    """Shadows that follow each other, overlap, and are equal; none, and one that covers all."""
    config = span_config(screen="tiny", rectangles=6, light=True)
    leaf = leaf_of(shadow_scan, config, place=index_bits(config))
    leaf.case({"reset": 1})
    seen = set()
    for _ in range(300):
        column = int(random.integers(60))
        stop = int(random.integers(column + 1, 65))
        places = [0, column, column + 1, stop, *random.integers(65, size=3).tolist()]
        shadows = [sorted(random.choice(places, 2).tolist()) for _ in range(int(random.integers(7)))]
        leaf.case(
            {"reset": 0, "start": 1, "column": column, "stop": stop, "count": len(shadows)}, {"read": 1, "place": 0}
        )
        for number, (start, end) in enumerate(shadows, 1):
            leaf.case({"start": 0, "tested_start": start, "tested_stop": end}, {"read": 1, "place": number, "done": 0})
        # The columns that the shadows which cover this one leave to it, or those up to the next shadow.
        there = [end for start, end in shadows if start <= column < end]
        later = [start for start, end in shadows if start > column and start <= stop]
        until = max(there) if there else min([stop, *later])
        leaf.case({"start": 0}, {"done": 1, "dark": int(bool(there)), "next_dark": until, "read": 0})
        seen.add((len(there) > 1, bool(there), bool(later)))
    leaf.check()
    assert len(seen) == 6


def test_surface_table(leaf_of, random):
    config = span_config(screen="tiny", rectangles=4, reflections=3, patterns=True)
    records_ = {"given": lambda: records.Paint(config), "shown": lambda: records.Paint(config)}
    leaf, surface_fields = leaf_of(surface_table, config, **records_), records.Paint(config)
    memory = {level: any_fields(random, surface_fields) for level in range(4)}
    for level, surface in memory.items():
        leaf.case({"paint": 1, "level": level} | named("given", surface))
    for _ in range(100):
        paint, level, seen = int(random.integers(2)), int(random.integers(4)), int(random.integers(4))
        surface = any_fields(random, surface_fields)
        leaf.case(
            {"paint": paint, "level": level, "seen": seen} | named("given", surface), named("shown", memory[seen])
        )
        if paint:
            memory[level] = surface
    leaf.check()
