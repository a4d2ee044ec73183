# SPDX-License-Identifier: MIT
"""Whether a folded ray hits a rectangle."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.records import Record
from raycaster.rtl.common.ties import Signed
from raycaster.rtl.common.widths import bit, signed, unsigned

LATENCY = 3
"""Cycles from the way to the hit; the bounds are read one cycle in, the slope's magnitudes `slope_at`."""


def fold_lead(config: Configuration) -> int:
    """Cycles from the fold to the way: where the camera turns, all is wider, and what a tester takes of the fold is
    registered."""
    return 1 if config.turn else 0


def slope_at(config: Configuration) -> int:
    """Cycles from the way to the slope's magnitudes: where the camera turns, the chosen one is registered."""
    return 1 if config.turn else 2


@block
def fold_tester(clk, facet, walk, signs, slope, fold, index, hit):
    """A ray a clock, as ray_fold folds it; hit, of the rectangle index, follows LATENCY cycles later.

    Along p the folded ray meets the plane at W = +-n D[p] + fold.p, over D[a]: between the two bounds it hits,
    whichever of them D[a] and the mirrors make the lesser. It must be beyond its last mirror, on the side that it runs
    to: on another axis W is compared with the mirror's border, on the same axis the planes' distances are. Right at the
    mirror it hits what is on an axis that it has met no mirror on in that point.

    In the ray's cycle are read walk's ways, and signs, which are those of D; fold_lead cycles earlier the fold; in the
    next cycle the bounds; and slope_at cycles later slope, the magnitudes of D. Widths are the ports'.
    """
    turns = "way_q" in walk.layout
    along_q = walk.way_q if turns else facet.way_q
    numerator_bits, slope_bits = len(hit.numerator), len(slope.dy)
    sum_bits, product_bits, turn_bits = len(fold.p_x), len(walk.way_p), len(fold.turn_x)

    back, turned, flip_p, flip_q = bit(), bit(), bit(), bit()
    mirror_on_a, mirror_on_p, mirror_on_q, met = bit(), bit(), bit(), bit()
    offset_p, offset_q = signed(sum_bits), signed(sum_bits)
    border = signed(product_bits)
    turn = signed(turn_bits)
    flags = "turned", "met", "flip_p", "flip_q", "mirror_on_a", "mirror_on_p", "mirror_on_q", "mirror_back"
    choice = Record(
        dict.fromkeys(flags, 1)
        | dict.fromkeys(("offset_p", "offset_q"), Signed(sum_bits))
        | {"border": Signed(product_bits), "turn": Signed(turn_bits), "distance": Signed(len(fold.distance))}
    )
    held = choice.twin() if turns else choice
    way_p, way_q = signed(product_bits), signed(product_bits)
    folded_p, folded_q = signed(sum_bits), signed(sum_bits)
    distance = signed(turn_bits + 1)
    opposite_distance = signed(turn_bits + 1)
    beyond_plane = bit()

    folded_p_1, folded_q_1 = signed(sum_bits), signed(sum_bits)
    distance_1 = signed(turn_bits + 1)
    border_1 = signed(product_bits)
    beyond_plane_1, clip_p_1, clip_q_1, rising_1, met_1 = bit(), bit(), bit(), bit(), bit()
    clipped, folded_clip = signed(sum_bits), signed(sum_bits)
    numerator = unsigned(turn_bits)

    under_low_p, at_low_p, over_high_p, at_high_p = bit(), bit(), bit(), bit()
    under_low_q, at_low_q, over_high_q, at_high_q = bit(), bit(), bit(), bit()
    before_border, at_border = bit(), bit()
    beyond_plane_2, before_border_2, at_border_2, clips_2, rising_2, met_2 = (bit() for _ in range(6))
    beyond, at_mirror = bit(), bit()
    numerator_2 = unsigned(numerator_bits)
    inside_p, inside_q, valid = bit(), bit(), bit()
    e, e_2 = unsigned(slope_bits), unsigned(slope_bits)

    # D[a] is negative.
    @always_comb
    def choose_sign():
        if facet.axis == 0:
            back.next = signs.dx
        elif facet.axis == 1:
            back.next = signs.dy
        else:
            back.next = signs.dz

    # turned: a mirror has turned the ray around.
    @always_comb
    def choose_fold():
        if facet.axis == 0:
            turned.next = fold.back_x
            met.next = fold.met_x
            flip_p.next = fold.back_x != fold.back_y
            flip_q.next = fold.back_x != fold.back_z
            offset_p.next = fold.p_x
            offset_q.next = fold.q_x
            border.next = fold.border_x
            turn.next = fold.turn_x
        elif facet.axis == 1:
            turned.next = fold.back_y
            met.next = fold.met_y
            flip_p.next = fold.back_y != fold.back_x
            flip_q.next = fold.back_y != fold.back_z
            offset_p.next = fold.p_y
            offset_q.next = fold.q_y
            border.next = fold.border_y
            turn.next = fold.turn_y
        else:
            turned.next = fold.back_z
            met.next = fold.met_z
            flip_p.next = fold.back_z != fold.back_y
            flip_q.next = fold.back_z != fold.back_x
            offset_p.next = fold.p_z
            offset_q.next = fold.q_z
            border.next = fold.border_z
            turn.next = fold.turn_z

    # Without a mirror, the camera counts as one on the rectangle's own axis.
    @always_comb
    def place_mirror():
        mirror_on_a.next = (not fold.active) or (fold.axis == facet.axis)
        if facet.axis == 1:
            mirror_on_p.next = fold.active and (fold.axis == 0)
        else:
            mirror_on_p.next = fold.active and (fold.axis == 1)
        if facet.axis == 2:
            mirror_on_q.next = fold.active and (fold.axis == 0)
        else:
            mirror_on_q.next = fold.active and (fold.axis == 2)

    @always_comb
    def take_fold():
        choice.word.next = concat(
            turned, met, flip_p, flip_q, mirror_on_a, mirror_on_p, mirror_on_q, fold.mirror_back, offset_p, offset_q,
            border, turn, fold.distance,
        )  # fmt: skip

    if turns:

        @always(clk.posedge)
        def hold():
            held.word.next = choice.word

    # On the same axis, the plane must lie on the side that the folded ray runs to.
    @always_comb
    def compare_planes():
        if back != held.turned:
            beyond_plane.next = (not held.mirror_on_a) or (facet.distance < held.distance)
        else:
            beyond_plane.next = (not held.mirror_on_a) or (facet.distance > held.distance)

    # ~way is one less than -way; the fold's offset is one more in return.
    @always_comb
    def turn_ways():
        way_p.next = walk.way_p
        way_q.next = along_q
        if held.flip_p:
            way_p.next = ~walk.way_p
        if held.flip_q:
            way_q.next = ~along_q

    @always_comb
    def fold_ways():
        folded_p.next = held.offset_p + way_p
        folded_q.next = held.offset_q + way_q
        distance.next = facet.distance - held.turn

    @always(clk.posedge)
    def stage_1():
        folded_p_1.next = folded_p
        folded_q_1.next = folded_q
        distance_1.next = distance
        border_1.next = held.border
        beyond_plane_1.next = beyond_plane
        clip_p_1.next = held.mirror_on_p
        clip_q_1.next = held.mirror_on_q
        rising_1.next = held.mirror_back == back
        met_1.next = held.met

    if turns:

        @always_comb
        def choose_clipped():
            folded_clip.next = folded_p
            if held.mirror_on_q:
                folded_clip.next = folded_q

        @always(clk.posedge)
        def hold_clipped():
            clipped.next = folded_clip

    else:

        @always_comb
        def choose_clipped():
            clipped.next = folded_p_1
            if clip_q_1:
                clipped.next = folded_q_1

    @always_comb
    def compare_border():
        before_border.next = clipped < border_1
        at_border.next = clipped == border_1

    # |n|. While a row is loaded it may overflow, and is don't care.
    @always_comb
    def negate():
        opposite_distance.next = -distance_1

    @always_comb
    def take_magnitude():
        numerator.next = distance_1[turn_bits:]
        if distance_1 < 0:
            numerator.next = opposite_distance[turn_bits:]

    @always(clk.posedge)
    def stage_2():
        under_low_p.next = folded_p_1 < walk.low_p
        at_low_p.next = folded_p_1 == walk.low_p
        over_high_p.next = folded_p_1 > walk.high_p
        at_high_p.next = folded_p_1 == walk.high_p
        under_low_q.next = folded_q_1 < walk.low_q
        at_low_q.next = folded_q_1 == walk.low_q
        over_high_q.next = folded_q_1 > walk.high_q
        at_high_q.next = folded_q_1 == walk.high_q
        beyond_plane_2.next = beyond_plane_1
        before_border_2.next = before_border
        at_border_2.next = at_border
        clips_2.next = clip_p_1 or clip_q_1
        rising_2.next = rising_1
        met_2.next = met_1
        numerator_2.next = numerator[numerator_bits:]

    @always_comb
    def leave_mirror():
        beyond.next = beyond_plane_2
        at_mirror.next = False
        if clips_2:
            at_mirror.next = at_border_2
            if at_border_2:
                beyond.next = not met_2
            else:
                beyond.next = before_border_2 != rising_2

    # Where D[a] is negative the bounds have changed places.
    @always_comb
    def judge():
        inside_p.next = ((not under_low_p) and (not over_high_p)) or (
            (under_low_p or at_low_p) and (over_high_p or at_high_p)
        )
        inside_q.next = ((not under_low_q) and (not over_high_q)) or (
            (under_low_q or at_low_q) and (over_high_q or at_high_q)
        )

    # e is |D[a]|.
    @always_comb
    def choose_slope():
        if facet.axis == 0:
            e.next = slope.dx
        elif facet.axis == 1:
            e.next = slope.dy
        else:
            e.next = slope.dz

    if turns:

        @always(clk.posedge)
        def hold_slope():
            e_2.next = e

    else:
        e_2 = e

    @always_comb
    def conclude():
        valid.next = facet.usable and beyond and inside_p and inside_q and (e_2 != 0)

    if "cell" in hit.layout:

        @always(clk.posedge)
        def stage_3():
            hit.word.next = concat(valid, at_mirror, numerator_2, e_2, facet.axis, facet.cell, index)

    else:

        @always(clk.posedge)
        def stage_3():
            hit.word.next = concat(valid, at_mirror, numerator_2, e_2, index)

    return instances()
