# SPDX-License-Identifier: MIT
"""The ray tracer and what drives its bus, for boards without a processor: the top of what a board's pins connect to."""

from myhdl import ResetSignal, Signal, block

from raycaster.configuration import Configuration
from raycaster.registers import address_bits
from raycaster.rtl.common.ties import tied, unconnected
from raycaster.rtl.common.widths import WORD_BITS, bit, unsigned
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.reset_release import reset_release
from raycaster.rtl.system.scene_player import BUTTONS, scene_player
from raycaster.scene import Scene


class SystemPorts:
    """Signals for every port of ray_caster_system; `all()` are its arguments, by name."""

    def __init__(self, config: Configuration):
        self.clk, self.ready = bit(), bit()
        self.buttons = unsigned(len(BUTTONS))
        self.vga_r, self.vga_g, self.vga_b = (unsigned(config.colour_bits) for _ in range(3))
        self.vga_hs, self.vga_vs, self.vga_blank_n, self.vga_sync_n, self.vga_clk = (bit() for _ in range(5))

    def all(self) -> dict[str, Signal]:
        """The ports by name, as keyword arguments."""
        return vars(self)


@block
def ray_caster_system(
    clk,
    ready,
    buttons,
    vga_r,
    vga_g,
    vga_b,
    vga_hs,
    vga_vs,
    vga_blank_n,
    vga_sync_n,
    vga_clk,
    config: Configuration,
    scene: Scene,
):
    """One scene on a monitor, its camera moved by buttons.

    clk: 50 MHz; ready: low for at least three cycles resets everything (a PLL's lock, a button), may change at any
    time; buttons: as `scene_player.BUTTONS`, active high, may change at any time; vga_*: as ray_caster_module has them.
    """
    reset = ResetSignal(0, active=1, isasync=False)
    address = unsigned(address_bits(config.table))
    write, waitrequest, irq = bit(), bit(), bit()
    writedata, byteenable = unsigned(WORD_BITS), unsigned(4)
    never = tied(0, 1)
    readdata, readdatavalid = unconnected(WORD_BITS), unconnected(1)

    reset_source = reset_release(clk, ready, reset)
    player = scene_player(
        clk, reset, buttons, irq, address, write, writedata, byteenable, waitrequest, config, scene
    )  # fmt: skip
    module = ray_caster_module(
        clk, reset, address, never, write, writedata, byteenable, readdata, readdatavalid, waitrequest, irq, vga_r,
        vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk, config,
    )  # fmt: skip

    return reset_source, player, module
