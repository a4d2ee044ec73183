# SPDX-License-Identifier: MIT
"""The cells of the patterns that rays see on their way."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.by_axis import along_u, along_v, by_axis
from raycaster.rtl.common.widths import PLACE_BITS, column_bits, eye_bits, level_bits
from raycaster.rtl.span.cell_walker import cell_walker
from raycaster.rtl.span.records import Cells, Grid


@block
def surface_cells(
    clk, reset, paint, level, kind, rect, chain, winner, column, stop, seen, step, place, asks, answer, painted, odd_u,
    odd_v, next_column, stepped, config: Configuration,
):  # fmt: skip
    """Hold the cells of the pattern of each level, the number of mirrors before it, at the present column.

    The present column of all levels is the first one of the surface that was painted last, and moves on with each step.

    Args:
        reset: flag; synchronous reset to idle.
        paint: strobe, while idle; a surface is seen at this level.
        level: unsigned, `level_bits` bits; constant from paint to painted.
        kind: unsigned, 2 bits; the surface's pattern as in a `Look`, 0 for none. Read with paint.
        rect: `Rect` of the surface; cell is read with paint.
        chain: `Chain` whose rays see it, read with paint.
        winner: `Entry` of the surface, read with paint.
        column: unsigned, `column_bits` bits; the surface's first column, constant from paint to painted.
        stop: unsigned, `column_bits` bits; the column after its last, read with paint.
        seen: unsigned, `level_bits` bits; the level that is read, while nothing is painted.
        step: flag, while nothing is painted; the level that is read goes on to the column place. High up to stepped.
        place: unsigned, `column_bits` bits; the present column from now on, not after next_column of any level that is
            in use. Constant while step is high.
        asks: output `Asks`.
        answer: `Answer`.
        painted: output strobe; the surface can be read from the next cycle on.
        odd_u: output flag; the number of the cell along u is odd, at the level that is read. Combinational.
        odd_v: output flag; that of the cell along v.
        next_column: unsigned output, `column_bits` bits; the column in which the next cell begins, or the surface's
            stop. Combinational.
        stepped: output strobe; the level that is read has gone on.
        config: the design, with patterns.
    """
    width, far_bits, levels = column_bits(config), eye_bits(config), 1 << level_bits(config)

    walking, entering, painting, on_v, patterned, wants_v, needs_u, needs_v = (bit() for _ in range(8))
    walked, rises, forward = bit(), bit(), bit()
    looked = unsigned(level_bits(config))
    grids, all_cells = ([unsigned(len(one(config).word)) for _ in range(levels)] for one in (Grid, Cells))
    new, grid = Grid(config), Grid(config)
    fresh, cells, follow_u, follow_v = (Cells(config) for _ in range(4))
    eye_u, eye_v, back_u, back_v = signed(far_bits), signed(far_bits), bit(), bit()
    old_cell, next_cell, found_cell = (unsigned(PLACE_BITS) for _ in range(3))
    here, found_next = unsigned(width), unsigned(width)
    no_cell, never = tied(0, PLACE_BITS), tied(0, 1)

    eyes, backs = (chain.eye_x, chain.eye_y, chain.eye_z), (chain.back_x, chain.back_y, chain.back_z)
    choices = [
        by_axis(winner.axis, *along(*values), chosen, width=len(chosen))
        for along, values, chosen in (
            (along_u, eyes, eye_u), (along_v, eyes, eye_v), (along_u, backs, back_u), (along_v, backs, back_v),
        )
    ]  # fmt: skip

    given = new.joined(
        kind=kind, cell=rect.cell, axis=winner.axis, back=winner.back, distance=winner.distance, eye_u=eye_u,
        eye_v=eye_v, back_u=back_u, back_v=back_v, stop=stop,
    )  # fmt: skip
    begun = fresh.joined(cell_u=no_cell, cell_v=no_cell, rises_u=never, rises_v=never, next_u=stop, next_v=stop)
    gone_u = follow_u.joined(
        cell_u=found_cell, cell_v=cells.cell_v, rises_u=rises, rises_v=cells.rises_v, next_u=found_next,
        next_v=cells.next_v,
    )  # fmt: skip
    gone_v = follow_v.joined(
        cell_u=cells.cell_u, cell_v=found_cell, rises_u=cells.rises_u, rises_v=rises, next_u=cells.next_u,
        next_v=found_next,
    )  # fmt: skip

    keep_grid = register(clk, grids[level], lambda: given, paint)

    @always(clk.posedge)
    def keep_cells():
        if paint:
            all_cells[level].next = begun
        elif walked:
            if on_v:
                all_cells[looked].next = gone_v
            else:
                all_cells[looked].next = gone_u

    choose_level = assign(looked, lambda: level if painting else seen)

    @always_comb
    def look_up():
        grid.word.next = grids[looked]
        cells.word.next = all_cells[looked]

    # A checker has cells along u, and then along v.
    @always_comb
    def see_need():
        patterned.next = paint and (kind != 0)
        wants_v.next = painting and walked and (not on_v) and (grid.kind == 1)

    @always_comb
    def see_step():
        needs_u.next = step and (not walking) and (cells.next_u == place)
        needs_v.next = step and (not walking) and (cells.next_u != place) and (cells.next_v == place)

    @always_comb
    def see_end():
        painted.next = (paint and not patterned) or (painting and walked and not wants_v)
        stepped.next = step and not (walking or needs_u or needs_v)

    @always(clk.posedge)
    def advance():
        entering.next = patterned or wants_v or needs_u or needs_v
        if reset:
            walking.next = painting.next = entering.next = False
        elif patterned or needs_u or needs_v:
            walking.next = True
            painting.next = patterned
            on_v.next = needs_v or (patterned and (kind == 2))
        elif wants_v:
            on_v.next = True
        elif walked:
            walking.next = painting.next = False

    # Unless the first cell is sought, the walk begins with the next one, in the column in which it begins.
    see_here = assign(here, lambda: column if painting else place)
    see_old_cell = assign(old_cell, lambda: cells.cell_v if on_v else cells.cell_u)
    see_forward = assign(forward, lambda: cells.rises_v if on_v else cells.rises_u)

    @always_comb
    def move():
        next_cell.next = (old_cell - 1) % (1 << PLACE_BITS)
        if forward:
            next_cell.next = (old_cell + 1) % (1 << PLACE_BITS)

    walker = cell_walker(
        clk=clk, reset=reset, start=entering, find=painting, on_v=on_v, grid=grid, known_cell=next_cell, column=here,
        asks=asks, answer=answer, found_cell=found_cell, next_column=found_next, rises=rises, done=walked,
        config=config,
    )  # fmt: skip

    show_odd_u = assign(odd_u, lambda: cells.cell_u[0])
    show_odd_v = assign(odd_v, lambda: cells.cell_v[0])
    show_next_column = assign(next_column, lambda: cells.next_v if cells.next_v < cells.next_u else cells.next_u)

    return instances()
