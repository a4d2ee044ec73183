# SPDX-License-Identifier: MIT
"""Model the registers clock by clock: what each answer must be, and which scene is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from raycaster.configuration import Configuration
from raycaster.golden.frames import cycles_of
from raycaster.golden.model import Model
from raycaster.golden.spans import SpanModel
from raycaster.golden.world import Rectangles
from raycaster.registers import Register, register_map
from raycaster.rtl.engines import buffered_engine_of
from raycaster.scene import CELLS, UNTURNED, Basis, Light
from raycaster.screens import Screen

AXES = "xyz"
COLOURS = ("red", "green", "blue")
VECTORS = ("forward", "right", "up")
EVERY_LANE = 0b1111


def mask_of(lanes: int) -> int:
    """Return the mask of the enabled bytes."""
    return sum(0xFF << 8 * lane for lane in range(4) if lanes >> lane & 1)


class Word:
    """A register's word in three stages: shadow, which software writes; pending; and live, which is shown."""

    def __init__(self, implemented: int, first: int = 0):
        self.implemented, self.first = implemented, first
        self.reset()

    def reset(self) -> None:
        """Reset all stages."""
        self.shadow = self.pending = self.live = self.first

    def write(self, data: int, mask: int) -> None:
        """Write some bits of the shadow."""
        self.shadow = (self.shadow & ~mask | data & mask) & self.implemented

    def clock(self, bus: dict[str, int], selected: bool) -> None:
        """Apply a clock edge, with the internal bus's signals before it."""
        if bus["bus_go_live"]:
            self.live = self.pending
        if bus["bus_commit"]:
            self.pending = self.shadow
        if bus["bus_write"] and selected:
            self.write(bus["bus_data"], bus["bus_mask"])


class Table:
    """The rectangle table: four words per slot, or three without patterns."""

    def __init__(self, config: Configuration):
        registers = register_map(config.rectangles)
        first = {name: registers[f"rectangle[0].{name}"] for name in ("corner_0", "corner_1", "surface", "pattern")}
        self._point, self._surface, self._pattern = (first[name] for name in ("corner_0", "surface", "pattern"))
        kept = {name: register.implemented for name, register in first.items()}
        if not config.materials:
            kept["surface"] &= ~self._surface.fields["mirror"].mask
        if not config.patterns:
            del kept["pattern"]
        self.names = tuple(kept)
        self.words = {
            registers[f"rectangle[{index}].{name}"].address: Word(implemented)
            for index in range(config.rectangles)
            for name, implemented in kept.items()
        }
        self._config = config

    def slot(self, index: int) -> list[Word]:
        """Return a rectangle's words, in the order of `names`."""
        first = self._point.address + 4 * index
        return [self.words[first + offset] for offset in range(len(self.names))]

    def rectangles(self, stage: str) -> Rectangles:
        """Decode the rectangles of a stage, `"shadow"` or `"live"`."""
        corners, colours, enabled, mirrors, kinds, cells, colours_2 = ([] for _ in range(7))
        for index in range(self._config.rectangles):
            corner_0, corner_1, surface, *pattern = (getattr(word, stage) for word in self.slot(index))
            corners.append([[self._point.unpack(corner)[axis] for axis in AXES] for corner in (corner_0, corner_1)])
            fields = self._surface.unpack(surface)
            colours.append([fields[channel] for channel in COLOURS])
            enabled.append(bool(fields["enable"]))
            mirrors.append(min(fields["mirror"], 4) if self._config.materials else 2)
            fields = self._pattern.unpack(pattern[0] if pattern else 0)
            kinds.append(fields["kind"])
            cells.append(CELLS[0] << fields["cell"])
            colours_2.append([fields[channel] for channel in COLOURS])
        return Rectangles(
            np.array(corners), np.array(colours, dtype=np.uint8), np.array(enabled), np.array(mirrors),
            np.array(kinds), np.array(cells), np.array(colours_2, dtype=np.uint8),
        )  # fmt: skip

    def clock(self, inputs: dict[str, int]) -> None:
        """Apply a clock edge, with reset and the internal bus's signals before it."""
        if inputs["reset"]:
            for word in self.words.values():
                word.reset()
        elif inputs["bus_commit"] or inputs["bus_go_live"]:
            for address, word in self.words.items():
                word.clock(inputs, inputs["bus_address"] == address)
        elif word := self.words.get(inputs["bus_address"]):
            word.clock(inputs, True)


