# SPDX-License-Identifier: MIT
"""A span unit with a table of rectangles that draws row after row, and frames for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from hard_scenes import with_looks
from myhdl import always, always_comb, block, instances
from vectors import LAST, any_config, basis_inputs, by_axis, colour_word, named

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.exact import ExactModel
from raycaster.golden.spans import Chain, Line, Row, SpanModel
from raycaster.golden.spans import row_slope as golden_slope
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.signals import bit, tied, unconnected, unsigned
from raycaster.rtl.common.interfaces import Rects, Vector
from raycaster.rtl.common.widths import count_bits, index_bits, level_bits, signed_slope_bits
from raycaster.rtl.span.entry_table import entry_table
from raycaster.rtl.span.line_desk import line_desk
from raycaster.rtl.span.records import Aim, Answer, Asks, Entry
from raycaster.rtl.span.row_slope import row_slope
from raycaster.rtl.span.set_up import set_up
from raycaster.rtl.span.span_unit import span_unit
from raycaster.rtl.span.surface_cells import surface_cells
from raycaster.rtl.span.sweep import sweep
from raycaster.scene import UNTURNED, Basis, Light, Scene
from raycaster.screens import Screen
from raycaster.verif.random_world import (
    ROOM,
    random_basis,
    random_camera,
    random_grid,
    random_light,
    random_rectangles,
)

NOTHING = Rectangles(np.zeros((0, 2, 3), np.int64), np.zeros((0, 3), np.uint8), np.zeros(0, bool))
"""A table without rectangles."""


@block
def stored_rects(clk, store, number, stored, usable, rects, config: Configuration):
    """Keep rectangles, and present the one that is fetched.

    Args:
        clk: the clock.
        store: strobe; stores a rectangle.
        number: unsigned, `index_bits` bits; read with store.
        stored: `Rect`; read with store.
        usable: unsigned, a bit per rectangle.
        rects: `Rects`; index and fetch are read.
        config: the design.
    """
    memory = [unsigned(len(stored.word)) for _ in range(1 << index_bits(config))]

    @always_comb
    def show():
        rects.usable.next = usable

    @always(clk.posedge)
    def keep():
        if store:
            memory[number].next = stored.word

    @always(clk.posedge)
    def fetch():
        if rects.fetch:
            rects.rect.word.next = memory[rects.index]

    return instances()


@block
def frame_bench(
    clk, reset, store, number, stored, usable, first_row, camera, picture, run, done, config: Configuration
):
    """Draw a row two cycles after first_row, and after each row the one below, with a unit of the span engine.

    The ports are those of `stored_rects`, `row_slope` and `span_unit`; the unit's run.ready is an input.
    """
    rects, slope = Rects(config), Vector(signed_slope_bits(config))
    table = stored_rects(clk=clk, store=store, number=number, stored=stored, usable=usable, rects=rects, config=config)
    begun, begins, start = bit(), bit(), bit()
    camera_slope = row_slope(clk=clk, first_row=first_row, next_row=start, camera=camera, slope=slope, config=config)
    unit = span_unit(
        clk=clk, reset=reset, start=start, slope=slope, rects=rects, camera=camera, picture=picture, run=run,
        done=done, config=config,
    )  # fmt: skip

    @always(clk.posedge)
    def begin():
        begun.next = first_row
        begins.next = begun

    @always_comb
    def see_start():
        start.next = begins or done

    return instances()


def rect_inputs(table: Rectangles, index: int, prefix: str = "stored") -> dict[str, int]:
    """Return a rectangle that has a plane, as at a port."""
    axis = int(table.axes[index])
    u, v = OTHER_AXES[axis]
    low, high = table.low[index].tolist(), table.high[index].tolist()
    return {
        f"{prefix}_axis": axis, f"{prefix}_position": low[axis], f"{prefix}_u_low": low[u], f"{prefix}_u_high": high[u],
        f"{prefix}_v_low": low[v], f"{prefix}_v_high": high[v], f"{prefix}_colour": colour_word(table.colours[index]),
        f"{prefix}_mirror": int(table.mirrors[index]), f"{prefix}_kind": int(table.kinds[index]),
        f"{prefix}_cell": int(table.cells[index]).bit_length() - 4,
        f"{prefix}_colour_2": colour_word(table.colours_2[index]),
    }  # fmt: skip


def frame_inputs(frame: Frame) -> list[dict[str, Any]]:
    """Return the cycles that load a frame, up to the one after first_row."""
    table, light = frame.table, frame.light
    fixed = by_axis("camera_", frame.camera) | basis_inputs(frame.basis)
    fixed |= {"reset": 0, "usable": 0, "run_ready": 1, "store": 1, "camera_light_on": 0}
    fixed |= {"picture_reflections": frame.reflections, "picture_background": colour_word(frame.background)}
    if light:
        fixed |= by_axis("camera_light_", light.position) | {"camera_light_shade": light.quarters, "camera_light_on": 1}
    seen = np.flatnonzero(table.visible).tolist()
    loads = [fixed | rect_inputs(table, index) | {"number": index} for index in seen]
    begin = fixed | {"usable": sum(1 << index for index in seen), "store": 0, "first_row": 1}
    return [*loads, begin | {"first_row": 0}, begin, begin | {"first_row": 0}]


@block
def chain_bench(
    clk, reset, store, number, stored, usable, slope, step, chain, begin_set_up, clear, give, given, begin_sweep, gap,
    column, winner, count, entry, append, set_up_done, swept_stop, inherited, heir, sweep_done, config: Configuration,
):  # fmt: skip
    """Set up chains, and sweep over given entries, with the blocks of a span unit.

    The ports are those of `stored_rects`, `set_up`, `sweep` and `line_desk`. clear forgets the entries for the sweep,
    and give adds one.
    """
    rects, tested, put, answer = Rects(config), Entry(config), Entry(config), Answer(config)
    set_up_asks, sweep_asks = Asks(config), Asks(config)
    no_corner_asks, no_surface_asks = (Asks(config, asks=False, divides=False) for _ in range(2))
    never = tied(0, 1)
    rectangles = stored_rects(
        clk=clk, store=store, number=number, stored=stored, usable=usable, rects=rects, config=config
    )  # fmt: skip
    known, put_number, putting = unsigned(count_bits(config)), unsigned(count_bits(config)), bit()
    read, place, level = bit(), unsigned(index_bits(config)), tied(0, level_bits(config))
    finder = set_up(
        clk=clk, reset=reset, start=begin_set_up, chain=chain, from_light=never, rects=rects, asks=set_up_asks,
        answer=answer, append=append, entry=entry, count=count, done=set_up_done, config=config,
    )  # fmt: skip
    table = entry_table(
        clk=clk, level=level, shadows=never, append=putting, number=put_number, entry=put, read=read, place=place,
        stored=tested, config=config,
    )  # fmt: skip
    sweeper = sweep(
        clk=clk, reset=reset, start=begin_sweep, gap=gap, column=column, chain_stop=chain.stop, winner=winner,
        count=known, tested=tested, asks=sweep_asks, answer=answer, read=read, place=place, stop=swept_stop,
        inherited=inherited, heir=heir, done=sweep_done, config=config,
    )  # fmt: skip
    desk = line_desk(
        clk=clk, reset=reset, set_up_asks=set_up_asks, sweep_asks=sweep_asks, corner_asks=no_corner_asks,
        surface_asks=no_surface_asks, slope=slope, step=step, aim=Aim(config), answer=answer, config=config,
    )  # fmt: skip

    @always_comb
    def choose_entry():
        putting.next = append or give
        put.word.next = entry.word
        put_number.next = count
        if give:
            put.word.next = given.word
            put_number.next = known

    @always(clk.posedge)
    def tally():
        if clear:
            known.next = 0
        elif give:
            known.next = known + 1

    return instances()


def chain_inputs(chain: Chain, axis: int = 0, back: bool = False) -> dict[str, int]:
    """Return a chain of the golden model, whose last mirror is on this axis, as at a port."""
    inputs = {"chain_start": chain.start, "chain_stop": chain.stop} | by_axis("chain_eye_", chain.eye)
    mirror = {"mirrored": chain.distance > 0, "axis": axis, "back": back, "distance": chain.distance}
    met = by_axis("chain_met_", (place in chain.met for place in range(3)))
    return inputs | by_axis("chain_back_", chain.back) | named("chain", mirror) | met


def span_config(**options: Any) -> Configuration:
    """Make a design of the span engine, with a ray for each pixel of the coarsest screen unless it has a scale."""
    return any_config(engine="span", **{"scale": 1, **options})


def any_slope(random: np.random.Generator, config: Configuration) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the slope of a row's first column, and its change, often for the highest row or the steepest basis."""
    screen = config.screen_geometry
    row = int(random.choice([0, screen.rows - 1, int(random.integers(screen.rows))]))
    basis = UNTURNED
    if config.turn:
        basis = random_basis(random)
        if random.random() < 0.3:
            basis = tuple(tuple(random.choice([-512, 511], 3).tolist()) for _ in range(3))
    return golden_slope(screen, basis, row)


