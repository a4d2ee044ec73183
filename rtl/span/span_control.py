# SPDX-License-Identifier: MIT
"""The course of a row: chains, their spans, and the chains behind mirrors."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import AXIS_BITS, MIRROR_BITS, column_bits, eye_bits, eye_distance_bits, weight_bits
from raycaster.rtl.engine.quarters_of import quarters_of
from raycaster.rtl.span.records import Chain

SpanState = enum("IDLE", "SET_UP", "SWEEP", "SPAN", "CORNER", "PAINT", "EMIT", "DESCEND", "ASCEND", "RETURN", "INHERIT")


@block
def span_control(
    clk, reset, start, camera, picture, rect, set_up_done, entry_count, sweep_done, swept_stop, swept_inherited,
    swept_heir, cornered, corner_done, folded, frame, painted, emitted, begin_set_up, begin_sweep, begin_corner,
    begin_paint, begin_emit, push, fetch, level, chain, winner, gap, column, stop, heir, inherited, count, share,
    colour, passed_on, config: Configuration,
):  # fmt: skip
    """Draw a row, depth first: the spans of a chain from left to right, and in a mirror's span the chain behind it.

    A span is a leaf if it is a gap, or its winner does not mirror, or the ray has met as many mirrors as the scene asks
    for: it shows all of its colour. Otherwise the winner shows the rest of what it mirrors, and the chain behind it
    begins; a span has a second part if the winner is a corner in its first or last column only.

    Args:
        reset: flag; synchronous reset to idle.
        start: strobe; draws a row while idle.
        camera: `Camera`; its position is read, constant while a row is drawn.
        picture: `Picture`; reflections and background are read, constant while a row is drawn.
        rect: `Rect` that was fetched last.
        set_up_done: strobe; all entries of the chain are in the table.
        entry_count: unsigned, `count_bits` bits; their number, read with set_up_done.
        sweep_done: strobe; the span that begins at column has been found.
        swept_stop: unsigned, `column_bits` bits; its end, read with sweep_done.
        swept_inherited: flag; it has an heir, read with sweep_done.
        swept_heir: `Entry`; the heir, read with sweep_done.
        cornered: flag; the corner rule takes time; read with begin_corner.
        corner_done: strobe; the end of that time.
        folded: `Chain` behind the winner; read with push.
        frame: `Frame` of the level below; read where that level goes on.
        painted: strobe; the level has been painted.
        emitted: strobe; the span's run has been taken.
        begin_set_up: output strobe, at the latest in the cycle before the chain is valid.
        begin_sweep: output strobe, in the cycle before the chain, its winner, its column and its count are valid.
        begin_corner: output strobe; apply the corner rule.
        begin_paint: output strobe; paint the columns from column up to stop.
        begin_emit: output strobe, with painted; emit those columns.
        push: output strobe; keep the chain, as the one behind its winner comes next.
        fetch: output strobe; fetch the winner's rectangle.
        level: unsigned output, `level_bits` bits; mirrors that the chain's rays have met.
        chain: output `Chain`.
        winner: output `Entry` that is seen at column.
        gap: output flag; nothing is seen at column.
        column: unsigned output, `column_bits` bits; the first column of the span, or of its second part.
        stop: unsigned output, `column_bits` bits; the column after the span.
        heir: output `Entry`; if inherited, the one that is seen at stop.
        inherited: output flag.
        count: unsigned output, `count_bits` bits; entries of the chain.
        share: unsigned output, `weight_bits` bits; the weight of the span's colour, valid with begin_paint. It is
            driven with reflections, otherwise it is 1.
        colour: unsigned output, 24 bits; the span's plain colour, valid with begin_paint.
        passed_on: unsigned output, `weight_bits` bits; the weight of what the winner mirrors, valid with push.
    """
    columns, width, mirrors = config.screen_geometry.columns, column_bits(config), config.most_reflections > 0
    weight_width = weight_bits(config)

    state = Signal(SpanState.IDLE)
    entering, empty = bit(), bit()
    leaf, ending = (bit(), bit()) if mirrors else (tied(1, 1), tied(1, 1))
    first_chain = Chain(config)
    frame_chain = Chain(config) if mirrors else Chain(config).tie({})
    weight, first_weight, passed = (unsigned(weight_width) for _ in range(3))
    own = unsigned(MIRROR_BITS)
    mirrored = unsigned(MIRROR_BITS) if rect.has("mirror") else tied(2, MIRROR_BITS)
    no_column, no_axis, no_distance = tied(0, width), tied(0, AXIS_BITS), tied(0, eye_distance_bits(config))
    all_columns = tied(columns, width)
    eye_x, eye_y, eye_z = (signed(eye_bits(config)) for _ in range(3))

    @always_comb
    def see_camera():
        eye_x.next, eye_y.next, eye_z.next = camera.x, camera.y, camera.z

    first = first_chain.joined(
        start=no_column, stop=all_columns, eye_x=eye_x, eye_y=eye_y, eye_z=eye_z, back_x=False, back_y=False,
        back_z=False, mirrored=False, axis=no_axis, back=False, distance=no_distance, met_x=False, met_y=False,
        met_z=False, weight=first_weight,
    )  # fmt: skip

    # With one reflection, only the first chain has another one behind it.
    if config.most_reflections == 1:
        see_frame_chain = assign(frame_chain.word, lambda: first)

    elif mirrors:
        see_frame_chain = assign(frame_chain.word, lambda: frame.chain)

    @always_comb
    def operate():
        begin_set_up.next = (start and state == SpanState.IDLE) or (state == SpanState.DESCEND)
        begin_sweep.next = (state == SpanState.INHERIT) or ((state == SpanState.SET_UP) and set_up_done)
        begin_corner.next = (state == SpanState.SPAN) and not leaf
        begin_paint.next = entering and (state == SpanState.PAINT)
        begin_emit.next = painted and ending and (state == SpanState.PAINT)
        push.next = state == SpanState.DESCEND
        fetch.next = (state == SpanState.RETURN) or (entering and (state == SpanState.SWEEP) and not gap)

    show_colour = assign(colour, lambda: picture.background if gap else rect.colour)

    if mirrors and rect.has("mirror"):
        see_mirror = assign(mirrored, lambda: rect.mirror)

    if mirrors:
        reflections = unsigned(len(picture.reflections))

        @always_comb
        def see_first_weight():
            first_weight.next = 1
            for i in range(1, config.most_reflections + 1):
                if picture.reflections == i:
                    first_weight.next = 1 << (2 * i)

        # The live scene is far from most units.
        @always(clk.posedge)
        def keep_reflections():
            if state == SpanState.IDLE:
                reflections.next = picture.reflections

        # Valid from SPAN on. A winner to which a level returns is a mirror, whose rectangle is only being fetched.
        judge = register(
            clk, leaf, lambda: (state != SpanState.RETURN) and (gap or (level == reflections) or (mirrored == 0))
        )
        see_weight = assign(weight, lambda: chain.weight)
        see_own = assign(own, lambda: 4 if leaf else 4 - mirrored)

        shares = (
            quarters_of(whole=weight, quarters=own, share=share),
            quarters_of(whole=weight, quarters=mirrored, share=passed),
        )

        @always(clk.posedge)
        def keep_passed():
            if state == SpanState.SPAN:
                passed_on.next, ending.next = passed, leaf

    see_empty = assign(empty, lambda: swept_stop == column)

    @always(clk.posedge)
    def step():
        entering.next = False
        if reset:
            state.next = SpanState.IDLE
        elif state == SpanState.IDLE:
            if start:
                state.next = SpanState.SET_UP
        elif state == SpanState.SET_UP:
            if set_up_done:
                state.next = SpanState.SWEEP
                entering.next = True
        elif state == SpanState.SWEEP:
            if sweep_done:
                state.next = SpanState.SPAN
                if empty:
                    state.next = SpanState.INHERIT
        elif state == SpanState.SPAN:
            state.next = SpanState.PAINT
            entering.next = True
            if begin_corner and cornered:
                state.next = SpanState.CORNER
                entering.next = False
        elif state == SpanState.CORNER:
            if corner_done:
                state.next = SpanState.PAINT
                entering.next = True
        elif state == SpanState.PAINT:
            if painted:
                state.next = SpanState.DESCEND
                if ending:
                    state.next = SpanState.EMIT
        elif state == SpanState.EMIT:
            # The row's last run ends all chains.
            if emitted:
                state.next = SpanState.INHERIT
                if stop == columns:
                    state.next = SpanState.IDLE
                elif stop == chain.stop:
                    state.next = SpanState.ASCEND
        elif state == SpanState.DESCEND:
            state.next = SpanState.SET_UP
        elif state == SpanState.ASCEND:
            state.next = SpanState.INHERIT
            if frame.part_stop != frame.stop:
                state.next = SpanState.RETURN
            elif frame.stop == frame_chain.stop:
                state.next = SpanState.ASCEND
        elif state == SpanState.RETURN:
            state.next = SpanState.SPAN
        else:
            state.next = SpanState.SWEEP
            entering.next = True

    @always(clk.posedge)
    def follow():
        if state == SpanState.IDLE:
            chain.word.next = first
            level.next = 0
        elif state == SpanState.SET_UP:
            column.next = chain.start
            gap.next = True
            count.next = entry_count
        elif state == SpanState.SWEEP:
            stop.next, inherited.next, heir.word.next = swept_stop, swept_inherited, swept_heir.word
        elif state == SpanState.DESCEND:
            chain.word.next = folded.word
            level.next = (level + 1) % (1 << len(level))
        elif state == SpanState.ASCEND:
            chain.word.next = frame_chain.word
            level.next = (level - 1) % (1 << len(level))
            winner.word.next = frame.winner
            gap.next = False
            column.next, stop.next, heir.word.next = frame.part_stop, frame.stop, frame.heir
            inherited.next, count.next = frame.inherited, frame.count
        elif state == SpanState.INHERIT:
            winner.word.next = heir.word
            gap.next = not inherited
            column.next = stop

    return instances()
