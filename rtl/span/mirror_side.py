# SPDX-License-Identifier: MIT
"""The side of a mirror's plane on which a rectangle lies."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.by_axis import along_u, by_axis
from raycaster.rtl.common.widths import AXIS_BITS, eye_bits


@block
def mirror_side(clk, chain, rect, hidden, crosses, config: Configuration):
    """Compare a rectangle with the plane of a chain's last mirror, which needs no products.

    The rays leave the mirrored eye towards the plane, so a point is beyond the mirror if it is strictly on the other
    side of the plane than that eye. The plane is E[a] + N or E[a] - N, with the mirror's axis a.

    Args:
        chain: `Chain`; constant from the cycle before the rectangle's on.
        rect: `Rect`.
        hidden: output flag; no point of the rectangle is met, as it is before the plane, or on it and parallel to it.
            Combinational from rect, like crosses.
        crosses: output flag; the rectangle reaches the plane, so not all of it is beyond the mirror.
        config: the design, with reflections.
    """
    far_bits = eye_bits(config)

    eye_a, distance, whole = signed(far_bits), signed(far_bits), signed(far_bits + 1)
    back_a, upwards, towards_high = bit(), bit(), bit()
    plane = unsigned(COORDINATE_BITS)
    axis_u = unsigned(AXIS_BITS)
    low, high = unsigned(COORDINATE_BITS), unsigned(COORDINATE_BITS)
    parallel, above, below, beyond, short = (bit() for _ in range(5))
    axes = [tied(axis, AXIS_BITS) for axis in range(3)]
    choices = (
        by_axis(chain.axis, chain.eye_x, chain.eye_y, chain.eye_z, eye_a, width=far_bits),
        by_axis(chain.axis, chain.back_x, chain.back_y, chain.back_z, back_a, width=1),
        by_axis(rect.axis, *along_u(*axes), axis_u, width=AXIS_BITS),
    )

    # The mirror has changed the sign of the slope's component on its axis.
    @always_comb
    def see_way():
        upwards.next = back_a == chain.back
        distance.next = chain.distance

    find_plane = assign(whole, lambda: eye_a + distance if upwards else eye_a - distance)

    @always(clk.posedge)
    def keep():
        plane.next = whole[COORDINATE_BITS:]
        towards_high.next = upwards

    @always_comb
    def choose_extent():
        parallel.next = rect.axis == chain.axis
        low.next, high.next = rect.v_low, rect.v_high
        if rect.axis == chain.axis:
            low.next = high.next = rect.position
        elif axis_u == chain.axis:
            low.next, high.next = rect.u_low, rect.u_high

    @always_comb
    def compare():
        above.next = low > plane
        below.next = high < plane

    choose_beyond = assign(beyond, lambda: above if towards_high else below)
    choose_short = assign(short, lambda: below if towards_high else above)

    @always_comb
    def judge():
        hidden.next = chain.mirrored and (short or (parallel and not beyond))
        crosses.next = chain.mirrored and not beyond

    return instances()
