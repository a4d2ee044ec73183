# SPDX-License-Identifier: MIT
"""Groups of ports of the ray tracer. The attribute `hs` of a port `vga` becomes the Verilog port `vga_hs`.

The text for each attribute becomes the comment above that port in Verilog.
"""

from typing import Any, ClassVar

from raycaster.configuration import Configuration
from raycaster.hdl.records import Interface
from raycaster.hdl.signals import Tied, bit, signed, tied, unconnected, unsigned
from raycaster.registers import Register
from raycaster.rtl.common.records import Rect
from raycaster.rtl.common.widths import (
    CYCLE_BITS,
    LANES,
    REFLECTION_BITS,
    RGB_BITS,
    SLOPE_BITS,
    WORD_BITS,
    index_bits,
    offset_bits,
    row_bits,
)


class Group(Interface):
    """An interface whose signals may be given by name, to share them or to tie them; None makes a new one."""

    def __init__(self, **given: Any):
        if unknown := given.keys() - vars(self).keys():
            raise TypeError(f"{type(self).__name__} has no {', '.join(sorted(unknown))}")
        vars(self).update({name: signal for name, signal in given.items() if signal is not None})


class Vga(Interface):
    """A video output, for a DAC or a digital encoder. Data changes at the falling edge of clk.

    With two pixels per clock each colour port carries two channels; the low half is the left pixel, in an even column.

    Attributes:
        r: red, 0 during blanking.
        g: green, 0 during blanking.
        b: blue, 0 during blanking.
        hs: horizontal sync.
        vs: vertical sync.
        blank_n: low during blanking.
        sync_n: composite sync, unused and low.
        clk: pixel clock; its rising edge is in the middle of a pixel.
    """

    def __init__(self, colour_bits: int):
        self.r, self.g, self.b = (unsigned(colour_bits) for _ in range(3))
        self.hs, self.vs, self.blank_n, self.sync_n, self.clk = (bit() for _ in range(5))


class AvalonPort(Group):
    """An Avalon-MM port with word addresses, 32-bit data and pipelined reads, for a host or an agent.

    Attributes:
        address: register number, the byte offset divided by four.
        read: request to read, held while waitrequest is high.
        write: request to write, held while waitrequest is high.
        writedata: word to write.
        byteenable: one bit per byte of writedata; only bytes whose bit is 1 are written.
        readdata: word that was read, valid with readdatavalid.
        readdatavalid: high for one cycle with each word read, in the order of the requests.
        waitrequest: the request of this cycle is not accepted yet.
    """

    def __init__(self, address_bits: int, **given: Any):
        self.address = unsigned(address_bits)
        self.read, self.write = bit(), bit()
        self.writedata, self.byteenable = unsigned(WORD_BITS), unsigned(LANES)
        self.readdata = unsigned(WORD_BITS)
        self.readdatavalid, self.waitrequest = bit(), bit()
        super().__init__(**given)


class BusPort(Interface):
    """A port of a bridge to Avalon-MM, on the side of the other bus.

    outputs: names of the signals that the bridge drives.
    """

    outputs: ClassVar[tuple[str, ...]]


class Picture(Group):
    """Live settings other than rectangles and camera: they change only in the cycle after start_screen.

    Attributes:
        run: 0 renders nothing and shows black.
        reflections: number of reflections in the scene.
        background: colour of the background, 24 bits.
    """

    def __init__(self, **given: Any):
        self.run = bit()
        self.reflections = unsigned(REFLECTION_BITS)
        self.background = unsigned(RGB_BITS)
        super().__init__(**given)


class FrameEvents(Interface):
    """Events in the life of a frame: strobes, except time.

    Attributes:
        drawn: a frame is whole.
        shown: a frame that has been drawn is handed over to the monitor.
        again: StartScreen, and the frame before stands, as no whole one follows it.
        late: StartScreen, and a frame is still being drawn.
        list_full: a frame is abandoned, as its list is full.
        time: with drawn, cycles of the frame since the StartScreen at which it began; with shown, cycles since it was
            whole. It saturates.
    """

    def __init__(self):
        self.drawn, self.shown, self.again, self.late, self.list_full = (bit() for _ in range(5))
        self.time = unsigned(WORD_BITS)


