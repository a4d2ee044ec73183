# SPDX-License-Identifier: MIT
"""The ray tracer as one Avalon-MM agent with a VGA output: the top of what is generated."""

from myhdl import ResetSignal, Signal, block

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.registers import address_bits
from raycaster.rtl.bus.avalon_interface import avalon_interface
from raycaster.rtl.common.legacy import PipelinedRects, Point, SceneBus
from raycaster.rtl.common.ties import tied, unconnected
from raycaster.rtl.common.widths import CYCLE_BITS, RGB_BITS, WORD_BITS, bit, unsigned
from raycaster.rtl.engine.renderers import RECTS, RENDERERS
from raycaster.rtl.scene.camera_mem import camera_mem
from raycaster.rtl.scene.rect_mem import rect_mem
from raycaster.rtl.scene.rect_rom import fixed_rects, rect_rom


class ModulePorts:
    """Signals for every port of ray_caster_module; `all()` are its arguments, by name.

    avs_s0_*: Avalon-MM agent, word addresses, readdatavalid; irq: level; vga_*: to the monitor or its converter.
    """

    def __init__(self, config: Configuration):
        self.clk = bit()
        self.reset = ResetSignal(0, active=1, isasync=False)
        self.avs_s0_address = unsigned(address_bits(config.table))
        self.avs_s0_read, self.avs_s0_write = bit(), bit()
        self.avs_s0_writedata, self.avs_s0_byteenable = unsigned(WORD_BITS), unsigned(4)
        self.avs_s0_readdata = unsigned(WORD_BITS)
        self.avs_s0_readdatavalid, self.avs_s0_waitrequest, self.irq = bit(), bit(), bit()
        self.vga_r, self.vga_g, self.vga_b = (unsigned(config.colour_bits) for _ in range(3))
        self.vga_hs, self.vga_vs, self.vga_blank_n, self.vga_sync_n, self.vga_clk = (bit() for _ in range(5))

    def all(self) -> dict[str, Signal]:
        """The ports by name, as keyword arguments."""
        return vars(self)


@block
def ray_caster_module(
    clk,
    reset,
    avs_s0_address,
    avs_s0_read,
    avs_s0_write,
    avs_s0_writedata,
    avs_s0_byteenable,
    avs_s0_readdata,
    avs_s0_readdatavalid,
    avs_s0_waitrequest,
    irq,
    vga_r,
    vga_g,
    vga_b,
    vga_hs,
    vga_vs,
    vga_blank_n,
    vga_sync_n,
    vga_clk,
    config: Configuration,
):
    """Registers, scene memories and renderer in one clock domain, screen.clock_hz; reset is synchronous, active high.

    The bus counts 32-bit words. The interrupt is a level. Video data changes at the falling edge of vga_clk, a pixel's.
    What config.fixed holds is built in: it has no memory, and writes to its registers do nothing.
    """
    fixed = config.fixed
    bus = SceneBus(len(avs_s0_address))
    rects = RECTS[config.engine](config)
    camera = Point()
    camera_word, rect_word = unsigned(WORD_BITS), unsigned(WORD_BITS)
    bad_rectangle = bit()
    run, start_screen, busy, underrun = bit(), bit(), bit(), bit()
    reflections = unsigned(2)
    background = unsigned(RGB_BITS)
    row_cycles, group_cycles = unsigned(CYCLE_BITS), unsigned(CYCLE_BITS)

    if fixed:
        rect_word, bad_rectangle = tied(0, WORD_BITS), tied(0, 1)
        word, table = fixed_rects(rects, config)
    if fixed and fixed.camera:
        camera_word = tied(0, WORD_BITS)
        camera.x, camera.y, camera.z = (tied(value, unsigned(COORDINATE_BITS)) for value in fixed.camera)
        background, reflections = tied(fixed.background, background), tied(config.reflections, reflections)
        for name, signal in vars(bus).items():
            setattr(bus, name, unconnected(signal))
    picture = (None, None) if fixed and fixed.camera else (reflections, background)

    registers = avalon_interface(
        clk, reset, avs_s0_address, avs_s0_read, avs_s0_write, avs_s0_writedata, avs_s0_byteenable, avs_s0_readdata,
        avs_s0_readdatavalid, avs_s0_waitrequest, irq, bus, camera_word, rect_word, bad_rectangle, run, *picture,
        start_screen, busy, underrun, row_cycles, group_cycles, config,
    )  # fmt: skip
    renderer = RENDERERS[config.engine](
        clk, reset, run, reflections, background, camera, rects, start_screen, busy, underrun, row_cycles,
        group_cycles, vga_r, vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk, config,
    )  # fmt: skip

    if not fixed:
        return (
            registers, renderer,
            camera_mem(clk, reset, bus, camera_word, camera),
            rect_mem(clk, reset, bus, rect_word, bad_rectangle, rects, config),
        )  # fmt: skip

    memories = []
    if table:
        pipelined = isinstance(rects, PipelinedRects)
        memories.append(rect_rom(clk, rects.index, rects.fetch, word, table, pipelined, config))
    if not fixed.camera:
        memories.append(camera_mem(clk, reset, bus, camera_word, camera))
    return registers, renderer, memories
