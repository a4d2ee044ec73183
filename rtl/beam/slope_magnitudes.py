# SPDX-License-Identifier: MIT
"""A slope without its signs."""

from myhdl import always_comb, block, instances

from raycaster.rtl.common.widths import signed


@block
def slope_magnitudes(column_slope, row_slope, slope):
    """slope: |D[y]| and |D[z]|, a bit narrower than the slopes, which are never the least number. Combinational."""
    slope_bits = len(slope.dy)
    opposite_dy, opposite_dz = signed(slope_bits + 1), signed(slope_bits + 1)

    @always_comb
    def negate():
        opposite_dy.next = -column_slope
        opposite_dz.next = -row_slope

    @always_comb
    def take_magnitudes():
        slope.dy.next = column_slope[slope_bits:]
        slope.dz.next = row_slope[slope_bits:]
        if column_slope < 0:
            slope.dy.next = opposite_dy[slope_bits:]
        if row_slope < 0:
            slope.dz.next = opposite_dz[slope_bits:]

    return instances()