def camera_registers(config: Configuration) -> dict[str, Register]:
    """Return the registers of a design's camera and light, by name."""
    names = ("camera", *(VECTORS if config.turn else ()), *("light",) * config.light)
    return {name: register_map(config.rectangles)[name] for name in names}


class CameraWords(dict[str, Word]):
    """Words of a design's camera and light, by the register's name."""

    def __init__(self, config: Configuration):
        self._registers = camera_registers(config)
        super().__init__(
            {name: Word(register.implemented, register.reset) for name, register in self._registers.items()}
        )

    @property
    def by_address(self) -> dict[int, Word]:
        """The words by address."""
        return {self._registers[name].address: word for name, word in self.items()}

    @property
    def position(self) -> tuple[int, int, int]:
        """The live position."""
        return self._vector("camera")

    @property
    def basis(self) -> Basis:
        """The live basis: forward, right and up."""
        if VECTORS[0] not in self:
            return UNTURNED
        forward, right, up = (self._vector(name, 1 << 9) for name in VECTORS)
        return forward, right, up

    @property
    def light(self) -> Light | None:
        """The live light; None if everything is lit."""
        fields = self._registers["light"].unpack(self["light"].live) if "light" in self else {"on": 0}
        if not fields["on"]:
            return None
        return Light(position=(fields["x"], fields["y"], fields["z"]), shade=fields["shade"] / 4)

    def _vector(self, name: str, sign_bit: int = 0) -> tuple[int, int, int]:
        fields = self._registers[name].unpack(self[name].live)
        x, y, z = ((fields[axis] ^ sign_bit) - sign_bit for axis in AXES)
        return x, y, z


@dataclass
class Switch:
    """`frame_switch`, cycle by cycle. A frame is anything that stands for a picture; None is black."""

    state: str = "wait"
    ready: bool = True
    drawn: Any = None
    shown: Any = None
    upper: bool = False
    began: int = 0
    ended: int = 0

    def events(self, start_screen: bool, whole: bool, full: bool, cycle: int) -> Mapping[str, int | None]:
        """Return the events of a cycle, as in `FrameEvents`."""
        hands_over = start_screen and self.state == "wait" and self.ready
        drawing = self.state == "draw"
        drawn, shown = drawing and whole, hands_over and self.drawn is not None
        time = cycle - self.began if drawn else cycle - self.ended if shown else None
        again, late = start_screen and not hands_over, start_screen and drawing
        return {
            "drawn": drawn, "shown": shown, "again": again, "late": late, "list_full": drawing and full, "time": time,
        }  # fmt: skip

    def clock(self, start_screen: bool, run: bool, frame: Any, whole: bool, full: bool, cycle: int) -> None:
        """End a cycle; frame is the picture that is drawn if a frame begins in it."""
        if self.state == "wait" and start_screen:
            if self.ready:
                self.upper, self.shown = not self.upper, self.drawn
            self.state, self.ready, self.began = "begin", False, cycle
        elif self.state == "begin":
            self.drawn = frame if run else None
            self.state, self.ready = ("draw", False) if run else ("wait", True)
        elif self.state == "draw" and (whole or full):
            self.state, self.ready, self.ended = "wait", whole, cycle

    def reset(self) -> None:
        """Start again, with a black frame that is whole."""
        self.__init__()


class FrameCounts:
    """The registers `frames`."""

    NONE = (1 << 32) - 1
    """Least time that is left, if there was no frame."""

    def __init__(self):
        self.reset()

    def reset(self) -> None:
        """Forget all frames."""
        self.cycles, self.least, self.drawn, self.again, self.late, self.list_full = 0, self.NONE, 0, 0, False, False

    def fields(self) -> dict[str, dict[str, int]]:
        """Return the fields of each register."""
        return {
            "frames.cycles": {"cycles": self.cycles},
            "frames.left": {"cycles": self.least},
            "frames.counts": {"drawn": self.drawn, "again": self.again},
            "frames.status": {"late": int(self.late), "list_full": int(self.list_full)},
        }

    def clock(self, events: Mapping[str, int | None], written: str, ones: int, mask: int) -> None:
        """Apply a clock edge, with the events of the cycle and the bits of a register that are written with 1."""
        time = events["time"] or 0
        if events["drawn"]:
            self.cycles = time
        least = self.NONE if written == "frames.left" and mask else self.least
        self.least = 0 if events["late"] else min(least, time) if events["shown"] else least
        self.drawn = (self.drawn + bool(events["drawn"])) % (1 << 16)
        self.again = (self.again + bool(events["again"])) % (1 << 16)
        cleared = ones if written == "frames.status" else 0
        self.late = bool(events["late"] or (self.late and not cleared & 1))
        self.list_full = bool(events["list_full"] or (self.list_full and not cleared & 2))


