# SPDX-License-Identifier: MIT
"""The folding of a straight ray back into the room at one more mirror."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import AXIS_BITS


@block
def ray_fold(clk, before, last, slope, fold):
    """Fold a straight ray back into the room at one more mirror, one ray per clock, `FOLD_LATENCY` cycles later.

    The ray stays straight, and each mirror reflects the room instead (Heckbert and Hanrahan 1984 mirror the eye in the
    same way): a point X on the straight ray from the eye E is the point x in the room with x - E = +-(X - E) + T,
    component by component. A mirror at the distance n changes that to 2 n - (x - E) on its axis. A plane at the
    distance n on axis a is then met where X[a] - E[a] = +-(n - T[a]), and there the ray's component p, times D[a], is
    +-n D[p] + C, with C = T[p] D[a] -+ T[a] D[p]. C is the same for all rectangles on the axis, so no rectangle needs a
    multiplier.

    The block takes its widths from its ports.

    Args:
        clk: the clock.
        before: `RoomImage` of the fold at the previous mirror, all 0 if there was none.
        last: `Reflector`; the mirror, read in the same cycle as before.
        slope: `Vector`; D, read a cycle after before and last.
        fold: `Fold`; output, `FOLD_LATENCY` cycles after before and last.
    """
    part_bits, product_bits = len(fold.p_x), len(fold.border_x)
    distance_bits, shift_bits = len(last.distance), len(fold.shift_x)

    doubled, shift, mirrored = (signed(shift_bits) for _ in range(3))
    difference = signed(shift_bits + 1)

    shift_x, shift_y, shift_z = (signed(shift_bits) for _ in range(3))
    back_x, back_y, back_z, x_back, y_back, z_back, mirror_back = (bit() for _ in range(7))
    folds_x, folds_y, folds_z = bit(), bit(), bit()
    met_x, met_y, met_z = (bit() for _ in range(3))
    axis_1 = unsigned(AXIS_BITS)
    distance_1 = signed(distance_bits)

    x_by_y, x_by_z, y_by_x, y_by_z, z_by_x, z_by_y = (signed(part_bits) for _ in range(6))
    border_x, border_y, border_z = (signed(product_bits) for _ in range(3))
    shift_x_2, shift_y_2, shift_z_2 = (signed(shift_bits) for _ in range(3))
    back_x_2, back_y_2, back_z_2, mirror_back_2 = (bit() for _ in range(4))
    met_x_2, met_y_2, met_z_2 = (bit() for _ in range(3))
    axis_2 = unsigned(AXIS_BITS)
    distance_2 = signed(distance_bits)

    xy, yx, xz, zx, yz, zy = (signed(part_bits) for _ in range(6))
    not_y_by_x, not_z_by_x, not_z_by_y = (signed(part_bits) for _ in range(3))
    p_x, p_y, p_z, q_x, q_y, q_z = (signed(part_bits) for _ in range(6))
    sum_xy_1, sum_xz_1, sum_yz_1 = (signed(part_bits) for _ in range(3))

    met_x_3, met_y_3, met_z_3, back_x_3, back_y_3, back_z_3, mirror_back_3 = (bit() for _ in range(7))
    shift_x_3, shift_y_3, shift_z_3 = (signed(shift_bits) for _ in range(3))
    p_x_3, p_y_3, p_z_3, q_x_3, q_y_3, q_z_3 = (signed(part_bits) for _ in range(6))
    border_x_3, border_y_3, border_z_3 = (signed(product_bits) for _ in range(3))
    axis_3 = unsigned(AXIS_BITS)
    distance_3 = signed(distance_bits)

    # Along the mirror's axis T becomes 2 n - T.
    shift_there = by_axis(last.axis, before.shift_x, before.shift_y, before.shift_z, shift, width=shift_bits)

    @always_comb
    def double():
        doubled.next = last.distance << 1

    @always_comb
    def mirror():
        difference.next = doubled - shift

    # Mirrors of one scene are within the world; while a scene is loaded this may overflow, and is don't care.
    @always_comb
    def fit():
        mirrored.next = difference[shift_bits:].signed()

    # T, the axes along which mirrors have reversed the ray, and the axes of all mirrors at the point that it leaves.
    @always(clk.posedge)
    def stage_1():
        met_x.next = last.at_mirror and before.met_x
        met_y.next = last.at_mirror and before.met_y
        met_z.next = last.at_mirror and before.met_z
        back_x.next = before.back_x
        back_y.next = before.back_y
        back_z.next = before.back_z
        shift_x.next = before.shift_x
        shift_y.next = before.shift_y
        shift_z.next = before.shift_z
        if last.axis == 0:
            met_x.next = True
            back_x.next = not before.back_x
            shift_x.next = mirrored
        elif last.axis == 1:
            met_y.next = True
            back_y.next = not before.back_y
            shift_y.next = mirrored
        else:
            met_z.next = True
            back_z.next = not before.back_z
            shift_z.next = mirrored
        axis_1.next = last.axis
        distance_1.next = last.distance

    @always(clk.posedge)
    def stage_2():
        x_by_y.next = shift_x * slope.y
        x_by_z.next = shift_x * slope.z
        y_by_x.next = shift_y * slope.x
        y_by_z.next = shift_y * slope.z
        z_by_x.next = shift_z * slope.x
        z_by_y.next = shift_z * slope.y
        border_x.next = distance_1 * slope.x
        border_y.next = distance_1 * slope.y
        border_z.next = distance_1 * slope.z
        shift_x_2.next = shift_x
        shift_y_2.next = shift_y
        shift_z_2.next = shift_z
        back_x_2.next = back_x
        back_y_2.next = back_y
        back_z_2.next = back_z
        met_x_2.next = met_x
        met_y_2.next = met_y
        met_z_2.next = met_z
        axis_2.next = axis_1
        distance_2.next = distance_1

    @always_comb
    def look_ahead():
        x_back.next = slope.x < 0
        y_back.next = slope.y < 0
        z_back.next = slope.z < 0

    # folds_x ...: components of the folded ray that are negative; mirror_back: the one along the mirror's axis.
    @always_comb
    def fold_back():
        folds_x.next = back_x != x_back
        folds_y.next = back_y != y_back
        folds_z.next = back_z != z_back

    back_there = by_axis(axis_1, folds_x, folds_y, folds_z, mirror_back, width=1)

    @always(clk.posedge)
    def leave_mirror():
        mirror_back_2.next = mirror_back

    # C if the ray is reversed along both axes or along neither.
    @always_comb
    def combine():
        xy.next = y_by_x - x_by_y
        yx.next = x_by_y - y_by_x
        xz.next = z_by_x - x_by_z
        zx.next = x_by_z - z_by_x
        yz.next = z_by_y - y_by_z
        zy.next = y_by_z - z_by_y
        not_y_by_x.next = ~y_by_x
        not_z_by_x.next = ~z_by_x
        not_z_by_y.next = ~z_by_y

    # C + 1 if it is reversed along one of them, as C is then added to a complement: a + b + 1 = a - ~b.
    @always_comb
    def make_good():
        sum_xy_1.next = x_by_y - not_y_by_x
        sum_xz_1.next = x_by_z - not_z_by_x
        sum_yz_1.next = y_by_z - not_z_by_y

    @always_comb
    def choose_offsets():
        p_x.next = xy
        p_y.next = yx
        q_x.next = xz
        q_z.next = zx
        q_y.next = yz
        p_z.next = zy
        if back_x_2 != back_y_2:
            p_x.next = sum_xy_1
            p_y.next = sum_xy_1
        if back_x_2 != back_z_2:
            q_x.next = sum_xz_1
            q_z.next = sum_xz_1
        if back_y_2 != back_z_2:
            q_y.next = sum_yz_1
            p_z.next = sum_yz_1

    # One register per field, so that a simulator need not split the word for every rectangle.
    @always(clk.posedge)
    def stage_3():
        mirror_back_3.next = mirror_back_2
        met_x_3.next = met_x_2
        met_y_3.next = met_y_2
        met_z_3.next = met_z_2
        back_x_3.next = back_x_2
        back_y_3.next = back_y_2
        back_z_3.next = back_z_2
        shift_x_3.next = shift_x_2
        shift_y_3.next = shift_y_2
        shift_z_3.next = shift_z_2
        p_x_3.next = p_x
        p_y_3.next = p_y
        p_z_3.next = p_z
        q_x_3.next = q_x
        q_y_3.next = q_y
        q_z_3.next = q_z
        border_x_3.next = border_x
        border_y_3.next = border_y
        border_z_3.next = border_z
        axis_3.next = axis_2
        distance_3.next = distance_2

    result = fold.joined(
        met_x=met_x_3, met_y=met_y_3, met_z=met_z_3, back_x=back_x_3, back_y=back_y_3, back_z=back_z_3,
        shift_x=shift_x_3, shift_y=shift_y_3, shift_z=shift_z_3, mirror_back=mirror_back_3,
        p_x=p_x_3, p_y=p_y_3, p_z=p_z_3, q_x=q_x_3, q_y=q_y_3, q_z=q_z_3,
        border_x=border_x_3, border_y=border_y_3, border_z=border_z_3, axis=axis_3, distance=distance_3,
    )  # fmt: skip

    @always_comb
    def join():
        fold.word.next = result

    return instances()
