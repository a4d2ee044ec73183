# SPDX-License-Identifier: MIT
"""The ray tracer behind a bus, with a VGA output: the top module of the generated Verilog."""

from myhdl import block, instances

from raycaster.buses import BUSES
from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, derived_clock, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.registers import address_bits
from raycaster.rtl.bus.avalon_interface import avalon_interface
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.bus.frame_registers import frame_registers
from raycaster.rtl.common.clock_gate import clock_gate
from raycaster.rtl.common.interfaces import AvalonPort, Picture, Progress, Rects, SceneBus
from raycaster.rtl.common.records import Camera
from raycaster.rtl.common.widths import REFLECTION_BITS, RGB_BITS, WORD_BITS
from raycaster.rtl.engines import engine_of
from raycaster.rtl.scene.camera_mem import camera_mem
from raycaster.rtl.scene.rect_mem import rect_mem
from raycaster.rtl.scene.rect_rom import rect_rom


@block
def ray_caster_module(clk, reset, avs_s0, irq, vga, config: Configuration, s_axi=None, wb=None, s_apb=None, uart=None):
    """Connect registers, scene memories and renderer, in one clock domain.

    The parts of the scene that config.fixed names are built in: they have no memory, and writes to their registers have
    no effect. The bus is avs_s0, s_axi, wb, s_apb or uart, as chosen by config.bus.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        avs_s0: `AvalonPort`, this block as the agent; its addresses count 32-bit words.
        irq: output, the interrupt; high while irq_pending and irq_enable are set.
        vga: `Vga`; output. Data changes at the falling edge of vga.clk.
        s_axi: `Axi4LitePort`, this block as the subordinate; its addresses count bytes.
        wb: `WishbonePort`, this block as the slave; its addresses count 32-bit words.
        s_apb: `ApbPort`, this block as the completer; its addresses count bytes.
        uart: `UartPort`, of this block.
    """
    fixed, camera_fixed = config.fixed, bool(config.fixed and config.fixed.camera)
    reflections, background, camera_fields, usable = None, None, None, None
    if fixed and fixed.background is not None:  # and so is the camera
        reflections, background = tied(config.most_reflections, REFLECTION_BITS), tied(fixed.background, RGB_BITS)
        camera_fields = fixed.camera_fields
    if fixed:
        usable = tied((1 << config.rectangles) - 1, unsigned(config.rectangles))
    bus = SceneBus(address_bits(*config.map), is_read=config.facts.whole_frames or not camera_fixed)
    picture = Picture(reflections=reflections, background=background)
    camera = Camera(config, fixed=camera_fields)
    rects, progress = Rects(config, usable=usable), Progress(config)
    camera_readback, rect_readback = unsigned(WORD_BITS), unsigned(WORD_BITS)
    bad_rectangle = bit()
    resting = not config.facts.whole_frames and not fixed
    scene_clk = derived_clock(clk) if resting else clk

    if fixed:
        rect_readback, bad_rectangle = tied(0, WORD_BITS), tied(0, 1)
        rectangles = rect_rom(clk, rects, config)
    else:
        rectangles = rect_mem(scene_clk, reset, bus, rect_readback, bad_rectangle, rects, config)
    if camera_fixed:
        camera_readback = tied(0, WORD_BITS)
    else:
        position = camera_mem(scene_clk, reset, bus, camera_readback, camera)
    if config.bus in BRIDGES:
        avs_s0, name = AvalonPort(len(bus.address)), BUSES[config.bus].port
        port = {"s_axi": s_axi, "wb": wb, "s_apb": s_apb, "uart": uart}[name]
        parameters = BRIDGES[config.bus].parameters(config)
        bridge = BRIDGES[config.bus].block(clk, reset, avm_m0=avs_s0, **{name: port}, **parameters)
    readback = rect_readback
    if config.facts.whole_frames:
        readback = unsigned(WORD_BITS)
        frames = frame_registers(clk, reset, bus, progress.frames, rect_readback, readback, rectangles=config.table)

    registers = avalon_interface(
        clk, reset, avs_s0=avs_s0, irq=irq, bus=bus, camera_readback=camera_readback,
        rect_readback=readback, bad_rectangle=bad_rectangle, picture=picture, progress=progress, config=config,
    )  # fmt: skip
    # An access, a write, a commit and StartScreen each take one clock of the scene's memories, however late the next
    # clock comes.
    if resting:
        scene_awake = bit()

        wake = assign(scene_awake, lambda: bus.access or bus.write or bus.commit or bus.go_live or progress.busy)

        gate = clock_gate(clk, reset, awake=scene_awake, gated_clk=scene_clk)
    renderer = engine_of(config).renderer(
        clk, reset, picture=picture, camera=camera, rects=rects, progress=progress, vga=vga, config=config
    )

    return instances()