NO_EVENTS: Mapping[str, int | None] = dict.fromkeys(("drawn", "shown", "again", "late", "list_full", "time"), 0)


class Agent:
    """Model of the agent: a write takes effect a cycle after it is accepted, a read is answered two cycles after.

    With lists of frames, it includes the registers `frames`.
    """

    def __init__(self, config: Configuration):
        self.config = config
        registers = register_map(*config.map)
        self.registers = registers
        self.addresses = {register.address: name for name, register in registers.items()}
        self.control = Word(registers["control"].implemented & ~registers["control"].fields["commit"].mask)
        self.background = Word(registers["background"].implemented)
        named = (
            "fraction_bits", "divider_bits", "reflections", "scale", "colour_bits", "culling", "turn", "materials",
            "patterns", "light",
        )  # fmt: skip
        engine = {"engine": config.facts.code, "nearest": int(config.rounding == "nearest")}
        constants = {
            "id": {"magic": int.from_bytes(b"RAYC", "big")},
            "version": {"major": 1, "minor": int(config.rectangles > 63)},
            "engine": engine | {name: int(getattr(config, name)) for name in named},
            "size": {"units": config.units, "rectangles": min(config.rectangles, 63), "rows": config.rows},
            **({"table": {"rectangles": config.rectangles}} if config.rectangles > 63 else {}),
        }
        self._constants = {name: registers[name].pack(**fields) for name, fields in constants.items()}
        self.reset()

    def reset(self) -> None:
        """Enter the state after a clock edge with reset high: no request is pending."""
        self.control.reset()
        self.background.reset()
        self.frames = FrameCounts()
        self.waiting = True
        self.bus = {"bus_write": 0, "bus_commit": 0, "bus_address": 0, "bus_data": 0, "bus_mask": 0}
        self.reading = False
        self.answer = (0, 0)
        self.commit = False
        self.frame = self.row = self.group = 0
        self.underrun = self.bad = self.irq_enable = self.irq_pending = False

    def read(self, inputs: dict[str, int]) -> int:
        """Return the word at the bus's address in this cycle."""
        name = self.addresses.get(self.bus["bus_address"], "")
        if name in self._constants:
            return self._constants[name]
        fields = {
            "status": {
                "busy": inputs["progress_busy"], "underrun": int(self.underrun), "bad_rectangle": int(self.bad),
                "frame": self.frame,
            },
            "cycles": {"row": self.row, "group": self.group},
            "irq_enable": {"start_screen": int(self.irq_enable)},
            "irq_pending": {"start_screen": int(self.irq_pending)},
            **self.frames.fields(),
        }  # fmt: skip
        if name in fields:
            return self.registers[name].pack(**fields[name])
        words = {
            "control": self.control.shadow | self.registers["control"].pack(commit=int(self.commit)),
            "background": self.background.shadow,
            **dict.fromkeys(camera_registers(self.config), inputs["camera_readback"]),
        }
        return words.get(name, inputs["rect_readback"])

    def outputs(self, inputs: dict[str, int]) -> dict[str, int]:
        """Return every output of the agent in this cycle."""
        control = self.registers["control"].unpack(self.control.live)
        valid, data = self.answer
        return {
            **self.bus,
            "bus_access": int(not self.waiting and (inputs["avs_s0_read"] or inputs["avs_s0_write"])),
            "bus_next_address": inputs["avs_s0_address"],
            "bus_go_live": self._go_live(inputs),
            "avs_s0_waitrequest": int(self.waiting),
            "avs_s0_readdatavalid": valid,
            "avs_s0_readdata": data,
            "irq": int(self.irq_enable and self.irq_pending),
            "picture_run": control["run"],
            "picture_reflections": min(control["reflections"], self.config.most_reflections),
            "picture_background": self.background.live,
        }

    def _go_live(self, inputs: dict[str, int]) -> int:
        return inputs["progress_take_scene" if self.config.facts.whole_frames else "progress_start_screen"]

    def clock(self, inputs: dict[str, int], events: Mapping[str, int | None] = NO_EVENTS) -> None:
        """Apply a clock edge, with the agent's inputs before it and, with lists, the events of frames."""
        if inputs["reset"]:
            self.reset()
            return
        go_live = self._go_live(inputs)
        bus, start_screen = self.bus, inputs["progress_start_screen"]
        name = self.addresses.get(bus["bus_address"], "") if bus["bus_write"] else ""
        ones = bus["bus_data"] & bus["bus_mask"]
        self.answer = (int(self.reading), self.read(inputs) if self.reading else self.answer[1])
        for register, word in (("control", self.control), ("background", self.background)):
            word.clock({**bus, "bus_go_live": go_live}, name == register)
        self.frame = (self.frame + start_screen) % (1 << 16)
        self.frames.clock(events, name, ones, bus["bus_mask"])
        self.underrun = bool(inputs.get("progress_underrun") or (self.underrun and not (name == "status" and ones & 2)))
        bad_now = bus["bus_commit"] and inputs["bad_rectangle"]
        self.bad = bool(bad_now or (self.bad and not (name == "status" and ones & 4)))
        if name == "irq_enable" and bus["bus_mask"] & 1:
            self.irq_enable = bool(ones & 1)
        self.irq_pending = bool(start_screen or (self.irq_pending and not (name == "irq_pending" and ones & 1)))
        if name == "cycles" and bus["bus_mask"]:
            self.row = self.group = 0
        elif inputs["progress_busy"] and not self.config.facts.whole_frames:
            self.row = max(self.row, inputs["progress_row_cycles"])
            self.group = max(self.group, inputs["progress_group_cycles"])
        committing = name == "control" and bool(ones & 2)
        # A commit takes effect in the cycle in which the shadow is copied, too late for a StartScreen in that cycle.
        self.commit = committing or bool(bus["bus_commit"]) or (self.commit and not go_live)
        accepted = not self.waiting
        self.waiting = False
        self.bus = bus | {"bus_commit": int(committing), "bus_write": int(accepted and inputs["avs_s0_write"])}
        self.reading = bool(accepted and inputs["avs_s0_read"])
        if accepted and (inputs["avs_s0_read"] or inputs["avs_s0_write"]):
            self.bus["bus_address"] = inputs["avs_s0_address"]
        if accepted and inputs["avs_s0_write"]:
            self.bus |= {"bus_data": inputs["avs_s0_writedata"], "bus_mask": mask_of(inputs["avs_s0_byteenable"])}


