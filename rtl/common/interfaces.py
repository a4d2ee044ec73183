# SPDX-License-Identifier: MIT
"""Ports that belong together. As a port `vga`, the attribute `hs` becomes the Verilog port `vga_hs`.

What a class says of its attributes stands above those ports in Verilog.
"""

from typing import ClassVar

from raycaster.configuration import Configuration
from raycaster.engines.exact import AIM_CYCLES
from raycaster.rtl.common.records import rect_of
from raycaster.rtl.common.widths import (
    CYCLE_BITS,
    LANES,
    REFLECTION_BITS,
    RGB_BITS,
    SLOPE_BITS,
    WORD_BITS,
    bit,
    index_bits,
    offset_bits,
    row_bits,
    signed,
    unsigned,
)


class Interface:
    """A group of signals; generated Verilog names them group_signal."""

    is_interface = True


class Vga(Interface):
    """A video output, for a DAC or a digital encoder. Data changes at the falling edge of clk.

    With two pixels per clock each colour is two channels; the low half belongs to the left pixel, in an even column.

    Attributes:
        r: red, 0 in the blanking.
        g: green, 0 in the blanking.
        b: blue, 0 in the blanking.
        hs: horizontal sync.
        vs: vertical sync.
        blank_n: low in the blanking.
        sync_n: composite sync, unused and low.
        clk: pixel clock; its rising edge is in the middle of a pixel.
    """

    def __init__(self, colour_bits: int):
        self.r, self.g, self.b = (unsigned(colour_bits) for _ in range(3))
        self.hs, self.vs, self.blank_n, self.sync_n, self.clk = (bit() for _ in range(5))


def vga_of(config: Configuration) -> Vga:
    """A design's."""
    return Vga(config.colour_bits * config.pixels)


class AvalonPort(Interface):
    """Avalon-MM with word addresses, 32-bit data and pipelined reads, as a host or an agent has it.

    Attributes:
        address: number of the register, its byte offset over four.
        read: request to read, held while waitrequest is high.
        write: request to write, held while waitrequest is high.
        writedata: word to write.
        byteenable: a bit for each byte of writedata; only bytes whose bit is 1 are written.
        readdata: word that was read, valid with readdatavalid.
        readdatavalid: high for a cycle with each word that was read, in the order of the requests.
        waitrequest: the request of this cycle is not taken yet.
    """

    def __init__(self, address_bits: int):
        self.address = unsigned(address_bits)
        self.read, self.write = bit(), bit()
        self.writedata, self.byteenable = unsigned(WORD_BITS), unsigned(LANES)
        self.readdata = unsigned(WORD_BITS)
        self.readdatavalid, self.waitrequest = bit(), bit()


class BusPort(Interface):
    """A bus that has a bridge to Avalon-MM, as the bridge has it.

    outputs: names of the signals that the bridge drives.
    """

    outputs: ClassVar[tuple[str, ...]]


class Picture(Interface):
    """What is shown beside rectangles and camera. It is live, so it changes only in the cycle after start_screen.

    Attributes:
        run: 0 renders nothing and shows black.
        reflections: of the scene.
        background: colour of the background, 24 bits.
    """

    def __init__(self):
        self.run = bit()
        self.reflections = unsigned(REFLECTION_BITS)
        self.background = unsigned(RGB_BITS)


class Progress(Interface):
    """How far a renderer is.

    Attributes:
        start_screen: strobe before the first visible line.
        busy: a row is being rendered.
        underrun: strobe; a row was not complete in time.
        row_cycles: cycles since the row's start, counting the present one; don't care unless busy.
        group_cycles: cycles since the group's start, counting the present one; don't care unless busy.
    """

    def __init__(self):
        self.start_screen, self.busy, self.underrun = bit(), bit(), bit()
        self.row_cycles, self.group_cycles = unsigned(CYCLE_BITS), unsigned(CYCLE_BITS)


class Scan(Interface):
    """Where the monitor is; `video_generator` has the timing.

    Attributes:
        start_screen: strobe before the first row.
        start_row: strobe before each row.
        visible_line: high in the visible part of a line.
        next_column: strobe before each column.
    """

    def __init__(self):
        self.start_screen, self.start_row, self.visible_line, self.next_column = (bit() for _ in range(4))


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


class Direction(Interface):
    """A slope, or what is added to one, in two's complement.

    Attributes:
        x: component along x.
        y: component along y.
        z: component along z.
    """

    def __init__(self, bits: int):
        self.x, self.y, self.z = (signed(bits) for _ in range(3))


