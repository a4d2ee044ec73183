# SPDX-License-Identifier: MIT
"""Blocks that are converted alone for a proof, at widths that no whole design has, or next to what replaces them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from raycaster.buses import BUSES
from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.fit.fixing import fixed_rectangle
from raycaster.fixed import FixedScene
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.common.interfaces import (
    Access,
    AvalonPort,
    FrameEvents,
    Rects,
    Scan,
    SceneBus,
    Slope,
    Steps,
    Vector,
    Vga,
)
from raycaster.rtl.common.records import Pixel, Rect, Signs
from raycaster.rtl.common.widths import LANES, WORD_BITS
from raycaster.rtl.exact.eye_register import Mirror
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.rtl.scene.rect_mem import rect_mem
from raycaster.rtl.scene.rect_rom import rect_rom
from raycaster.rtl.scene.written_rect import CORNER, surface_mask
from raycaster.rtl.span.frame_list import frame_list
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.run_queue import run_queue
from raycaster.rtl.video.video_generator import video_generator
from raycaster.scene import Camera, Rectangle, Scene
from raycaster.screens import Screen, Span


class Alone:
    """Blocks that are converted alone."""

    def facts(self) -> dict[str, int]:
        """Return the parameters of proofs that differ from those of a whole design."""
        return {}

    def blocks(self) -> Iterator[Any]:
        """Elaborate the blocks."""
        raise NotImplementedError


TOY_SCREEN = Screen(3, 2, 1, 3, Span(9, 1, 2, 1, active_high=True), Span(6, 1, 1, 3, active_high=True))
"""A screen with tripled pixels and a frame that is short enough to be run completely."""


@dataclass(frozen=True)
class VideoAlone(Alone):
    """`video_generator` for a screen that no design has."""

    screen: Screen = TOY_SCREEN

    def blocks(self) -> Iterator[Any]:
        """Elaborate the video generator."""
        yield video_generator(bit(), reset_signal(), scan=Scan(), pixel=Pixel(8), vga=Vga(8), screen=self.screen)


@dataclass(frozen=True)
class TesterAlone(Alone):
    """`rect_tester` with narrow coordinates, slopes as wide, and eyes after this many mirrors."""

    coordinate: int
    reflections: int

    @property
    def _eye(self) -> int:
        return (((1 << self.coordinate) - 1) * (self.reflections + 1)).bit_length() + 1

    def facts(self) -> dict[str, int]:
        """Return the widths of slopes and eyes."""
        return {"SLOPE_BITS": self.coordinate, "EYE_BITS": self._eye}

    def blocks(self) -> Iterator[Any]:
        """Elaborate the test."""
        distance, design = self._eye - 1, configure(engine="exact", reflections=self.reflections)
        yield rect_tester(
            clk=bit(), steps=Steps(), rect=Rect(design, self.coordinate), eye=Vector(self._eye), signs=Signs(),
            slope=Slope(self.coordinate), mirror=Mirror(design, distance), hit=bit(), at_mirror=bit(),
            numerator=unsigned(distance), denominator=unsigned(self.coordinate),
        )  # fmt: skip


@dataclass(frozen=True)
class BridgeAlone(Alone):
    """`avalon_host`, which has no bus, or the bridge from a bus, named as in a configuration."""

    bus: str
    address: int

    def blocks(self) -> Iterator[Any]:
        """Elaborate the host or the bridge."""
        agent = AvalonPort(self.address)
        if not self.bus:
            yield avalon_host(
                bit(), reset_signal(), access=Access(), strobe=unsigned(LANES), address=unsigned(self.address),
                data=unsigned(WORD_BITS), avm_m0=agent,
            )  # fmt: skip
            return
        bridge = BRIDGES[self.bus]
        ports = {BUSES[self.bus].port: bridge.interface(self.address)}
        yield bridge.block(bit(), reset_signal(), avm_m0=agent, **ports)


@dataclass(frozen=True)
class QueueAlone(Alone):
    """`run_queue` for rows of a few columns."""

    columns: int
    places: int

    def facts(self) -> dict[str, int]:
        """Return the width of a run."""
        return {"RUN_BITS": len(ListEntry(self.columns, 1).word)}

    def blocks(self) -> Iterator[Any]:
        """Elaborate the queue."""
        yield run_queue(
            bit(), bit(), valid=bit(), run=ListEntry(self.columns, 1), take=bit(), ready=bit(), room=bit(),
            offered=bit(), head=ListEntry(self.columns, 1), columns=self.columns, places=self.places,
        )  # fmt: skip


@dataclass(frozen=True)
class ListAlone(Alone):
    """`frame_list` for a picture of a few rows and columns, with pixels of one bit."""

    units: int
    rows: int
    columns: int
    entries: int
    pixels: int

    def facts(self) -> dict[str, int]:
        """Return the width of a run."""
        return {"RUN_BITS": len(ListEntry(self.columns, 1).word)}

    def blocks(self) -> Iterator[Any]:
        """Elaborate the lists."""
        units, width = self.units, self.facts()["RUN_BITS"]
        yield frame_list(
            bit(), reset_signal(), scan=Scan(), run=bit(), hold=bit(), take_scene=bit(), stop=bit(), first_row=bit(),
            next_row=bit(), start=unsigned(units), done=unsigned(units), valid=unsigned(units),
            runs=unsigned(units * width), ready=unsigned(units), busy=bit(), events=FrameEvents(),
            shown=unsigned(self.pixels), columns=self.columns, rows=self.rows, entries=self.entries, units=units,
            pixels=self.pixels, queue=self.columns,
        )  # fmt: skip


FIXED_SCENE = Scene(
    camera=Camera(position=(20, 250, 100)),
    rect=(
        Rectangle(corners=((0, 100, 0), (511, 420, 0)), colour=(200, 200, 180)),
        Rectangle(corners=((300, 400, 180), (300, 60, 0)), colour=(80, 160, 255), mirror=1.0),
        Rectangle(corners=((200, 270, 20), (130, 270, 140)), colour=(255, 64, 32), mirror=0.25),
    ),
)
"""A floor, a wall and a post; corners in any order."""


@dataclass(frozen=True)
class TableAlone(Alone):
    """The memory of a general design, and the table that replaces it for a fixed scene.

    Attributes:
        engine: name of the designs' engine.
        alike: True if the rectangles differ in a single colour, False if they are those of `FIXED_SCENE`.
    """

    engine: str
    alike: bool

    def _designs(self) -> tuple[Scene, Configuration, Configuration]:
        rect = FIXED_SCENE.rect
        if self.alike:
            rect = (rect[1], rect[1], rect[1].model_copy(update={"colour": (1, 2, 3)}))
        options = {"engine": self.engine, "materials": not self.alike, "allow_underrun": True}
        every = (1 << len(rect)) - 1
        fixed = configure(fixed=FixedScene(tuple(map(fixed_rectangle, rect)), (every, every)), **options)
        scene = FIXED_SCENE.model_copy(update={"rect": rect})
        return scene, configure(rectangles=len(rect), **options), fixed

    def facts(self) -> dict[str, int]:
        """Return the scene's words, and the masks that are kept of them."""
        scene, general, fixed = self._designs()
        words, registers = dict(scene_words(scene, general)), register_map(*general.map)
        return {
            f"{name.upper()}_{index}": words[registers[f"rectangle[{index}].{name}"].address]
            for index in range(general.table)
            for name in ("corner_0", "corner_1", "surface")
        } | {
            "RECT_BITS": len(Rect(fixed).word),
            "CORNER_BITS": CORNER.implemented,
            "SURFACE_BITS": surface_mask(general),
        }

    def blocks(self) -> Iterator[Any]:
        """Elaborate both sources of rectangles."""
        _, general, fixed = self._designs()
        yield rect_rom(bit(), Rects(fixed), fixed)
        yield rect_mem(
            bit(), reset_signal(), SceneBus(address_bits(*general.map)), readback=unsigned(WORD_BITS),
            bad_rectangle=bit(), rects=Rects(general), config=general,
        )  # fmt: skip
