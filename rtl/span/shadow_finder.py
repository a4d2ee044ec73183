# SPDX-License-Identifier: MIT
"""The rectangles between the light and a surface."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    column_bits,
    eye_bits,
    eye_distance_bits,
    line_factor_bits,
    operand_bits,
    operand_growth_bits,
    weight_bits,
)
from raycaster.rtl.span.records import NUMBER_BITS

ShadowState = enum("IDLE", "AIM", "SET_UP")


@block
def shadow_finder(
    clk, reset, start, chain, winner, camera, column, stop, asks, answer, set_up_done, aim, fan, begin_set_up, done,
    config: Configuration,
):  # fmt: skip
    """Aim the light at a surface, and have all rectangles found that are in the way.

    A ray from the light L to a point P = E + N D' / e of the surface has, times e, the slope e (P - L) = N D' - (L - E)
    e. That is linear in the column, so these rays are a fan like that of a chain, whose eye is the light.

    Args:
        reset: flag; synchronous reset to idle.
        start: strobe; begins while idle.
        chain: `Chain` whose rays see the surface. Constant from start to done, like all inputs up to stop.
        winner: `Entry` of the surface.
        camera: `Camera`; the light's position is read.
        column: unsigned, `column_bits` bits; the surface's first column.
        stop: unsigned, `column_bits` bits; the column after its last.
        asks: output `Asks`; only ask and query are driven.
        answer: `Answer`.
        set_up_done: strobe; all entries of the fan are in their table.
        aim: output `Aim`; valid from begin_set_up to done.
        fan: output `Chain` of the rays from the light; valid from the cycle before begin_set_up to done.
        begin_set_up: output strobe.
        done: output strobe.
        config: the design, with a light.
    """
    width, factor_bits, far_bits = column_bits(config), line_factor_bits(config), eye_bits(config)
    bits, growth_bits = operand_bits(config), operand_growth_bits(config)

    state = Signal(ShadowState.IDLE)
    entering = bit()
    axis, axis_1 = unsigned(NUMBER_BITS), unsigned(AXIS_BITS)
    light_x, light_y, light_z, eye_q, light_q = (signed(far_bits) for _ in range(5))
    back_q, back_1 = bit(), bit()
    offset, to_plane, factor_1, factor_2 = (signed(factor_bits) for _ in range(4))
    last = unsigned(width)
    left, right, growth = signed(bits), signed(bits), signed(growth_bits)
    none, no_axis, no_distance = tied(0, 1), tied(0, AXIS_BITS), tied(0, eye_distance_bits(config))
    no_weight = tied(0, weight_bits(config))

    @always_comb
    def extend_light():
        light_x.next, light_y.next, light_z.next = camera.light_x, camera.light_y, camera.light_z

    see_axis = assign(axis_1, lambda: winner.axis if axis == 3 else axis[AXIS_BITS:])

    choices = (
        by_axis(axis_1, chain.eye_x, chain.eye_y, chain.eye_z, eye_q, width=far_bits),
        by_axis(axis_1, light_x, light_y, light_z, light_q, width=far_bits),
        by_axis(axis_1, chain.back_x, chain.back_y, chain.back_z, back_q, width=1),
    )

    @always_comb
    def measure():
        offset.next = light_q - eye_q
        to_plane.next = winner.distance
        last.next = (stop - 1) % (1 << width)

    # After the three components of the slope, e.
    choose_back_1 = assign(back_1, lambda: winner.back if axis == 3 else back_q)
    choose_factor_1 = assign(factor_1, lambda: 1 if axis == 3 else to_plane)
    choose_factor_2 = assign(factor_2, lambda: 0 if axis == 3 else offset)

    asked = asks.query.joined(
        from_light=none, left=column, right=last, strict=none, axis_1=axis_1, back_1=back_1, factor_1=factor_1,
        axis_2=winner.axis, back_2=winner.back, factor_2=factor_2, half_line=none, last=none, number=axis,
    )  # fmt: skip

    @always_comb
    def request():
        asks.ask.next = (state == ShadowState.AIM) and (axis != 4)
        asks.query.word.next = asked

    @always_comb
    def narrow():
        left.next = answer.left[bits:].signed()
        right.next = answer.right[bits:].signed()
        growth.next = answer.growth[growth_bits:].signed()

    @always(clk.posedge)
    def keep():
        if (state == ShadowState.AIM) and answer.valid:
            if answer.number == 0:
                aim.left_x.next, aim.right_x.next, aim.growth_x.next = left, right, growth
            elif answer.number == 1:
                aim.left_y.next, aim.right_y.next, aim.growth_y.next = left, right, growth
            elif answer.number == 2:
                aim.left_z.next, aim.right_z.next, aim.growth_z.next = left, right, growth
            else:
                aim.left_e.next, aim.right_e.next, aim.growth_e.next = left, right, growth

    rays = fan.joined(
        start=column, stop=stop, eye_x=light_x, eye_y=light_y, eye_z=light_z, back_x=none, back_y=none, back_z=none,
        mirrored=none, axis=no_axis, back=none, distance=no_distance, met_x=none, met_y=none, met_z=none,
        weight=no_weight,
    )  # fmt: skip

    @always_comb
    def show():
        fan.word.next, begin_set_up.next = rays, entering
        done.next = (state == ShadowState.SET_UP) and set_up_done

    @always(clk.posedge)
    def advance():
        entering.next = False
        if reset:
            state.next = ShadowState.IDLE
        elif start:
            state.next = ShadowState.AIM
            axis.next = 0
        elif state == ShadowState.AIM:
            if axis != 4:
                axis.next = axis + 1
            if answer.valid and (answer.number == 3):
                state.next = ShadowState.SET_UP
                entering.next = True
        elif done:
            state.next = ShadowState.IDLE

    return instances()