class Request(NamedTuple):
    """A transfer that the bus's master requests."""

    address: int
    """Word address."""

    word: int | None = None
    """Word to write; None for a read."""

    lanes: int = EVERY_LANE
    """Bytes to write; a read returns all bytes."""


@dataclass(frozen=True)
class LiveScene:
    """The scene that the registers give the renderer from a StartScreen on."""

    run: bool
    reflections: int
    """Number of reflections that the hardware computes."""

    background: tuple[int, ...]
    camera: tuple[int, ...]
    basis: Basis
    rectangles: Rectangles
    light: Light | None = None

    def picture(self, model: Model, screen: Screen) -> np.ndarray:
        """Draw the scene with a golden model, as `Model.picture` does."""
        return model.picture(
            screen, self.rectangles, self.camera, self.background, self.reflections, basis=self.basis, light=self.light
        )

    def frame_cycles(self, config: Configuration) -> int:
        """Return the cycles in which a design draws the scene into a list; see `raycaster.golden.frames`."""
        screen = config.screen_geometry
        model = SpanModel(
            self.rectangles, self.camera, self.background, screen.columns, self.reflections, self.light,
            patterns=config.patterns, lights=config.light,
        )  # fmt: skip
        return cycles_of(model.rows(screen, self.basis), config)


