# SPDX-License-Identifier: MIT
"""The ray tracer and a processor that drives it: the top of a system that runs a program, such as a game."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, reset_signal
from raycaster.registers import address_bits
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.system.processor_host import processor_host
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.reset_release import reset_release


@block
def ray_caster_system(clk, ready, buttons, uart_tx, vga, config: Configuration, program: str):
    """Run a program that accesses the ray tracer, five buttons and a serial port at the addresses of memory_map.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        ready: flag, such as a PLL's lock or a button; low for at least three cycles resets everything. It may change at
            any time.
        buttons: unsigned, 5 bits, active high; from bit 0 on: left, right, up, down, fire, as in
            memory_map.BUTTON_NAMES. They may change at any time.
        uart_tx: output of the serial port: 8 data bits, no parity, a stop bit, at `memory_map.BAUD_RATE`.
        vga: `Vga`; output, as in ray_caster_module.
        program: the file with the program, as in word_memory.
    """
    reset = reset_signal()
    bus = AvalonPort(address_bits(*config.map))
    irq = bit()

    reset_source = reset_release(clk, ready, reset)
    host = processor_host(clk, reset, buttons, irq, uart_tx=uart_tx, avm_m0=bus, config=config, program=program)
    module = ray_caster_module(clk, reset, avs_s0=bus, irq=irq, vga=vga, config=config)

    return instances()