def line_inputs(axes: Sequence[int], backs: Sequence[int], factors: Sequence[int]) -> dict[str, int]:
    """Return the operands of a query."""
    inputs = {}
    for place, (axis, back, factor) in enumerate(zip(axes, backs, factors, strict=True), 1):
        inputs |= {f"query_axis_{place}": axis, f"query_back_{place}": back, f"query_factor_{place}": factor}
    return inputs


def any_chain(
    random: np.random.Generator, config: Configuration, slope: Sequence[Line], camera: np.ndarray
) -> tuple[Chain, tuple[int, bool]]:
    """Return a chain whose rays meet some mirrors one after the other, and axis and sign of the last mirror, as
    `chain_inputs` takes them."""
    columns = config.screen_geometry.columns
    start = int(random.choice([0, int(random.integers(columns))]))
    stop = int(random.choice([columns, start + 1, int(random.integers(start + 1, columns + 1))]))
    chain, mirror = Chain(start, stop, tuple(camera.tolist()), (False, False, False)), (0, False)
    for _ in range(int(random.integers(config.most_reflections + 1))):
        axis, plane = int(random.integers(3)), int(random.choice([0, 511, 256, *random.integers(512, size=2)]))
        far = plane - chain.eye[axis]
        back = chain.back[axis] != (far < 0)
        line = Line(-slope[axis].at_0, -slope[axis].growth) if back else slope[axis]
        ends = [line.at(column) for column in (chain.start, chain.stop - 1)]
        # In all columns, the mirror is ahead and not before the last one.
        beyond = [abs(far) * chain.ahead.at(column) - chain.distance * line.at(column)
                  for column in (chain.start, chain.stop - 1)]  # fmt: skip
        if not far or min(ends) <= 0 or (chain.distance and min(beyond) < 0):
            continue
        eye = tuple(2 * plane - one if axis == place else one for place, one in enumerate(chain.eye))
        backs = tuple(one != (axis == place) for place, one in enumerate(chain.back))
        kept = chain.met if chain.distance and max(beyond) == 0 else frozenset()
        chain, mirror = Chain(start, stop, eye, backs, abs(far), line, kept | {axis}, (axis, plane)), (axis, back)
    return chain, mirror


