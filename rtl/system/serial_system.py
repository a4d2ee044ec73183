# SPDX-License-Identifier: MIT
"""The ray tracer with a serial port instead of a processor: the top of a board that shows what a computer sends."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import reset_signal, unconnected
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.reset_release import reset_release


@block
def serial_system(clk, ready, uart, vga, config: Configuration):
    """Show the scenes that are written over a serial line, and black until the first one.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        ready: flag, such as a PLL's lock or a button; low for at least three cycles resets everything. It may change at
            any time.
        uart: `UartPort`, of this block.
        vga: `Vga`; output, as in ray_caster_module.
        config: the design, whose bus is uart.
    """
    reset = reset_signal()

    reset_source = reset_release(clk, ready, reset)
    module = ray_caster_module(clk, reset, avs_s0=None, irq=unconnected(1), vga=vga, config=config, uart=uart)

    return instances()
