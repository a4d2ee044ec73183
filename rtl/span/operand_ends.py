# SPDX-License-Identifier: MIT
"""A component of the slope at two columns."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import AXIS_BITS, column_bits, signed_slope_bits, step_bits


@block
def operand_ends(
    clk, axis, from_light, left, right, slope, step, aim, at_left, at_right, growth, config: Configuration
):
    """Compute D[axis](c) = slope[axis] + c step[axis] at two columns, two cycles later.

    Args:
        axis: unsigned, 2 bits; 0, 1, 2 for x, y, z.
        from_light: flag, read with `config.light`; all three come from aim instead, on axis 3 those of e.
        left: unsigned, `column_bits` bits.
        right: unsigned, `column_bits` bits.
        slope: `Vector` of `signed_slope_bits` bits; the slope of column 0, constant while anything is computed.
        step: `Vector` of `step_bits` bits; the slope's change from column to column, constant like slope. Only read
            with `config.turn`; otherwise it is (0, 1, 0).
        aim: `Aim` of the span whose ends the columns are; read with `config.light`, constant like slope.
        at_left: signed output, `operand_bits` bits; the component at the column left.
        at_right: signed output, `operand_bits` bits; the component at the column right.
        growth: signed output, `operand_growth_bits` bits; its change from column to column.
    """
    slope_bits, growth_bits, columns = signed_slope_bits(config), step_bits(config), column_bits(config)
    # A column beyond the last, where all is don't care, may exceed the steepest slope.
    bits = max(slope_bits, columns + growth_bits) + 1

    start, start_1 = signed(slope_bits), signed(slope_bits)
    move, step_1 = signed(growth_bits), signed(growth_bits)
    column_left, column_right = signed(columns + 1), signed(columns + 1)
    to_left, to_right, to_left_1, to_right_1 = (signed(columns + growth_bits + 1) for _ in range(4))
    whole_left, whole_right = signed(bits + 1), signed(bits + 1)

    # A number at the end of a name is the stage whose registers hold it.
    begin = by_axis(axis, slope.x, slope.y, slope.z, start, width=slope_bits)

    if config.turn:
        change = by_axis(axis, step.x, step.y, step.z, move, width=growth_bits)
    else:
        see_change = assign(move, lambda: 1 if axis == 1 else 0)

    extend = assign((column_left, column_right), lambda: (left, right))

    if config.turn:

        @always_comb
        def multiply():
            to_left.next = column_left * move
            to_right.next = column_right * move

    else:
        multiply_to_left = assign(to_left, lambda: column_left if move != 0 else 0)
        multiply_to_right = assign(to_right, lambda: column_right if move != 0 else 0)

    stage_1 = register(clk, (start_1, step_1, to_left_1, to_right_1), lambda: (start, move, to_left, to_right))

    @always_comb
    def add():
        whole_left.next = start_1 + to_left_1
        whole_right.next = start_1 + to_right_1

    if config.light:
        axis_1, light_1 = unsigned(AXIS_BITS), bit()

        follow = register(clk, (axis_1, light_1), lambda: (axis, from_light))

        @always(clk.posedge)
        def stage_2():
            if not light_1:
                at_left.next = whole_left[slope_bits:].signed()
                at_right.next = whole_right[slope_bits:].signed()
                growth.next = step_1
            elif axis_1 == 0:
                at_left.next, at_right.next, growth.next = aim.left_x, aim.right_x, aim.growth_x
            elif axis_1 == 1:
                at_left.next, at_right.next, growth.next = aim.left_y, aim.right_y, aim.growth_y
            elif axis_1 == 2:
                at_left.next, at_right.next, growth.next = aim.left_z, aim.right_z, aim.growth_z
            else:
                at_left.next, at_right.next, growth.next = aim.left_e, aim.right_e, aim.growth_e

    else:

        @always(clk.posedge)
        def stage_2():
            at_left.next = whole_left[slope_bits:].signed()
            at_right.next = whole_right[slope_bits:].signed()
            growth.next = step_1

    return instances()