class Steps(Interface):
    """The control signals that operate all ray units in step: strobes, unless they say otherwise.

    Attributes:
        screen_to_ray: load the primary ray.
        initial_ray: level; trace the primary ray, not a reflected one.
        find_intersection: start on the rectangle at hand.
        load_divider: load the divider, where there is one, with what was started.
        store_quotient: store what the divider found.
        reset_z_buf: forget the nearest hit.
        write_z_buf: keep the hit at hand if it is nearer.
        reset_colour: begin a new pixel.
        add_colour: add the colour that the ray saw.
        store_ray: keep the reflected ray.
        aim: one-hot, the cycle in which shadow rays are computed; 0 otherwise.
        from_light: level; shadow rays are tested instead of the units' own rays.
        write_shadow: keep whether the rectangle under test shades the point.
    """

    def __init__(self):
        self.screen_to_ray, self.initial_ray, self.find_intersection = (bit() for _ in range(3))
        self.load_divider, self.store_quotient, self.reset_z_buf, self.write_z_buf = (bit() for _ in range(4))
        self.reset_colour, self.add_colour, self.store_ray = (bit() for _ in range(3))
        self.aim = unsigned(AIM_CYCLES)
        self.from_light, self.write_shadow = bit(), bit()


class ShadowPass(Interface):
    """Signals between the ray sequencer and the `shadow_sequencer`, which adds a shadow pass after each pass of rays.

    Attributes:
        traced: the present pass has tested all its rectangles.
        awaited: the rays wait for the end of the shadow pass.
        comes_next: the next pass is a shadow pass.
        start: strobe; a shadow pass begins in the next cycle.
        stop: strobe; the remaining tests of the shadow pass cannot change a pixel.
    """

    def __init__(self):
        self.traced, self.awaited, self.comes_next, self.start, self.stop = (bit() for _ in range(5))


class RayFate(Interface):
    """What a unit's ray may still meet.

    Attributes:
        towards: it has hit mirrors at every bounce before, and runs towards the plane that find_intersection started on
            in the cycle before; where a control ends rectangles early.
        alive: what it has hit since reset_z_buf, and at every bounce before, are mirrors.
        in_question: the light may reach the hit point: it is on the side that the ray came from, and nothing tested
            since steps.aim is in between.
    """

    def __init__(self):
        self.towards, self.alive, self.in_question = bit(), bit(), bit()


class GroupFate(Interface):
    """What any ray of a group may still meet.

    Attributes:
        any_towards: fate.towards of at least one unit.
        any_alive: fate.alive of at least one unit.
        any_in_question: fate.in_question of at least one unit.
        may_hit: a bit for each rectangle, 1 where a primary ray may hit it.
    """

    def __init__(self, config: Configuration):
        self.any_towards, self.any_alive, self.any_in_question = bit(), bit(), bit()
        self.may_hit = unsigned(config.rectangles)


class Eye(Interface):
    """The camera, mirrored in all mirrors so far, in two's complement and whole world units.

    Attributes:
        x: coordinate along x.
        y: coordinate along y.
        z: coordinate along z.
    """

    def __init__(self, bits: int):
        self.x, self.y, self.z = (signed(bits) for _ in range(3))


class SceneBus(Interface):
    """What the registers tell the scene memories: a write, or where to read, and when the shadow moves on.

    Attributes:
        write: strobe; write data at address.
        commit: strobe; copy the shadow to the pending scene at the end of the cycle. It comes in the cycle after the
            write that asks for it, so never in the one after a write to a scene memory.
        go_live: strobe; copy the pending scene to the live one at the end of the cycle.
        address: of a word, to write and to read back.
        data: word to write.
        mask: which of its bits to write.
    """

    def __init__(self, address_bits: int):
        self.write, self.commit, self.go_live = bit(), bit(), bit()
        self.address = unsigned(address_bits)
        self.data, self.mask = unsigned(WORD_BITS), unsigned(WORD_BITS)


class Rects(Interface):
    """One live rectangle at a time: sorted, the engine's rect_latency cycles after fetch, held until the next fetch.

    Attributes:
        usable: a bit for each rectangle, 1 where it is enabled and has a plane; the others are don't care.
        index: number of the rectangle to fetch.
        fetch: strobe; read the rectangle of this index.
        rect: the rectangle that was fetched.
    """

    def __init__(self, config: Configuration):
        self.usable = unsigned(config.rectangles)
        self.index = unsigned(index_bits(config))
        self.fetch = bit()
        self.rect = rect_of(config)


class ProcessorBus(Interface):
    """PicoRV32's native memory interface: one access at a time, each held still from valid to ready.

    Attributes:
        valid: an access waits.
        ready: it is done in this cycle.
        address: of a byte, a multiple of four.
        data: word to write.
        word: word that was read, valid with ready.
        strobe: which bytes to write; 0 to read.
    """

    def __init__(self):
        self.valid, self.ready = bit(), bit()
        self.address, self.data, self.word = (unsigned(WORD_BITS) for _ in range(3))
        self.strobe = unsigned(LANES)


class Access(Interface):
    """A processor's access to what it selects, held still from select to ready.

    Attributes:
        select: high from the access's first cycle to the one in which ready is high.
        ready: the access is done in this cycle.
        word: word that was read, valid with ready.
    """

    def __init__(self):
        self.select, self.ready = bit(), bit()
        self.word = unsigned(WORD_BITS)
