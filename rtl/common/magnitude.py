# SPDX-License-Identifier: MIT
"""The magnitude of a signed number."""

from myhdl import block, instances

from raycaster.hdl.signals import signed
from raycaster.hdl.verbs import assign


@block
def magnitude(value, result):
    """Compute the magnitude of a signed number. Combinational.

    Args:
        value: signed, not its most negative number; one bit wider than result, or more if its magnitude fits result.
        result: unsigned output; |value|.
    """
    bits = len(result)
    opposite = signed(len(value))

    negate = assign(opposite, lambda: -value)
    choose = assign(result, lambda: opposite[bits:] if value < 0 else value[bits:])

    return instances()