@dataclass(frozen=True)
class Frame:
    """A picture to draw: a table, and what is seen of it."""

    table: Rectangles
    camera: tuple[int, int, int]
    background: tuple[int, int, int]
    reflections: int
    basis: Basis = UNTURNED
    light: Light | None = None

    def rows(self, screen: Screen, patterns: bool = False, lights: bool = False) -> Iterator[Row]:
        """Yield the rows that a unit draws, by its model; patterns and lights as in `SpanModel`."""
        return SpanModel(
            self.table, self.camera, self.background, screen.columns, self.reflections, self.light, patterns, lights
        ).rows(screen, self.basis)  # fmt: skip

    def picture(self, screen: Screen) -> np.ndarray:
        """Return the picture, from the golden model that traces single rays."""
        return ExactModel().picture(
            screen, self.table, self.camera, self.background, self.reflections, basis=self.basis, light=self.light
        )


def stiff_table(random: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return corners, int64 (rectangles, 2, 3), and a camera: facing mirrors, planes through one edge, or combs."""
    kind, corners = int(random.integers(3)), random.integers(WORLD_SIZE, size=(count, 2, 3))
    camera = random.integers(WORLD_SIZE, size=3)
    flat = random.integers(3, size=count)
    index = np.arange(count)
    if kind == 0:
        # Opposite ends of the world along one axis.
        flat[:] = random.integers(3)
        corners[:, 0], corners[:, 1] = 0, LAST
        corners[index, 0, flat] = random.choice([0, 1, LAST - 1, LAST], count)
    elif kind == 1:
        # All planes meet in an edge, and the camera is on a diagonal through it.
        place = 32 * random.integers(1, 15, 3)
        corners[index, random.integers(2, size=count)] = place
        corners[index, 0, flat] = place[flat]
        camera = np.clip(place - 32 * int(random.integers(1, 8)), 0, LAST)
    else:
        # Strips one unit wide.
        flat[:] = random.integers(3)
        across = (flat + 1) % 3
        corners[index, 0, flat] = random.choice([256, 257, 400], count)
        corners[index, 1, across] = np.minimum(corners[index, 0, across] + random.integers(2, size=count), LAST)
    corners[index, 1, flat] = corners[index, 0, flat]
    return corners, camera


def any_frame(random: np.random.Generator, config: Configuration, count: int | None = None) -> Frame:
    """Return a frame that a design can draw: a random, a cornered or a stiff world, with the looks of the design.

    It has as many rectangles as the design holds, or as given.
    """
    count, kind = count or config.rectangles, int(random.integers(3))
    if kind == 0:
        table = random_rectangles(random, count, closed=None if count > len(ROOM) else False)
        camera = random_camera(random, table)
    else:
        corners, camera = random_grid(random, max(count, len(ROOM))) if kind == 1 else stiff_table(random, count)
        colours = random.integers(256, size=(len(corners), 3)).astype(np.uint8)
        table = Rectangles(corners, colours, np.ones(len(corners), dtype=bool))
        table = replace(table, enabled=np.arange(len(corners)) < count)
    table = with_looks(random, config, table)
    most = config.most_reflections
    reflections = int(random.integers(most + 1)) if random.random() < 0.3 else most
    light = random_light(random, table, camera) if config.light and random.random() < 0.8 else None
    x, y, z = camera.tolist()
    red, green, blue = random.integers(256, size=3).tolist()
    basis = random_basis(random) if config.turn else UNTURNED
    return Frame(table, (x, y, z), (red, green, blue), reflections, basis, light)


def scene_frame(scene: Scene) -> Frame:
    """Return the frame of a scene."""
    table, camera = Rectangles.of_scene(scene), scene.camera
    return Frame(table, camera.position, scene.background, scene.reflections, camera.basis, scene.light)


@block
def cells_bench(
    clk, reset, slope, step_slope, paint, level, kind, rect, chain, winner, column, stop, seen, step, place, painted,
    odd_u, odd_v, next_column, stepped, config: Configuration,
):  # fmt: skip
    """Walk along the cells of patterns, with the blocks of a span unit.

    The ports are those of `surface_cells`, and the slopes of `line_desk`.
    """
    no_tags = {name: unconnected(1) for name in ("half_line", "last")}
    answer, asks = Answer(config, **no_tags), Asks(config)
    no_sweep_asks, no_corner_asks, no_surface_asks = (Asks(config, asks=False, divides=False) for _ in range(3))
    cells = surface_cells(
        clk=clk, reset=reset, paint=paint, level=level, kind=kind, rect=rect, chain=chain, winner=winner, column=column,
        stop=stop, seen=seen, step=step, place=place, asks=asks, answer=answer, painted=painted, odd_u=odd_u,
        odd_v=odd_v, next_column=next_column, stepped=stepped, config=config,
    )  # fmt: skip
    desk = line_desk(
        clk=clk, reset=reset, set_up_asks=asks, sweep_asks=no_sweep_asks, corner_asks=no_corner_asks,
        surface_asks=no_surface_asks, slope=slope, step=step_slope, aim=Aim(config), answer=answer, config=config,
    )  # fmt: skip
    return instances()