class Progress(Interface):
    """Progress of a renderer.

    Attributes:
        start_screen: strobe before the first visible line.
        take_scene: strobe; the pending scene goes live. Only with whole frames, which may be late; else it goes live at
            start_screen.
        frames: what becomes of frames. Only with whole frames.
        busy: a row or, with whole frames, a frame is being rendered.
        underrun: strobe; a row was not complete in time. Never with whole frames.
        row_cycles: cycles since the row's start, including the present one; don't care unless busy. Not with whole
            frames.
        group_cycles: cycles since the group's start, including the present one; don't care unless busy. Not with whole
            frames.
    """

    def __init__(self, config: Configuration):
        self.start_screen, self.busy = bit(), bit()
        if config.facts.whole_frames:
            self.take_scene, self.frames = bit(), FrameEvents()
        else:
            self.underrun = bit()
            self.row_cycles, self.group_cycles = unsigned(CYCLE_BITS), unsigned(CYCLE_BITS)


class Scan(Group):
    """Scan position of the monitor; `video_generator` defines the timing.

    Attributes:
        start_screen: strobe before the first row.
        start_row: strobe before each row.
        visible_line: high in the visible part of a line.
        next_column: strobe before each column.
    """

    def __init__(self, **given: Any):
        self.start_screen, self.start_row, self.visible_line, self.next_column = (bit() for _ in range(4))
        super().__init__(**given)


class Place(Interface):
    """A group of columns on the screen: column = column_offset * units + unit.

    Attributes:
        row: row of rays, 0 at the top.
        column_offset: number of the group in its row.
    """

    def __init__(self, config: Configuration):
        self.row = unsigned(row_bits(config))
        self.column_offset = unsigned(offset_bits(config))


class Slope(Interface):
    """Magnitudes of a ray's slope, which a reflection does not change.

    Attributes:
        dx: along x.
        dy: along y.
        dz: along z.
    """

    def __init__(self, bits: int = SLOPE_BITS):
        self.dx, self.dy, self.dz = (unsigned(bits) for _ in range(3))


class Vector(Group):
    """A slope, an increment of one, or a mirrored eye in whole world units, in two's complement.

    Attributes:
        x: component along x.
        y: component along y.
        z: component along z.
    """

    def __init__(self, bits: int, **given: Any):
        self.x, self.y, self.z = (signed(bits) for _ in range(3))
        super().__init__(**given)


AIM_CYCLES = 4
"""Cycles from the end of a pass to the start of the shadow pass: the shadow ray, a component per cycle."""


class Steps(Group):
    """Control signals that operate all ray units in lockstep: strobes, unless stated otherwise.

    Attributes:
        screen_to_ray: load the primary ray.
        initial_ray: level; trace the primary ray, not a reflected one.
        find_intersection: start testing the fetched rectangle.
        load_divider: load the divider, if there is one.
        store_quotient: store the divider's result.
        reset_z_buf: clear the nearest hit.
        write_z_buf: store the offered hit if it is nearer.
        reset_colour: start a new pixel.
        add_colour: add the colour that the ray saw.
        store_ray: store the reflected ray.
        aim: one-hot cycle count while shadow rays are computed; 0 otherwise.
        write_shadow: set the shadow flag if the tested rectangle shades the hit point.
    """

    def __init__(self, **given: Any):
        self.screen_to_ray, self.initial_ray, self.find_intersection = (bit() for _ in range(3))
        self.load_divider, self.store_quotient, self.reset_z_buf, self.write_z_buf = (bit() for _ in range(4))
        self.reset_colour, self.add_colour, self.store_ray = (bit() for _ in range(3))
        self.aim = unsigned(AIM_CYCLES)
        self.write_shadow = bit()
        super().__init__(**given)


class ShadowPass(Group):
    """Signals between the ray sequencer and the `shadow_sequencer`, which adds a shadow pass after each pass of rays.

    Attributes:
        traced: the present pass has tested all its rectangles.
        awaited: the rays wait for the end of the shadow pass.
        comes_next: the next pass is a shadow pass.
        start: strobe; a shadow pass begins in the next cycle.
        stop: strobe; the remaining tests of the shadow pass cannot change a pixel.
    """

    def __init__(self, **given: Any):
        self.traced, self.awaited, self.comes_next, self.start, self.stop = (bit() for _ in range(5))
        super().__init__(**given)


