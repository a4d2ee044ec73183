# SPDX-License-Identifier: MIT
"""The ray tracer and a scene player that drives its bus, for boards without a processor: the top module of a board."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, reset_signal, tied, unconnected
from raycaster.registers import address_bits
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.reset_release import reset_release
from raycaster.rtl.system.scene_player import scene_player
from raycaster.scene import Scene


@block
def scene_system(clk, ready, buttons, vga, config: Configuration, scene: Scene):
    """Show one scene on a monitor, with a camera moved by buttons.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        ready: flag, such as a PLL's lock or a button; low for at least three cycles resets everything. It may change at
            any time.
        buttons: unsigned, 6 bits, active high; from bit 0 on: forward, back, left, right, up, down, as in
            scene_player.BUTTONS. They may change at any time.
        vga: `Vga`; output, as in ray_caster_module.
        scene: the scene.
    """
    reset = reset_signal()
    bus = AvalonPort(
        address_bits(*config.map), read=tied(0, 1), readdata=unconnected(WORD_BITS), readdatavalid=unconnected(1)
    )
    irq = bit()

    reset_source = reset_release(clk, ready, reset)
    player = scene_player(clk, reset, buttons, irq, avm_m0=bus, config=config, scene=scene)
    module = ray_caster_module(clk, reset, avs_s0=bus, irq=irq, vga=vga, config=config)

    return instances()
