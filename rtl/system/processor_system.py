# SPDX-License-Identifier: MIT
"""The ray tracer and a processor that drives it: the top of a system that runs a program, such as a game."""

from myhdl import ResetSignal, Signal, block

from raycaster.configuration import Configuration
from raycaster.memory_map import BUTTON_NAMES
from raycaster.registers import address_bits
from raycaster.rtl.common.widths import LANES, WORD_BITS, bit, unsigned
from raycaster.rtl.system.processor_host import processor_host
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.reset_release import reset_release


class ProcessorPorts:
    """Signals for every port of processor_system; `all()` are its arguments, by name."""

    def __init__(self, config: Configuration):
        self.clk, self.ready = bit(), bit()
        self.buttons = unsigned(len(BUTTON_NAMES))
        self.uart_tx = bit()
        self.vga_r, self.vga_g, self.vga_b = (unsigned(config.colour_bits) for _ in range(3))
        self.vga_hs, self.vga_vs, self.vga_blank_n, self.vga_sync_n, self.vga_clk = (bit() for _ in range(5))

    def all(self) -> dict[str, Signal]:
        """The ports by name, as keyword arguments."""
        return vars(self)


@block
def processor_system(
    clk,
    ready,
    buttons,
    uart_tx,
    vga_r,
    vga_g,
    vga_b,
    vga_hs,
    vga_vs,
    vga_blank_n,
    vga_sync_n,
    vga_clk,
    config: Configuration,
    program: str,
):
    """A program that finds the ray tracer, five buttons and a serial port by `memory_map`.

    clk: screen.clock_hz; ready: low for at least three cycles resets everything (a PLL's lock, a button), may change at
    any time; buttons: as `memory_map.BUTTON_NAMES`, active high, may change at any time; uart_tx: 8 data bits, no
    parity, a stop bit, at `memory_map.BAUD_RATE`; vga_*: as ray_caster_module has them; program: as `word_memory`.
    """
    reset = ResetSignal(0, active=1, isasync=False)
    address = unsigned(address_bits(config.table))
    read, write, readdatavalid, waitrequest, irq = (bit() for _ in range(5))
    writedata, readdata = unsigned(WORD_BITS), unsigned(WORD_BITS)
    byteenable = unsigned(LANES)

    reset_source = reset_release(clk, ready, reset)
    host = processor_host(
        clk, reset, buttons, irq, uart_tx, address, read, write, writedata, byteenable, readdata, readdatavalid,
        waitrequest, config, program,
    )  # fmt: skip
    module = ray_caster_module(
        clk, reset, address, read, write, writedata, byteenable, readdata, readdatavalid, waitrequest, irq, vga_r,
        vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk, config,
    )  # fmt: skip

    return reset_source, host, module