class RayFate(Interface):
    """Possible further hits of a unit's ray.

    Attributes:
        towards: the ray hit a mirror at every earlier bounce, and runs towards the plane of the find_intersection in
            the previous cycle; used only if the control ends rectangles early.
        alive: the nearest hit since reset_z_buf, and the hit at every earlier bounce, is a mirror.
        in_question: the light may reach the hit point: it is on the side from which the ray came, and no rectangle
            tested since steps.aim is in between.
    """

    def __init__(self):
        self.towards, self.alive, self.in_question = bit(), bit(), bit()


class GroupFate(Group):
    """Possible further hits of any ray of a group.

    Attributes:
        any_towards: fate.towards of at least one unit.
        any_alive: fate.alive of at least one unit.
        any_in_question: fate.in_question of at least one unit.
        may_hit: one bit per rectangle, 1 if a primary ray may hit it.
    """

    def __init__(self, config: Configuration, **given: Any):
        self.any_towards, self.any_alive, self.any_in_question = bit(), bit(), bit()
        self.may_hit = unsigned(config.rectangles)
        super().__init__(**given)


class SceneBus(Interface):
    """Signals from the registers to the scene memories: writes, read addresses, and when to copy the shadow.

    Attributes:
        access: strobe; the next cycle reads or writes a word.
        next_address: address of that word, read with access.
        write: strobe; write data at address.
        commit: strobe; copy the shadow to the pending scene at the end of the cycle. It comes in the cycle after the
            write that requests it, so never in the cycle after a write to a scene memory.
        go_live: strobe; copy the pending scene to the live one at the end of the cycle.
        address: address of the word to write or to read back, that of the last access.
        data: word to write.
        mask: bits of the word to write.
    """

    def __init__(self, address_bits: int, is_read: bool = True):
        self.access, self.write, self.commit, self.go_live = (bit() for _ in range(4))
        self.next_address, self.address = unsigned(address_bits), unsigned(address_bits)
        self.data, self.mask = unsigned(WORD_BITS), unsigned(WORD_BITS)
        if not is_read:
            vars(self).update({name: unconnected(signal) for name, signal in vars(self).items()})

    def address_of(self, register: Register) -> Tied:
        """Return the address of a register as a constant, as wide as the bus's addresses."""
        return tied(register.address, len(self.address))


class Rects(Group):
    """Read port for a live rectangle: sorted, in the cycle after fetch, and held until the next fetch.

    Attributes:
        usable: one bit per rectangle, 1 if it is enabled and lies in a plane; other rectangles are don't care.
        index: number of the rectangle to fetch.
        fetch: strobe; read the rectangle at index.
        rect: the fetched rectangle.
    """

    def __init__(self, config: Configuration, **given: Any):
        self.usable = unsigned(config.rectangles)
        self.index = unsigned(index_bits(config))
        self.fetch = bit()
        self.rect = Rect(config)
        super().__init__(**given)


class ProcessorBus(Interface):
    """PicoRV32's native memory interface: one access at a time, stable from valid to ready.

    Attributes:
        valid: an access is pending.
        ready: the access completes in this cycle.
        address: byte address, a multiple of four.
        data: word to write.
        word: word that was read, valid with ready.
        strobe: bytes to write, one bit each; 0 for a read.
    """

    def __init__(self):
        self.valid, self.ready = bit(), bit()
        self.address, self.data, self.word = (unsigned(WORD_BITS) for _ in range(3))
        self.strobe = unsigned(LANES)


class Access(Interface):
    """A processor's access to the selected device, stable from select to ready.

    Attributes:
        select: high from the first cycle of the access to the one in which ready is high.
        ready: the access completes in this cycle.
        word: word that was read, valid with ready.
    """

    def __init__(self):
        self.select, self.ready = bit(), bit()
        self.word = unsigned(WORD_BITS)
