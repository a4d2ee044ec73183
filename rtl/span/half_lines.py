# SPDX-License-Identifier: MIT
"""The half-lines of all rectangles that a chain's rays may meet."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.signals import Signed, bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.by_axis import along_a, along_u, along_v, by_axis
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.records import Rect
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    column_bits,
    eye_bits,
    eye_distance_bits,
    index_bits,
    line_factor_bits,
)
from raycaster.rtl.span.mirror_side import mirror_side
from raycaster.rtl.span.records import AHEAD, BEYOND, NUMBER_BITS, U_HIGH, U_LOW, V_HIGH, V_LOW

MOST_IN_A_CHAIN = 64
"""Most rectangles among which a chain of choices finds the next one; with more, the chain is too long."""


@block
def half_lines(
    clk, reset, start, chain, rects, from_light, asks, answer, done, opened, entry, walked,
    config: Configuration,
):  # fmt: skip
    """Ask for the half-lines of each rectangle in the table's order, except of those that the rays cannot meet.

    A ray of the chain meets the rectangle's plane k on axis a at t = N / e, with n = k - E[a], N = |n|, and e the
    slope's component on that axis with the sign of n, negated if the chain has changed that component's sign. It meets
    the rectangle in the columns where all of these lines are not negative, with W one of the other axes, D'[W] the
    slope's component after the mirrors, and t = M / m at the last mirror:

    | number | line |
    | --- | --- |
    | `AHEAD` | e - 1 |
    | `U_LOW`, `V_LOW` | N D'[W] - (low - E[W]) e |
    | `U_HIGH`, `V_HIGH` | (high - E[W]) e - N D'[W] |
    | `BEYOND` | N m - M e, less 1 if a mirror on that axis was met in the same point |

    Without n, or with e <= 0 at both ends of the chain, there is no hit and no line; nor if the rectangle is before
    the last mirror's plane, or on it as another mirror on that axis. `BEYOND` is only asked unless all of the rectangle
    is beyond that plane. `AHEAD` is only asked where the
    others do not imply it: e <= 0 at one end, and the rectangle is a point, or the slope may be 0 in some column.

    Rays from the light, as if it were the eye of a chain, meet a surface at t = 1 / s, with s the e of that surface.
    For them `AHEAD` is e - N s - 1, and is always asked: the rectangle is between the light and the surface.

    Args:
        reset: flag; synchronous reset, which ends the walk.
        start: strobe; begins with the rectangles of this chain.
        chain: `Chain`; constant from the cycle after start to done.
        rects: `Rects`; index and fetch are outputs.
        from_light: flag, read with `config.light`; the chain's rays come from the light. Constant from start to done.
        asks: output `Asks`; only ask and query are driven.
        answer: `Answer`.
        done: strobe; all lines are answered and used, so the walk is over.
        opened: output strobe; the lines of a rectangle follow.
        entry: output `Entry`, valid with opened; start and stop are 0.
        walked: output flag; all lines have been asked. Low before start.
    """
    far_bits, factor_bits, columns = eye_bits(config), line_factor_bits(config), column_bits(config)
    count, index_width = config.rectangles, index_bits(config)

    seeing, walking = bit(), bit()
    lit = from_light if config.light else tied(0, 1)
    asked_axis = unsigned(AXIS_BITS)
    waiting, others = unsigned(count), unsigned(count)
    lowest, upcoming, index = (unsigned(index_width) for _ in range(3))
    offered, at_hand, passes, weighed, take, fetch, taking, moving = (bit() for _ in range(8))
    fore_left, fore_right, aft_left, aft_right = (unsigned(3) for _ in range(4))
    may_vanish = bit()

    position, eye_a, n = signed(far_bits), signed(far_bits), signed(far_bits + 1)
    distance = unsigned(eye_distance_bits(config))
    flipped, fore_left_a, fore_right_a, aft_left_a, aft_right_a = (bit() for _ in range(5))
    point, back, apart, ahead_left, ahead_right, skip, tested_ahead, ready, accept = (bit() for _ in range(9))
    weighed_rect, weighed_entry = Rect(config), entry.twin()
    weighed_point, weighed_apart = bit(), bit()

    issuing, last = bit(), bit()
    number = unsigned(NUMBER_BITS)
    mirrors = chain.has("mirrored")
    last_number = unsigned(NUMBER_BITS) if mirrors else tied(V_HIGH, NUMBER_BITS)
    hidden, crosses, crosses_1 = (bit(), bit(), bit()) if mirrors else (tied(0, 1), tied(0, 1), tied(0, 1))
    mirror_axis = unsigned(AXIS_BITS) if mirrors else tied(0, AXIS_BITS)
    mirror_distance = signed(factor_bits) if mirrors else tied(0, Signed(factor_bits))
    rect_1, entry_1 = Rect(config), entry.twin()
    axis_u, axis_v, axis_w, axis_1, axis_2 = (unsigned(AXIS_BITS) for _ in range(5))
    on_u, low, met, back_w, back_1, back_2, strict, half_line = (bit() for _ in range(8))
    bound = unsigned(COORDINATE_BITS)
    number_asked = unsigned(NUMBER_BITS)
    eye_w = signed(far_bits)
    whole_bound, offset, whole_distance, factor_1, factor_2 = (signed(factor_bits) for _ in range(5))
    no_columns = tied(0, columns)

    # The slope's components at the ends of the chain come first.
    @always(clk.posedge)
    def see_slope():
        if reset:
            seeing.next = walking.next = False
        elif start:
            seeing.next = True
            asked_axis.next = 0
        else:
            if seeing and asked_axis != 3:
                asked_axis.next = asked_axis + 1
            if seeing and answer.valid and answer.number == 2:
                seeing.next = False
                walking.next = True
            if done:
                walking.next = False

    @always(clk.posedge)
    def keep_signs():
        for axis in range(3):
            if seeing and answer.valid and (answer.number == axis):
                fore_left.next[axis] = answer.left > 0
                fore_right.next[axis] = answer.right > 0
                aft_left.next[axis] = answer.left < 0
                aft_right.next[axis] = answer.right < 0

    # In a column with a slope of 0, each component is 0 or changes its sign within the chain.
    see_vanishing = assign(may_vanish, lambda: ((fore_left & fore_right) | (aft_left & aft_right)) == 0)

    if count <= MOST_IN_A_CHAIN:

        @always_comb
        def choose_rectangle():
            lowest.next = 0
            others.next = waiting
            for i in range(count - 1, -1, -1):
                if waiting[i]:
                    lowest.next = i
                    others.next = waiting
                    others.next[i] = 0

    else:
        below, first = unsigned(count), unsigned(count)
        mask_0, mask_1, mask_2, mask_3, mask_4, mask_5, mask_6 = (
            tied(sum(1 << i for i in range(count) if i >> place & 1), count) for place in range(7)
        )

        # Subtracting 1 changes the bits up to the lowest one that is set.
        count_down = assign(below, lambda: (waiting - 1) % (1 << count))

        drop_first = assign(others, lambda: waiting & below)
        find_first = assign(first, lambda: waiting & ~below)

        # Each bit of the number is set if the rectangle is among those whose numbers have it.
        @always_comb
        def choose_rectangle():
            lowest.next[0] = (first & mask_0) != 0
            lowest.next[1] = (first & mask_1) != 0
            lowest.next[2] = (first & mask_2) != 0
            lowest.next[3] = (first & mask_3) != 0
            lowest.next[4] = (first & mask_4) != 0
            lowest.next[5] = (first & mask_5) != 0
            lowest.next[6] = (first & mask_6) != 0

    @always_comb
    def see_fetch():
        passes.next = at_hand and (take or not weighed)
        fetch.next = offered and (seeing or walking) and ((not at_hand) or take or not weighed)

    # The strobe start comes late in its cycle: in the next one the rectangles are taken, then the first one is chosen.
    @always_comb
    def show_fetch():
        taking.next = seeing and asked_axis == 0
        moving.next = fetch or (seeing and asked_axis == 1)
        rects.index.next, rects.fetch.next = upcoming, fetch

    @always(clk.posedge)
    def offer():
        if reset:
            offered.next = False
        elif taking:
            waiting.next = rects.usable
        elif moving:
            offered.next = waiting != 0
            upcoming.next, waiting.next = lowest, others

    @always(clk.posedge)
    def follow_fetch():
        if fetch:
            index.next = upcoming
        if reset or start:
            at_hand.next = False
        elif fetch:
            at_hand.next = True
        elif passes:
            at_hand.next = False

    choices = [
        by_axis(rects.rect.axis, *values, chosen, width=len(chosen))
        for values, chosen in (
            ((chain.eye_x, chain.eye_y, chain.eye_z), eye_a), ((chain.back_x, chain.back_y, chain.back_z), flipped),
        )
    ]  # fmt: skip
    signs = [
        by_axis(weighed_entry.axis, *values, chosen, width=len(chosen))
        for values, chosen in (
            ((fore_left(0), fore_left(1), fore_left(2)), fore_left_a),
            ((fore_right(0), fore_right(1), fore_right(2)), fore_right_a),
            ((aft_left(0), aft_left(1), aft_left(2)), aft_left_a),
            ((aft_right(0), aft_right(1), aft_right(2)), aft_right_a),
        )
    ]  # fmt: skip

    extend = assign(position, lambda: rects.rect.position)
    measure = assign(n, lambda: position - eye_a)

    size = magnitude(n, distance)

    turn = assign(back, lambda: flipped != (n < 0))

    @always_comb
    def see_point():
        point.next = (rects.rect.u_low == rects.rect.u_high) and (rects.rect.v_low == rects.rect.v_high)
        apart.next = (n == 0) or hidden

    met_rectangle = weighed_entry.joined(
        index=index, axis=rects.rect.axis, back=back, distance=distance, start=no_columns, stop=no_columns
    )

    # The first rectangle is weighed before the signs are there.
    @always(clk.posedge)
    def weigh():
        if reset or start:
            weighed.next = False
        elif passes:
            weighed.next = True
        elif take:
            weighed.next = False
        if passes:
            weighed_rect.word.next = rects.rect.word
            weighed_entry.word.next, weighed_point.next, weighed_apart.next = met_rectangle, point, apart

    see_ahead_left = assign(ahead_left, lambda: aft_left_a if weighed_entry.back else fore_left_a)
    see_ahead_right = assign(ahead_right, lambda: aft_right_a if weighed_entry.back else fore_right_a)

    @always_comb
    def judge():
        skip.next = weighed_apart or not (ahead_left or ahead_right)
        tested_ahead.next = lit or ((ahead_left != ahead_right) and (weighed_point or may_vanish))
        ready.next = (not issuing) or last

    @always_comb
    def decide():
        take.next = walking and weighed and (skip or ready)
        accept.next = walking and weighed and ready and not skip

    announce = assign((opened, entry.word), lambda: (accept, weighed_entry.word))

    @always(clk.posedge)
    def issue():
        if reset:
            issuing.next = False
        elif accept:
            issuing.next = True
        elif last:
            issuing.next = False
        if accept:
            number.next = U_LOW
            if tested_ahead:
                number.next = AHEAD
        elif issuing:
            number.next = (number + 1) % (1 << NUMBER_BITS)

    hold = register(clk, (rect_1.word, entry_1.word), lambda: (weighed_rect.word, entry.word), accept)

    see_end = assign(walked, lambda: walking and not (offered or at_hand or weighed or issuing))

    # The lines of the rectangle that is held.
    @always_comb
    def choose_extent():
        low.next = on_u.next = False
        if number == U_LOW:
            low.next = on_u.next = True
        elif number == U_HIGH:
            on_u.next = True
        elif number == V_LOW:
            low.next = True
        last.next = issuing and (number == last_number)

    @always_comb
    def choose_bound():
        bound.next = rect_1.v_high
        if number == U_LOW:
            bound.next = rect_1.u_low
        elif number == U_HIGH:
            bound.next = rect_1.u_high
        elif number == V_LOW:
            bound.next = rect_1.v_low

    axes = [tied(axis, AXIS_BITS) for axis in range(3)]
    of_line = [
        by_axis(axis, *values, chosen, width=len(chosen))
        for axis, values, chosen in (
            (entry_1.axis, along_u(*axes), axis_u), (entry_1.axis, along_v(*axes), axis_v),
            (axis_w, (chain.eye_x, chain.eye_y, chain.eye_z), eye_w),
            (axis_w, (chain.back_x, chain.back_y, chain.back_z), back_w),
            (entry_1.axis, along_a(chain.met_x, chain.met_y, chain.met_z), met),
        )
    ]  # fmt: skip

    choose_axis = assign(axis_w, lambda: axis_u if on_u else axis_v)

    extend_bound = assign((whole_bound, whole_distance), lambda: (bound, entry_1.distance))

    measure_bound = assign(offset, lambda: whole_bound - eye_w)

    if mirrors:
        side = mirror_side(
            clk=clk, chain=chain, rect=rects.rect, hidden=hidden, crosses=crosses, config=config
        )  # fmt: skip

        see_mirror = assign((mirror_axis, mirror_distance), lambda: (chain.axis, chain.distance))

        see_last_number = assign(last_number, lambda: BEYOND if crosses_1 else V_HIGH)

        weighed_crosses = bit()

        @always(clk.posedge)
        def hold_side():
            if passes:
                weighed_crosses.next = crosses
            if accept:
                crosses_1.next = weighed_crosses

    @always_comb
    def choose_line():
        half_line.next = True
        number_asked.next = number
        strict.next = False
        axis_1.next, back_1.next, factor_1.next = axis_w, back_w, whole_distance
        axis_2.next, back_2.next, factor_2.next = entry_1.axis, entry_1.back, offset
        if seeing:
            half_line.next = False
            number_asked.next = axis_1.next = asked_axis
            back_1.next, factor_1.next = False, 1
            axis_2.next, back_2.next, factor_2.next = asked_axis, False, 0
        elif number == AHEAD:
            axis_1.next, back_1.next = entry_1.axis, entry_1.back
            factor_1.next = 1
            factor_2.next = 0
            strict.next = True
            if lit:
                axis_2.next = 3
                back_2.next = False
                factor_2.next = whole_distance
        elif number == BEYOND:
            axis_1.next, back_1.next, factor_2.next, strict.next = mirror_axis, chain.back, mirror_distance, met
        elif not low:
            axis_1.next, back_1.next, factor_1.next = entry_1.axis, entry_1.back, offset
            axis_2.next, back_2.next, factor_2.next = axis_w, back_w, whole_distance

    right = unsigned(columns)

    see_last_column = assign(right, lambda: (chain.stop - 1) % (1 << columns))

    asked = asks.query.joined(
        from_light=lit, left=chain.start, right=right, strict=strict, axis_1=axis_1, back_1=back_1, factor_1=factor_1,
        axis_2=axis_2, back_2=back_2, factor_2=factor_2, half_line=half_line, last=last, number=number_asked,
    )  # fmt: skip

    @always_comb
    def query_line():
        asks.ask.next = issuing or (seeing and asked_axis != 3)
        asks.query.word.next = asked

    return instances()