def read_live(config: Configuration, control: Word, background: Word, camera: CameraWords, table: Table) -> LiveScene:
    """Decode the live words."""
    registers = register_map(config.rectangles)
    controls = registers["control"].unpack(control.live)
    colours = registers["background"].unpack(background.live)
    return LiveScene(
        run=bool(controls["run"]),
        reflections=min(controls["reflections"], config.most_reflections),
        background=tuple(colours[colour] for colour in COLOURS),
        camera=camera.position,
        basis=camera.basis,
        light=camera.light,
        rectangles=table.rectangles("live"),
    )


COMMIT_CLOCKS = 3
"""Clocks from the one in which a committing write is accepted to the first in which StartScreen shows it."""


class SceneFollower:
    """Derives the scene that each StartScreen makes live, from nothing but the accepted writes and their clocks."""

    def __init__(self, config: Configuration):
        self._config = config
        registers = register_map(config.rectangles)
        self._control, self._background = (Word(registers[name].implemented) for name in ("control", "background"))
        self._camera, self._table = CameraWords(config), Table(config)
        kept = {"control": self._control, "background": self._background}
        self._words = {registers[name].address: word for name, word in kept.items()}
        self._words |= self._camera.by_address | self._table.words
        self._commit = registers["control"].fields["commit"].mask
        self._control_address = registers["control"].address
        self._commits: list[tuple[int, dict[int, int]]] = []
        self.live: LiveScene | None = None
        """Scene that the last StartScreen made live; None before the first."""
        self.shown: LiveScene | None = None
        """Scene of the picture from the last StartScreen on; None for black."""
        self.shows_last = False
        """The picture is that of the last commit."""
        self._lives_last = False

    @property
    def shadow(self) -> dict[int, int]:
        """The scene's words as last written, by address."""
        return {address: word.shadow for address, word in self._words.items()}

    def write(self, clock: int, address: int, data: int, lanes: int) -> None:
        """Record that a write was accepted in this clock."""
        mask = mask_of(lanes)
        if word := self._words.get(address):
            word.write(data, mask)
        if address == self._control_address and data & mask & self._commit:
            self._commits.append((clock, self.shadow))
            self._lives_last = self.shows_last = False

    def start_screen(self, clock: int, *, takes: bool = True, again: bool = False) -> None:
        """Record that StartScreen was high in this clock.

        Args:
            clock: the clock.
            takes: the pending scene goes live; always without lists of frames.
            again: with lists of frames, the last picture is shown again, as no whole one follows it.
        """
        whole_frames = self._config.facts.whole_frames
        if whole_frames and not again:
            self.shown, self.shows_last = self.live, self._lives_last
        if takes:
            self._take_scene(clock)
        if not whole_frames:
            self.shown, self.shows_last = self.live, self._lives_last

    def _take_scene(self, clock: int) -> None:
        while self._commits and self._commits[0][0] + COMMIT_CLOCKS <= clock:
            _, snapshot = self._commits.pop(0)
            self._lives_last = not self._commits
            for address, shadow in snapshot.items():
                self._words[address].pending = shadow
        for word in self._words.values():
            word.live = word.pending
        self.live = read_live(self._config, self._control, self._background, self._camera, self._table)


