# SPDX-License-Identifier: MIT
"""The one control that operates all units of the exact engine in step."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.engines.exact import PATTERN_LATENCY, WRITE_AT
from raycaster.rtl.common.records import surface_of
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import unsigned
from raycaster.rtl.engine.ray_sequencer import ray_sequencer


@block
def exact_control(clk, reset_ray_caster, enable, picture, rects, steps, fate, offered, done, config: Configuration):
    """A ray_sequencer that takes a rectangle a clock, with done and the other ports as it has them.

    write_z_buf follows find_intersection by three cycles, the latency of rect_tester; offered: the `Surface` of the
    rectangle that find_intersection then started on. With config.patterns a pass goes on until the cells of the
    nearest hit are known: load_divider in the cycle after a write_z_buf, and store_quotient three after the last one.
    """
    in_flight = unsigned(WRITE_AT + 1 + (PATTERN_LATENCY if config.patterns else 0))
    first, second = surface_of(config), surface_of(config)

    sequencer = ray_sequencer(
        clk=clk, reset_ray_caster=reset_ray_caster, enable=enable, picture=picture, rects=rects, steps=steps,
        in_flight=in_flight, fate=fate, early_out=tied(0, 1), done=done, slot_cycles=config.slot_cycles, config=config,
    )  # fmt: skip

    @always_comb
    def operate_stages():
        steps.write_z_buf.next = in_flight[WRITE_AT]

    if config.patterns:
        load_at, store_at = WRITE_AT + 1, WRITE_AT + 4

        @always_comb
        def operate_divider():
            steps.load_divider.next = in_flight[load_at]
            steps.store_quotient.next = in_flight[store_at] and (in_flight[store_at:] == 0)

    # The surface moves with its tests: it is the same for all units, so they need no copies.
    @always(clk.posedge)
    def carry_surface():
        first.word.next = rects.rect.surface
        second.word.next = first.word
        offered.word.next = second.word

    return instances()
