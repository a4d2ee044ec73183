# SPDX-License-Identifier: MIT
"""A test of a folded ray against a rectangle."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.rtl.beam.bound_tester import bound_tester
from raycaster.rtl.common.by_axis import along_a, along_p, along_q, by_axis
from raycaster.rtl.common.magnitude import magnitude


@block
def fold_tester(clk, step_way, step_bounds, step_slope, facet, walk, signs, slope, fold, index, hit, staged: bool):
    """Test whether a ray folded by ray_fold hits a rectangle: one ray per clock, the hit `TESTER_LATENCY` cycles later.

    Along p the folded ray meets the plane at W / D[a], with W = +-n D[p] + fold.p: it hits if that is between the two
    bounds. The hit must be beyond the last mirror, on the side that the ray runs to: for a rectangle on another axis W
    is compared with the mirror's border, on the same axis the planes' distances are compared. Exactly at the mirror,
    the ray hits only rectangles on an axis on which it has met no mirror at that point.

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
        staged: register the fields that the block chooses from fold and slope; see is_staged.
    """
    way_q = walk.way_q if walk.has("way_q") else facet.way_q
    numerator_bits, slope_bits = len(hit.numerator), len(slope.dy)
    sum_bits, product_bits, shift_bits = len(fold.p_x), len(walk.way_p), len(fold.shift_x)

    back, reversed_a, reversed_p, reversed_q, on_p, on_q, met = (bit() for _ in range(7))
    offset_p, offset_q, border, shift = signed(sum_bits), signed(sum_bits), signed(product_bits), signed(shift_bits)
    on_x, on_y, on_z, flip_p, flip_q = (bit() for _ in range(5))
    # The fields of fold for the plane's axis; mirror_on_p: the last mirror is across p.
    plane_fold = Record({
        "reversed_a": 1, "flip_p": 1, "flip_q": 1, "mirror_on_p": 1, "mirror_on_q": 1, "mirror_back": 1, "met": 1,
        "offset_p": Signed(sum_bits), "offset_q": Signed(sum_bits), "border": Signed(product_bits),
        "shift": Signed(shift_bits), "distance": Signed(len(fold.distance)),
    })  # fmt: skip
    flipped_way_p, flipped_way_q = signed(product_bits), signed(product_bits)
    folded_p, folded_q = signed(sum_bits), signed(sum_bits)
    distance = signed(shift_bits + 1)
    beyond_plane = bit()

    back_1, folded_p_1, folded_q_1 = bit(), signed(sum_bits), signed(sum_bits)
    distance_1, border_1 = signed(shift_bits + 1), signed(product_bits)
    beyond_plane_1, clip_p_1, clip_q_1, rising_1, met_1 = (bit() for _ in range(5))
    clipped, folded_clip = signed(sum_bits), signed(sum_bits)
    numerator = unsigned(shift_bits)

    before_border, at_border = bit(), bit()
    beyond_plane_2, before_border_2, at_border_2, clips_2, rising_2, met_2 = (bit() for _ in range(6))
    beyond, at_mirror, inside_p, inside_q, valid = (bit() for _ in range(5))
    numerator_2 = unsigned(numerator_bits)
    e, size_a = unsigned(slope_bits), unsigned(slope_bits)

    # back: D[a] is negative; e is |D[a]|; reversed_a: mirrors have reversed the ray along a.
    of_back, of_mirror = (fold.back_x, fold.back_y, fold.back_z), (on_x, on_y, on_z)
    choices = [
        by_axis(facet.axis, *along(*values), chosen, width=len(chosen))
        for along, values, chosen in (
            (along_a, (signs.dx, signs.dy, signs.dz), back),
            (along_a, (slope.dx, slope.dy, slope.dz), size_a if staged else e),
            (along_a, of_back, reversed_a), (along_p, of_back, reversed_p), (along_q, of_back, reversed_q),
            (along_p, of_mirror, on_p), (along_q, of_mirror, on_q),
            (along_a, (fold.met_x, fold.met_y, fold.met_z), met),
            (along_a, (fold.p_x, fold.p_y, fold.p_z), offset_p),
            (along_a, (fold.q_x, fold.q_y, fold.q_z), offset_q),
            (along_a, (fold.border_x, fold.border_y, fold.border_z), border),
            (along_a, (fold.shift_x, fold.shift_y, fold.shift_z), shift),
        )
    ]  # fmt: skip
    bounds = [
        bound_tester(clk, step_bounds, back_1, way=way, low=low, high=high, between=inside)
        for way, low, high, inside in (
            (folded_p_1, walk.low_p, walk.high_p, inside_p), (folded_q_1, walk.low_q, walk.high_q, inside_q),
        )
    ]  # fmt: skip
    # While a row is loaded, numerator may overflow, and is don't care.
    size = magnitude(distance_1, numerator)

    @always_comb
    def place_mirror():
        on_x.next = fold.axis == 0
        on_y.next = fold.axis == 1
        on_z.next = fold.axis == 2

    @always_comb
    def compare_directions():
        flip_p.next = reversed_a != reversed_p
        flip_q.next = reversed_a != reversed_q

    chosen = plane_fold.joined(
        reversed_a=reversed_a, flip_p=flip_p, flip_q=flip_q, mirror_on_p=on_p, mirror_on_q=on_q,
        mirror_back=fold.mirror_back, met=met, offset_p=offset_p, offset_q=offset_q, border=border, shift=shift,
        distance=fold.distance,
    )  # fmt: skip

    if staged:

        @always(clk.posedge)
        def hold_chosen():
            plane_fold.word.next = chosen

    else:

        @always_comb
        def pass_chosen():
            plane_fold.word.next = chosen

    # On the same axis, the plane must lie on the side that the folded ray runs to.
    @always_comb
    def compare_planes():
        if back != plane_fold.reversed_a:
            beyond_plane.next = facet.distance < plane_fold.distance
        else:
            beyond_plane.next = facet.distance > plane_fold.distance

    # ~way is one less than -way; the fold's offset is one more to compensate.
    @always_comb
    def flip_ways():
        flipped_way_p.next = walk.way_p
        flipped_way_q.next = way_q
        if plane_fold.flip_p:
            flipped_way_p.next = ~walk.way_p
        if plane_fold.flip_q:
            flipped_way_q.next = ~way_q

    @always_comb
    def fold_ways():
        folded_p.next = plane_fold.offset_p + flipped_way_p
        folded_q.next = plane_fold.offset_q + flipped_way_q
        distance.next = facet.distance - plane_fold.shift

    @always(clk.posedge)
    def stage_1():
        if step_way:
            back_1.next = back
            folded_p_1.next = folded_p
            folded_q_1.next = folded_q
            distance_1.next = distance
            border_1.next = plane_fold.border
            beyond_plane_1.next = beyond_plane
            clip_p_1.next = plane_fold.mirror_on_p
            clip_q_1.next = plane_fold.mirror_on_q
            rising_1.next = plane_fold.mirror_back == back
            met_1.next = plane_fold.met

    if staged:

        @always_comb
        def choose_clipped():
            folded_clip.next = folded_p
            if plane_fold.mirror_on_q:
                folded_clip.next = folded_q

        @always(clk.posedge)
        def hold_clipped():
            if step_way:
                clipped.next = folded_clip

        @always(clk.posedge)
        def hold_slope():
            if step_bounds:
                e.next = size_a

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

    @always(clk.posedge)
    def stage_2():
        if step_bounds:
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
    def conclude():
        valid.next = facet.usable and beyond and inside_p and inside_q and (e != 0)

    result = hit.joined(
        valid=valid, at_mirror=at_mirror, numerator=numerator_2, denominator=e, axis=facet.axis, cell=facet.cell,
        index=index,
    )  # fmt: skip

    @always(clk.posedge)
    def stage_3():
        if step_slope:
            hit.word.next = result

    return instances()
