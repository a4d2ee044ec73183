# SPDX-License-Identifier: MIT
"""A component of the hit point, times the slope towards its plane: a whole number."""

from myhdl import block, concat, instances

from raycaster.hdl.signals import Signed, signed, unsigned
from raycaster.hdl.verbs import assign, times


@block
def hit_component(eye, back, slope, distance, e, component):
    """Compute a component of N = E e + D n, which is e times the hit point P = E + D n / e. Combinational.

    Args:
        eye: signed; the component of E, relative to the origin or to any other reference point of N.
        back: flag; the component of D is negative.
        slope: unsigned; the magnitude of the component of D.
        distance: unsigned; n, the distance from the eye to the plane that is hit.
        e: unsigned, as wide as slope; the magnitude of the slope on that plane's axis.
        component: unsigned output; the lowest bits of N in two's complement, no more bits than E e has.
    """
    slope_bits, bits = len(e), len(component)

    divisor = signed(slope_bits + 1)
    position, multiply = times(eye, divisor, Signed(len(eye) + slope_bits + 1))
    way_bits = max(len(distance) + slope_bits, bits)
    way, multiply_way = times(distance, slope, way_bits)
    flipped_way = unsigned(way_bits)
    from_eye, along, total = (unsigned(bits + 1) for _ in range(3))

    extend = assign(divisor, lambda: e)
    turn_way = assign(flipped_way, lambda: ~way if back else way)

    # An extra lowest bit carries in the 1 that completes the two's complement.
    add_carry = assign((from_eye, along), lambda: (concat(position[bits:], True), concat(flipped_way[bits:], back)))
    add = assign(total, lambda: (from_eye + along) % (1 << (bits + 1)))
    leave_carry = assign(component, lambda: total[bits + 1 : 1])

    return instances()
