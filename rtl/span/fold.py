# SPDX-License-Identifier: MIT
"""The chain behind a mirror."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, bit, signed
from raycaster.hdl.verbs import assign, plus
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import eye_bits


@block
def fold(chain, winner, column, stop, corner, weight, folded, config: Configuration):
    """Reflect the rays of a chain in the winner, in some of its columns. Combinational.

    The eye is mirrored in the winner's plane k, E'[a] = 2 k - E[a] = E[a] + 2 n, and the slope's component on the
    plane's axis a changes its sign (Heckbert and Hanrahan 1984). The winner is the last mirror of the new chain. If the
    rays meet it in the last mirror's point, the axes met there are kept: a ray reflects off all planes of a corner.

    Args:
        chain: `Chain`.
        winner: `Entry` of the chain.
        column: unsigned, `column_bits` bits; the first of the columns.
        stop: unsigned, `column_bits` bits; the column after the last.
        corner: flag; the rays meet the winner in the last mirror's point.
        weight: unsigned, `weight_bits` bits; of the colour that is seen in the mirror.
        folded: output `Chain`.
        config: the design, with reflections.
    """
    far_bits = eye_bits(config)

    eye_a, eye_x, eye_y, eye_z = (signed(far_bits) for _ in range(4))
    mirrored = signed(far_bits)
    distance, way, twice = signed(far_bits), signed(far_bits), signed(far_bits + 1)
    whole, mirror = plus(eye_a, twice, Signed(far_bits + 2))
    back_a, towards = bit(), bit()
    back_x, back_y, back_z, met_x, met_y, met_z = (bit() for _ in range(6))
    choices = (
        by_axis(winner.axis, chain.eye_x, chain.eye_y, chain.eye_z, eye_a, width=far_bits),
        by_axis(winner.axis, chain.back_x, chain.back_y, chain.back_z, back_a, width=1),
    )

    @always_comb
    def extend():
        distance.next = winner.distance
        towards.next = winner.back != back_a

    turn = assign(way, lambda: -distance if towards else distance)
    double = assign(twice, lambda: way << 1)
    keep = assign(mirrored, lambda: whole[far_bits:].signed())

    @always_comb
    def place():
        eye_x.next, eye_y.next, eye_z.next = chain.eye_x, chain.eye_y, chain.eye_z
        back_x.next, back_y.next, back_z.next = chain.back_x, chain.back_y, chain.back_z
        met_x.next = corner and chain.met_x
        met_y.next = corner and chain.met_y
        met_z.next = corner and chain.met_z
        if winner.axis == 0:
            eye_x.next = mirrored
            back_x.next = not chain.back_x
            met_x.next = True
        elif winner.axis == 1:
            eye_y.next = mirrored
            back_y.next = not chain.back_y
            met_y.next = True
        else:
            eye_z.next = mirrored
            back_z.next = not chain.back_z
            met_z.next = True

    reflected = folded.joined(
        start=column, stop=stop, eye_x=eye_x, eye_y=eye_y, eye_z=eye_z, back_x=back_x, back_y=back_y, back_z=back_z,
        mirrored=True, axis=winner.axis, back=winner.back, distance=winner.distance, met_x=met_x, met_y=met_y,
        met_z=met_z, weight=weight,
    )  # fmt: skip

    join = assign(folded.word, lambda: reflected)

    return instances()