class RegisterFile:
    """Model of a whole design's registers, from nothing but reset and the bus; it finds StartScreen by counting clocks.

    Underrun is assumed not to happen. The renderer's measurements (`status.busy`, `cycles`) are not predicted: `busy`
    is ignored, `cycles` is checked against bounds.

    With lists of frames, the model of a frame's time says when a frame is whole, and thereby when a scene goes live. A
    list is assumed to hold its frame. `busy` and the registers `frames` are predicted.
    """

    def __init__(self, config: Configuration):
        self.config = config
        self.agent = Agent(config)
        self.table = Table(config)
        self.camera = CameraWords(config)
        screen = config.screen_geometry
        lines = screen.vertical.blank - screen.doubling
        self.start_screen_clock = lines * screen.line_cycles
        """Clocks from the end of reset to the first StartScreen."""
        self._frame_cycles = screen.frame_cycles
        self.clocks = 0
        """Clocks since the end of reset, modulo a frame."""
        self.live: LiveScene | None = None
        """Scene that the last StartScreen since reset made live."""
        self.shown: LiveScene | None = None
        """Scene of the picture from the last StartScreen since reset on; None for black."""
        self._switch = Switch()
        self._cycle = self._whole = 0
        """Clocks since reset, and the one in which the present frame is whole."""
        self._answered = ""
        self._least_cycles = (0, 0)

    @property
    def in_flight(self) -> int:
        """Number of accepted reads whose answer is not on the bus yet."""
        return int(self.agent.reading) + self.agent.answer[0]

    def clock(self, reset: bool, request: Request | None) -> bool:
        """Apply a clock edge, with reset and the bus's inputs before it.

        Returns:
            True if the request was accepted.
        """
        agent, bus = self.agent, self.agent.bus
        start_screen = int(self.clocks == self.start_screen_clock)
        switch, whole_frames = self._switch, self.config.facts.whole_frames
        take_scene = start_screen and (not whole_frames or switch.state == "wait")
        whole = switch.state == "draw" and self._cycle == self._whole
        events = switch.events(bool(start_screen), whole, False, self._cycle) if whole_frames else NO_EVENTS
        word = self.table.words.get(bus["bus_address"])
        camera_word = self.camera.by_address.get(bus["bus_address"])
        inputs = {
            **bus,
            "reset": int(reset),
            "bus_go_live": take_scene,
            "progress_start_screen": start_screen,
            "progress_take_scene": take_scene,
            "camera_readback": camera_word.shadow if camera_word else 0,
            "rect_readback": word.shadow if word else 0,
            "bad_rectangle": 0,
            "progress_busy": int(switch.state != "wait"),
            "progress_underrun": 0,
            "avs_s0_address": request.address if request else 0,
            "avs_s0_read": int(request is not None and request.word is None),
            "avs_s0_write": int(request is not None and request.word is not None),
            "avs_s0_writedata": (request.word if request else None) or 0,
            "avs_s0_byteenable": request.lanes if request else 0,
        }
        if bus["bus_commit"]:
            shadow = self.table.rectangles("shadow")
            inputs["bad_rectangle"] = int(np.any(shadow.enabled & (shadow.axes < 0)))
        if agent.reading:
            self._answered = agent.addresses.get(bus["bus_address"], "unmapped")
        if bus["bus_write"] and agent.addresses.get(bus["bus_address"]) == "cycles" and bus["bus_mask"]:
            self._least_cycles = (0, 0)
        taken = request is not None and not agent.waiting and not reset
        self.table.clock(inputs)
        for address, word in self.camera.by_address.items():
            word.clock(inputs, bus["bus_address"] == address)
        agent.clock(inputs, events)
        if reset:
            for word in self.camera.values():
                word.reset()
            self.clocks, self.live, self.shown, self._least_cycles = 0, None, None, (0, 0)
            self._cycle, self._switch = 0, Switch()
            return False
        if whole_frames:
            if switch.state == "begin" and self.live and self.live.run:
                self._whole = switch.began + self.live.frame_cycles(self.config)
            switch.clock(bool(start_screen), bool(self.live and self.live.run), self.live, whole, False, self._cycle)
            self.shown = switch.shown
        if take_scene:
            self.live = read_live(self.config, self.agent.control, self.agent.background, self.camera, self.table)
        if not whole_frames:
            self.shown = self.live
        self._cycle += 1
        self.clocks = (self.clocks + 1) % self._frame_cycles
        return taken

    def check_answer(self, word: int) -> None:
        """Compare the word on the bus with the answer that is due now.

        Raises:
            AssertionError: they differ; says which register was read.
        """
        expected, name = self.agent.answer[1], self._answered
        if name == "cycles" and not self.config.facts.whole_frames:
            cycles = self.agent.registers[name].unpack(word)
            longest = buffered_engine_of(self.config).group_cycles(self.config)
            most = (self.config.screen_geometry.row_cycles, longest)
            seen = (cycles["row"], cycles["group"])
            for least, value, bound in zip(self._least_cycles, seen, most, strict=True):
                assert least <= value <= bound, f"cycles reads {cycles}; at least {self._least_cycles}, at most {most}"
            self._least_cycles = seen
            return
        if name == "status" and not self.config.facts.whole_frames:
            word &= ~self.agent.registers[name].fields["busy"].mask
        assert word == expected, f"{name} reads {word:#010x}, expected {expected:#010x}"
