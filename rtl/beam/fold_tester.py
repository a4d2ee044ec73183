# SPDX-License-Identifier: MIT
"""Whether a folded ray hits a rectangle."""

from myhdl import always, always_comb, block

from raycaster.rtl.common.widths import bit, signed, unsigned

LATENCY = 3
"""Cycles from the way and the fold to the hit; the bounds are read one cycle in, the slope's magnitudes two."""


@block
def fold_tester(clk, facet, walk, column_slope, row_slope, slope, fold, hit, view_distance: int):
    """A ray a clock, as ray_fold folds it; hit.valid, numerator and denominator follow LATENCY cycles later.

    Along u the folded ray meets the plane at W = +-n D[u] + fold.u, over D[a]: between the two bounds it hits,
    whichever of them D[a] and the mirrors make the lesser. Beyond its last mirror it must be strictly, on the side that
    it runs to: on another axis W is compared with the mirror's border, on the same axis the planes' distances are.

    In the ray's cycle are read walk.way_u, the fold, and column_slope and row_slope, which are D[y] and D[z]; in the
    next the bounds; and in the one after that slope, their magnitudes. hit.index is not driven here.
    view_distance: D[x]. Widths are the ports'.
    """
    numerator_bits, slope_bits = len(hit.numerator), len(slope.dy)
    sum_bits, product_bits, turn_bits = len(fold.u_x), len(walk.way_u), len(fold.turn_x)

    back, turned, flip_u, flip_v = bit(), bit(), bit(), bit()
    mirror_on_a, mirror_on_u, mirror_on_v = bit(), bit(), bit()
    offset_u, offset_v = signed(sum_bits), signed(sum_bits)
    border = signed(product_bits)
    turn = signed(turn_bits)
    way_u, way_v = signed(product_bits), signed(product_bits)
    folded_u, folded_v = signed(sum_bits), signed(sum_bits)
    distance = signed(turn_bits + 1)
    opposite_distance = signed(turn_bits + 1)
    beyond_plane = bit()

    folded_u_1, folded_v_1 = signed(sum_bits), signed(sum_bits)
    distance_1 = signed(turn_bits + 1)
    border_1 = signed(product_bits)
    beyond_plane_1, clip_u_1, clip_v_1, rising_1 = bit(), bit(), bit(), bit()
    clipped = signed(sum_bits)
    numerator = unsigned(turn_bits)

    under_low_u, at_low_u, over_high_u, at_high_u = bit(), bit(), bit(), bit()
    under_low_v, at_low_v, over_high_v, at_high_v = bit(), bit(), bit(), bit()
    beyond = bit()
    numerator_2 = unsigned(numerator_bits)
    inside_u, inside_v = bit(), bit()
    e = unsigned(slope_bits)

    # The fold as the rectangle's axis sees it: of D[a] and of the folded ray's, which way they point.
    @always_comb
    def choose_fold():
        if facet.axis == 0:
            back.next = False
            turned.next = fold.back_x
            flip_u.next = fold.back_x != fold.back_y
            flip_v.next = fold.back_x != fold.back_z
            offset_u.next = fold.u_x
            offset_v.next = fold.v_x
            border.next = fold.border_x
            turn.next = fold.turn_x
        elif facet.axis == 1:
            back.next = column_slope < 0
            turned.next = fold.back_y
            flip_u.next = fold.back_y != fold.back_x
            flip_v.next = fold.back_y != fold.back_z
            offset_u.next = fold.u_y
            offset_v.next = fold.v_y
            border.next = fold.border_y
            turn.next = fold.turn_y
        else:
            back.next = row_slope < 0
            turned.next = fold.back_z
            flip_u.next = fold.back_z != fold.back_y
            flip_v.next = fold.back_z != fold.back_x
            offset_u.next = fold.u_z
            offset_v.next = fold.v_z
            border.next = fold.border_z
            turn.next = fold.turn_z

    # Where the mirror stands to the rectangle; the eye counts as one on the rectangle's own axis.
    @always_comb
    def place_mirror():
        mirror_on_a.next = (not fold.active) or (fold.axis == facet.axis)
        if facet.axis == 1:
            mirror_on_u.next = fold.active and (fold.axis == 0)
        else:
            mirror_on_u.next = fold.active and (fold.axis == 1)
        if facet.axis == 2:
            mirror_on_v.next = fold.active and (fold.axis == 0)
        else:
            mirror_on_v.next = fold.active and (fold.axis == 2)

    # On the same axis, the plane must lie on the side that the folded ray runs to.
    @always_comb
    def compare_planes():
        if back != turned:
            beyond_plane.next = (not mirror_on_a) or (facet.distance < fold.distance)
        else:
            beyond_plane.next = (not mirror_on_a) or (facet.distance > fold.distance)

    # The ways, or one less than their opposites, which the fold makes good.
    @always_comb
    def turn_ways():
        way_u.next = walk.way_u
        way_v.next = facet.way_v
        if flip_u:
            way_u.next = ~walk.way_u
        if flip_v:
            way_v.next = ~facet.way_v

    # The folded ray in the rectangle's plane, and how far the straight one runs to there.
    @always_comb
    def fold_ways():
        folded_u.next = offset_u + way_u
        folded_v.next = offset_v + way_v
        distance.next = facet.distance - turn

    # The first stage: everything that is compared.
    @always(clk.posedge)
    def stage_1():
        folded_u_1.next = folded_u
        folded_v_1.next = folded_v
        distance_1.next = distance
        border_1.next = border
        beyond_plane_1.next = beyond_plane
        clip_u_1.next = mirror_on_u
        clip_v_1.next = mirror_on_v
        rising_1.next = fold.mirror_back == back

    # The way along the mirror's axis.
    @always_comb
    def choose_clipped():
        clipped.next = folded_u_1
        if clip_v_1:
            clipped.next = folded_v_1

    # |n|; while a row is loaded it may be too large to keep, and nobody looks.
    @always_comb
    def negate():
        opposite_distance.next = -distance_1

    # Its magnitude.
    @always_comb
    def take_magnitude():
        numerator.next = distance_1[turn_bits:]
        if distance_1 < 0:
            numerator.next = opposite_distance[turn_bits:]

    # The second stage: how the ways lie to the bounds, and to the mirror.
    @always(clk.posedge)
    def stage_2():
        under_low_u.next = folded_u_1 < walk.low_u
        at_low_u.next = folded_u_1 == walk.low_u
        over_high_u.next = folded_u_1 > walk.high_u
        at_high_u.next = folded_u_1 == walk.high_u
        under_low_v.next = folded_v_1 < walk.low_v
        at_low_v.next = folded_v_1 == walk.low_v
        over_high_v.next = folded_v_1 > walk.high_v
        at_high_v.next = folded_v_1 == walk.high_v
        beyond.next = beyond_plane_1
        if clip_u_1 or clip_v_1:
            if rising_1:
                beyond.next = clipped > border_1
            else:
                beyond.next = clipped < border_1
        numerator_2.next = numerator[numerator_bits:]

    # Where D[a] is negative the bounds have changed places.
    @always_comb
    def judge():
        inside_u.next = ((not under_low_u) and (not over_high_u)) or (
            (under_low_u or at_low_u) and (over_high_u or at_high_u)
        )
        inside_v.next = ((not under_low_v) and (not over_high_v)) or (
            (under_low_v or at_low_v) and (over_high_v or at_high_v)
        )

    # |D[a]|
    @always_comb
    def choose_slope():
        if facet.axis == 0:
            e.next = view_distance
        elif facet.axis == 1:
            e.next = slope.dy
        else:
            e.next = slope.dz

    # The third stage: the verdict.
    @always(clk.posedge)
    def stage_3():
        hit.valid.next = facet.usable and beyond and inside_u and inside_v and (e != 0)
        hit.numerator.next = numerator_2
        hit.denominator.next = e

    return (
        choose_fold, place_mirror, compare_planes, turn_ways, fold_ways, stage_1, choose_clipped, negate,
        take_magnitude, stage_2, judge, choose_slope, stage_3,
    )  # fmt: skip
