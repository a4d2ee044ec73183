# SPDX-License-Identifier: MIT
"""Whether a folded ray hits a rectangle."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def fold_tester(clk, step_way, step_bounds, step_slope, facet, walk, signs, slope, fold, index, hit, staged: bool):
    """Test whether a ray that ray_fold folds hits a rectangle: a ray per clock, the hit `TESTER_LATENCY` cycles later.

    Along p the folded ray meets the plane at W = +-n D[p] + fold.p, over D[a]: it hits if that is between the two
    bounds, which are compared as in ray_tester. It must be beyond its last mirror, on the side that it runs to: on
    another axis W is compared with the mirror's border, on the same axis the planes' distances are compared. Right at
    the mirror it hits rectangles on an axis on which it has met no mirror in that point.

    The ray's cycle is the one in which step_way is high. A stage without its strobe keeps its contents. The block takes
    its widths from its ports.

    Args:
        clk: the clock.
        step_way: strobe; high in the ray's cycle.
        step_bounds: strobe; high in the cycle after the ray's cycle.
        step_slope: strobe; high in the third cycle, two after the ray's cycle.
        facet: `Facet` of the rectangle, which serves all rays of a row.
        walk: `Walk` of the rectangle; the ways are read with step_way, the bounds with step_bounds.
        signs: `Signs` of D; read with step_way.
        slope: `Slope`, the magnitudes of D; read with step_bounds if staged, otherwise with step_slope.
        fold: `Fold` of the ray; read a cycle before the ray's cycle if staged, otherwise in the ray's cycle.
        index: unsigned, as wide as hit.index; the rectangle's number, constant.
        hit: `Candidate`; output, `TESTER_LATENCY` cycles after the ray's cycle.
        staged: registers the fields that the block chooses from fold and slope; see is_staged.
    """
    along_q = walk.way_q if "way_q" in walk.layout else facet.way_q
    numerator_bits, slope_bits = len(hit.numerator), len(slope.dy)
    sum_bits, product_bits, turn_bits = len(fold.p_x), len(walk.way_p), len(fold.turn_x)

    back, turned, flip_p, flip_q = bit(), bit(), bit(), bit()
    mirror_on_p, mirror_on_q, mirror_back, met = bit(), bit(), bit(), bit()
    offset_p, offset_q = signed(sum_bits), signed(sum_bits)
    border = signed(product_bits)
    turn = signed(turn_bits)
    mirror_distance = signed(len(fold.distance))
    way_p, way_q = signed(product_bits), signed(product_bits)
    folded_p, folded_q = signed(sum_bits), signed(sum_bits)
    distance = signed(turn_bits + 1)
    opposite_distance = signed(turn_bits + 1)
    beyond_plane = bit()

    back_1, folded_p_1, folded_q_1 = bit(), signed(sum_bits), signed(sum_bits)
    distance_1 = signed(turn_bits + 1)
    border_1 = signed(product_bits)
    beyond_plane_1, clip_p_1, clip_q_1, rising_1, met_1 = bit(), bit(), bit(), bit(), bit()
    clipped, folded_clip = signed(sum_bits), signed(sum_bits)
    numerator = unsigned(turn_bits)
    twice_p, twice_q, edge_p, edge_q = (signed(sum_bits + 1) for _ in range(4))
    twice_low_p, twice_low_q, twice_high_p, twice_high_q = (signed(product_bits + 1) for _ in range(4))
    low_edge_p, low_edge_q = (signed(product_bits + 1) for _ in range(2))

    under_low_p, over_high_p, under_low_q, over_high_q = (bit() for _ in range(4))
    before_border, at_border = bit(), bit()
    back_2, beyond_plane_2, before_border_2, at_border_2, clips_2, rising_2, met_2 = (bit() for _ in range(7))
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
    def choose_fold():
        mirror_back.next = fold.mirror_back
        mirror_distance.next = fold.distance
        if facet.axis == 0:
            turned.next = fold.back_x
            met.next = fold.met_x
            flip_p.next = fold.back_x != fold.back_y
            flip_q.next = fold.back_x != fold.back_z
            offset_p.next = fold.p_x
            offset_q.next = fold.q_x
            border.next = fold.border_x
            turn.next = fold.turn_x
            mirror_on_p.next = fold.axis == 1
            mirror_on_q.next = fold.axis == 2
        elif facet.axis == 1:
            turned.next = fold.back_y
            met.next = fold.met_y
            flip_p.next = fold.back_y != fold.back_x
            flip_q.next = fold.back_y != fold.back_z
            offset_p.next = fold.p_y
            offset_q.next = fold.q_y
            border.next = fold.border_y
            turn.next = fold.turn_y
            mirror_on_p.next = fold.axis == 0
            mirror_on_q.next = fold.axis == 2
        else:
            turned.next = fold.back_z
            met.next = fold.met_z
            flip_p.next = fold.back_z != fold.back_y
            flip_q.next = fold.back_z != fold.back_x
            offset_p.next = fold.p_z
            offset_q.next = fold.q_z
            border.next = fold.border_z
            turn.next = fold.turn_z
            mirror_on_p.next = fold.axis == 1
            mirror_on_q.next = fold.axis == 0

    chooser = always(clk.posedge)(choose_fold) if staged else always_comb(choose_fold)

    # On the same axis, the plane must lie on the side that the folded ray runs to.
    @always_comb
    def compare_planes():
        if back != turned:
            beyond_plane.next = facet.distance < mirror_distance
        else:
            beyond_plane.next = facet.distance > mirror_distance

    # ~way is one less than -way; the fold's offset is one more in return.
    @always_comb
    def turn_ways():
        way_p.next = walk.way_p
        way_q.next = along_q
        if flip_p:
            way_p.next = ~walk.way_p
        if flip_q:
            way_q.next = ~along_q

    @always_comb
    def fold_ways():
        folded_p.next = offset_p + way_p
        folded_q.next = offset_q + way_q
        distance.next = facet.distance - turn

    @always(clk.posedge)
    def stage_1():
        if step_way:
            back_1.next = back
            folded_p_1.next = folded_p
            folded_q_1.next = folded_q
            distance_1.next = distance
            border_1.next = border
            beyond_plane_1.next = beyond_plane
            clip_p_1.next = mirror_on_p
            clip_q_1.next = mirror_on_q
            rising_1.next = mirror_back == back
            met_1.next = met

    if staged:

        @always_comb
        def choose_clipped():
            folded_clip.next = folded_p
            if mirror_on_q:
                folded_clip.next = folded_q

        @always(clk.posedge)
        def hold_clipped():
            if step_way:
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

    @always_comb
    def double():
        twice_p.next = folded_p_1 << 1
        twice_q.next = folded_q_1 << 1
        twice_high_p.next = walk.high_p << 1
        twice_high_q.next = walk.high_q << 1
        twice_low_p.next = walk.low_p << 1
        twice_low_q.next = walk.low_q << 1

    @always_comb
    def add_sign():
        edge_p.next = twice_p | back_1
        edge_q.next = twice_q | back_1
        low_edge_p.next = twice_low_p | back_1
        low_edge_q.next = twice_low_q | back_1

    @always(clk.posedge)
    def stage_2():
        if step_bounds:
            back_2.next = back_1
            under_low_p.next = twice_p < low_edge_p
            over_high_p.next = twice_high_p < edge_p
            under_low_q.next = twice_q < low_edge_q
            over_high_q.next = twice_high_q < edge_q
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

    @always_comb
    def judge():
        inside_p.next = (under_low_p == back_2) and (over_high_p == back_2)
        inside_q.next = (under_low_q == back_2) and (over_high_q == back_2)

    # e is |D[a]|.
    @always_comb
    def choose_slope():
        if facet.axis == 0:
            e.next = slope.dx
        elif facet.axis == 1:
            e.next = slope.dy
        else:
            e.next = slope.dz

    if staged:

        @always(clk.posedge)
        def hold_slope():
            if step_bounds:
                e_2.next = e

    else:
        e_2 = e

    @always_comb
    def conclude():
        valid.next = facet.usable and beyond and inside_p and inside_q and (e_2 != 0)

    if "cell" in hit.layout:

        @always(clk.posedge)
        def stage_3():
            if step_slope:
                hit.word.next = concat(valid, at_mirror, numerator_2, e_2, facet.axis, facet.cell, index)

    else:

        @always(clk.posedge)
        def stage_3():
            if step_slope:
                hit.word.next = concat(valid, at_mirror, numerator_2, e_2, index)

    return instances()
