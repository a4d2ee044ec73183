# SPDX-License-Identifier: MIT
"""The registers and the scene memories: MyHDL's simulator, the converted Verilog and a model on one stimulus."""

from __future__ import annotations

import numpy as np
import pytest

from raycaster.configuration import WORLD_SIZE, Configuration, configure
from raycaster.golden.random_world import EXTREMES, random_rectangles
from raycaster.golden.world import Rectangles
from raycaster.registers import address_bits, register_map
from raycaster.rtl.avalon_interface import avalon_interface
from raycaster.rtl.camera_mem import camera_mem
from raycaster.rtl.interfaces import ParallelRects, Point, Rect, SceneBus, SequentialRects
from raycaster.rtl.rect_mem import rect_mem
from raycaster.rtl.rect_slot import rect_slot
from raycaster.rtl.rect_sorter import rect_sorter
from raycaster.rtl.scene_word import scene_word
from raycaster.rtl.widths import COLOUR_BITS, CYCLE_BITS, WORD_BITS, bit, unsigned
from raycaster.verif.leaf import Leaf, reset_signal, sorted_rect
from raycaster.verif.seeds import repeat, seed

CYCLES = 500
EVERY_BIT = (1 << WORD_BITS) - 1
MASKS = (0, 0xFF, 0xFF00, 0xFF0000, 0xFF000000, 0xFFFF, EVERY_BIT, EVERY_BIT, EVERY_BIT)
AXES = "xyz"
COLOURS = ("red", "green", "blue")


def sized(rectangles: int, **options) -> Configuration:
    return configure(rectangles=rectangles, allow_underrun=True, **options)


class Word:
    """What software writes, what waits, and what is shown."""

    def __init__(self, implemented: int):
        self.implemented = implemented
        self.reset()

    def reset(self) -> None:
        self.shadow = self.pending = self.live = 0

    def clock(self, bus: dict[str, int], selected: bool) -> None:
        if bus["bus_go_live"]:
            self.live = self.pending
        if bus["bus_commit"]:
            self.pending = self.shadow
        if bus["bus_write"] and selected:
            mask = bus["bus_mask"]
            self.shadow = (self.shadow & ~mask | bus["bus_data"] & mask) & self.implemented


class Table:
    """The rectangle table, three words a slot."""

    def __init__(self, rectangles: int):
        registers = register_map(rectangles)
        self._point, self._surface = (registers[f"rectangle[0].{name}"] for name in ("corner_0", "surface"))
        self.words = {
            registers[f"rectangle[{index}].{name}"].address: Word(registers[f"rectangle[{index}].{name}"].implemented)
            for index in range(rectangles)
            for name in ("corner_0", "corner_1", "surface")
        }
        self._rectangles = rectangles

    def slot(self, index: int) -> list[Word]:
        first = self._point.address + 4 * index
        return [self.words[first + offset] for offset in range(3)]

    def rectangles(self, stage: str) -> Rectangles:
        """What a stage, `"shadow"` or `"live"`, says."""
        corners, colours, enabled = [], [], []
        for index in range(self._rectangles):
            corner_0, corner_1, surface = (getattr(word, stage) for word in self.slot(index))
            corners.append([[self._point.unpack(corner)[axis] for axis in AXES] for corner in (corner_0, corner_1)])
            fields = self._surface.unpack(surface)
            colours.append([fields[channel] for channel in COLOURS])
            enabled.append(bool(fields["enable"]))
        return Rectangles(np.array(corners), np.array(colours, dtype=np.uint8), np.array(enabled))

    def clock(self, inputs: dict[str, int]) -> None:
        for address, word in self.words.items():
            if inputs["reset"]:
                word.reset()
            else:
                word.clock(inputs, inputs["bus_address"] == address)


def bits_of(flags) -> int:
    return sum(int(flag) << index for index, flag in enumerate(flags))


def random_bus(random: np.random.Generator, addresses: list[int], data: int | None = None) -> dict[str, int]:
    return {
        "bus_write": int(random.random() < 0.7),
        "bus_commit": int(random.random() < 0.15),
        "bus_go_live": int(random.random() < 0.15),
        "bus_address": int(random.choice(addresses)),
        "bus_data": int(random.choice([0, EVERY_BIT, random.integers(1 << WORD_BITS)]) if data is None else data),
        "bus_mask": int(random.choice(MASKS)),
    }


@pytest.mark.parametrize("implemented", [EVERY_BIT, 0x1FF7FDFF, 0x80FFFFFF, 1, 0])
def test_scene_word(implemented, tmp_path):
    leaf = Leaf(
        scene_word,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(7),
            "selected": bit(),
            "implemented": unsigned(WORD_BITS),
            "shadow": unsigned(WORD_BITS),
            "live": unsigned(WORD_BITS),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = []
    for cycle in range(CYCLES):
        inputs = random_bus(random, [0]) | {"reset": int(cycle == 0 or random.random() < 0.01)}
        del inputs["bus_address"]
        stimulus.append(inputs | {"implemented": implemented, "selected": int(random.random() < 0.8)})
    outputs = leaf.run_both(stimulus, settled=1)
    model = Word(implemented)
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            assert output == {"shadow": model.shadow, "live": model.live}, (cycle, repeat())
        if inputs["reset"]:
            model.reset()
        else:
            model.clock(inputs, bool(inputs["selected"]))


def test_camera_mem(tmp_path):
    leaf = Leaf(
        camera_mem,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(address_bits(12)),
            "read_word": unsigned(WORD_BITS),
            "camera": Point(),
        },
        tmp_path,
    )
    camera = register_map(12)["camera"]
    random = np.random.default_rng(seed())
    neighbours = [camera.address ^ 1 << place for place in range(address_bits(12))]
    stimulus = []
    for cycle in range(CYCLES):
        position = {axis: int(random.choice([*EXTREMES, random.integers(WORLD_SIZE)])) for axis in AXES}
        data = camera.pack(**position) if random.random() < 0.5 else None
        bus = random_bus(random, [camera.address] * 10 + neighbours, data)
        stimulus.append({**bus, "reset": int(cycle == 0 or random.random() < 0.01)})
    outputs = leaf.run_both(stimulus, settled=1)
    model = Word(camera.implemented)
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            position = {f"camera_{axis}": value for axis, value in camera.unpack(model.live).items()}
            assert output == {"read_word": model.shadow, **position}, (cycle, repeat())
        if inputs["reset"]:
            model.reset()
        else:
            model.clock(inputs, inputs["bus_address"] == camera.address)


def rectangle_words(random: np.random.Generator) -> tuple[Rectangles, list[tuple[int, int, int]]]:
    """Rectangles, some of them none, and their words with something in the bits that do not exist."""
    registers = register_map(1)
    point, surface = registers["rectangle[0].corner_0"], registers["rectangle[0].surface"]
    table = random_rectangles(random, 12)
    words = []
    for corners, colour, enabled in zip(table.corners, table.colours, table.enabled, strict=True):
        first, second = (
            point.pack(**dict(zip(AXES, map(int, corner), strict=True)))
            | int(random.integers(1 << WORD_BITS)) & ~point.implemented
            for corner in corners
        )
        channels = dict(zip(COLOURS, map(int, colour), strict=True))
        words.append((first, second, surface.pack(enable=int(enabled), **channels)))
    return table, words


def test_rect_sorter(tmp_path):
    leaf = Leaf(
        rect_sorter,
        lambda: {
            "corner_0": unsigned(WORD_BITS),
            "corner_1": unsigned(WORD_BITS),
            "surface": unsigned(WORD_BITS),
            "rect": Rect(),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    for _ in range(150):
        table, words = rectangle_words(random)
        for index, (first, second, surface) in enumerate(words):
            if table.axes[index] >= 0:
                stimulus.append({"corner_0": first, "corner_1": second, "surface": surface})
                expected.append(sorted_rect(table, index, "rect"))
    outputs = leaf.run_both(stimulus)
    assert {rect["rect_axis"] for rect in expected} == {0, 1, 2}
    for inputs, output, rect in zip(stimulus, outputs, expected, strict=True):
        assert output == rect, (inputs, repeat())


def table_stimulus(random: np.random.Generator, table: Table, rectangles: int) -> list[dict[str, int]]:
    """Rectangles written one after the other, in part too, at random and to neighbouring addresses."""
    stimulus = [{**random_bus(random, [0]), "reset": 1}] * 2
    last = 1 << address_bits(rectangles)
    written = list(table.words)
    # Many rectangles take their time.
    while len(stimulus) < (CYCLES if rectangles < 20 else CYCLES // 2):
        _, words = rectangle_words(random)
        slot = int(random.integers(rectangles))
        data = words[int(random.integers(len(words)))]
        for address, word in zip(written[3 * slot : 3 * slot + 3], data, strict=True):
            bus = random_bus(random, [address] * 8 + [address ^ 1, int(random.integers(last))], word)
            stimulus.append({**bus, "reset": int(random.random() < 0.003)})
        stimulus.append({**random_bus(random, [int(random.integers(last))]), "reset": 0})
    return stimulus


@pytest.mark.parametrize("number", [0, 3])
def test_rect_slot(number, tmp_path):
    rectangles = number + 1
    names = ("corner_0", "corner_1", "surface")
    table = Table(rectangles)
    width = address_bits(rectangles)
    leaf = Leaf(
        rect_slot,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(width),
            "number": unsigned(width - 2),
            **{stage + name: unsigned(WORD_BITS) for stage in ("", "live_") for name in names},
            "usable": bit(),
            "bad": bit(),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    place = list(table.words)[3 * number] // 4
    stimulus = [{**cycle, "number": place} for cycle in table_stimulus(random, table, rectangles)]
    outputs = leaf.run_both(stimulus, settled=2)
    usable = False
    seen = set()
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        live, shadow = table.rectangles("live"), table.rectangles("shadow")
        bad = shadow.enabled[number] and shadow.axes[number] < 0
        if cycle >= 2:
            expected = {"usable": int(usable), "bad": int(bad)}
            for name, word in zip(names, table.slot(number), strict=True):
                expected |= {name: word.shadow, f"live_{name}": word.live}
            assert output == expected, (cycle, repeat())
            seen.add((bool(usable), bool(bad)))
        usable = live.visible[number]
        table.clock(inputs)
    assert len(seen) == 4


@pytest.mark.parametrize("view", [SequentialRects, ParallelRects])
@pytest.mark.parametrize("rectangles", [1, 2, 3, 12, 32])
def test_rect_mem(rectangles, view, tmp_path):
    config = sized(rectangles)
    leaf = Leaf(
        rect_mem,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(address_bits(rectangles)),
            "read_word": unsigned(WORD_BITS),
            "bad_rectangle": bit(),
            "rects": view(config),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    table = Table(rectangles)
    stimulus = table_stimulus(random, table, rectangles)
    sequential = view is SequentialRects
    if sequential:
        for cycle, inputs in enumerate(stimulus):
            stimulus[cycle] = inputs | {
                "rects_fetch": int(cycle < 3 or random.random() < 0.6),
                "rects_index": int(random.integers(rectangles)),
            }
    outputs = leaf.run_both(stimulus, settled=3)
    usable, presented, presentable = 0, {}, False
    checked = 0
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        live, shadow = table.rectangles("live"), table.rectangles("shadow")
        if cycle >= 3:
            word = table.words.get(inputs["bus_address"])
            expected = {
                "read_word": word.shadow if word else 0,
                "bad_rectangle": int(np.any(shadow.enabled & (shadow.axes < 0))),
                "rects_usable": usable,
            }
            if not sequential:
                for number, name in enumerate(("corner_0", "corner_1", "surface")):
                    words = [table.slot(index)[number].live for index in range(rectangles)]
                    expected[f"rects_{name}"] = sum(word << WORD_BITS * i for i, word in enumerate(words))
            elif presentable:
                checked += 1
                expected |= presented
            assert {name: output[name] for name in expected} == expected, (cycle, repeat())
        if sequential and inputs["rects_fetch"]:
            presentable = live.axes[inputs["rects_index"]] >= 0
            presented = sorted_rect(live, inputs["rects_index"], "rects_rect") if presentable else {}
        usable = bits_of(live.visible)
        table.clock(inputs)
    assert checked > 50 or not sequential


# avalon_interface ----------------------------------------------------------------------------------------------------


class Agent:
    """The agent's contract: a write is known a cycle after it was accepted, a read answered two cycles after it was."""

    def __init__(self, config: Configuration):
        self.config = config
        registers = register_map(config.rectangles)
        self.registers = registers
        self.addresses = {register.address: name for name, register in registers.items()}
        self.control = Word(registers["control"].implemented & ~registers["control"].fields["commit"].mask)
        self.background = Word(registers["background"].implemented)
        self.reset()

    def reset(self) -> None:
        self.control.reset()
        self.background.reset()
        self.waiting = True
        self.bus = {"bus_write": 0, "bus_commit": 0, "bus_address": 0, "bus_data": 0, "bus_mask": 0}
        self.reading = False
        self.answer = (0, 0)
        self.commit = False
        self.frame = self.row = self.group = 0
        self.underrun = self.bad = self.irq_enable = self.irq_pending = False

    def read(self, inputs: dict[str, int]) -> int:
        """The word at the bus's address in this cycle."""
        config = self.config
        name = self.addresses.get(self.bus["bus_address"], "")
        fields = {
            "id": {"magic": int.from_bytes(b"RAYC")},
            "version": {field: value.reset for field, value in self.registers["version"].fields.items()},
            "engine": {
                "engine": 0,
                "fraction_bits": config.fraction_bits,
                "nearest": int(config.rounding == "nearest"),
                "divider_bits": config.divider_bits,
                "reflections": config.reflections,
                "scale": 1,
                "colour_bits": config.colour_bits,
            },
            "size": {
                "units": config.units, "rectangles": config.rectangles, "rows": config.screen_geometry.rows,
            },
            "status": {
                "busy": inputs["busy"], "underrun": self.underrun, "bad_rectangle": self.bad, "frame": self.frame,
            },
            "cycles": {"row": self.row, "group": self.group},
            "irq_enable": {"start_screen": self.irq_enable},
            "irq_pending": {"start_screen": self.irq_pending},
        }  # fmt: skip
        if name in fields:
            return self.registers[name].pack(**{field: int(value) for field, value in fields[name].items()})
        if name == "control":
            return self.control.shadow | self.registers["control"].pack(commit=int(self.commit))
        return {"background": self.background.shadow, "camera": inputs["camera_word"]}.get(name, inputs["rect_word"])

    def outputs(self, inputs: dict[str, int]) -> dict[str, int]:
        control = self.registers["control"].unpack(self.control.live)
        valid, data = self.answer
        return {
            **self.bus,
            "bus_go_live": inputs["start_screen"],
            "avs_s0_waitrequest": int(self.waiting),
            "avs_s0_readdatavalid": valid,
            "avs_s0_readdata": data,
            "irq": int(self.irq_enable and self.irq_pending),
            "run": control["run"],
            "reflections": min(control["reflections"], self.config.reflections),
            "background": self.background.live,
        }

    def clock(self, inputs: dict[str, int]) -> None:
        if inputs["reset"]:
            self.reset()
            return
        bus, start_screen = self.bus, inputs["start_screen"]
        name = self.addresses.get(bus["bus_address"], "") if bus["bus_write"] else ""
        ones = bus["bus_data"] & bus["bus_mask"]
        self.answer = (int(self.reading), self.read(inputs) if self.reading else self.answer[1])
        for register, word in (("control", self.control), ("background", self.background)):
            word.clock({**bus, "bus_go_live": start_screen}, name == register)
        self.frame = (self.frame + start_screen) % (1 << 16)
        self.underrun = bool(inputs["underrun"] or (self.underrun and not (name == "status" and ones & 2)))
        bad_now = bus["bus_commit"] and inputs["bad_rectangle"]
        self.bad = bool(bad_now or (self.bad and not (name == "status" and ones & 4)))
        if name == "irq_enable" and bus["bus_mask"] & 1:
            self.irq_enable = bool(ones & 1)
        self.irq_pending = bool(start_screen or (self.irq_pending and not (name == "irq_pending" and ones & 1)))
        if name == "cycles" and bus["bus_mask"]:
            self.row = self.group = 0
        elif inputs["busy"]:
            self.row, self.group = max(self.row, inputs["row_cycles"]), max(self.group, inputs["group_cycles"])
        committing = name == "control" and bool(ones & 2)
        # A commit counts from the cycle in which the shadow is copied; a StartScreen in that cycle is too early for it.
        self.commit = committing or bool(bus["bus_commit"]) or (self.commit and not start_screen)
        accepted = not self.waiting
        self.waiting = False
        self.bus = {
            **bus,
            "bus_commit": int(committing),
            "bus_write": int(accepted and inputs["avs_s0_write"]),
        }
        self.reading = bool(accepted and inputs["avs_s0_read"])
        if accepted and (inputs["avs_s0_read"] or inputs["avs_s0_write"]):
            self.bus["bus_address"] = inputs["avs_s0_address"]
        if accepted and inputs["avs_s0_write"]:
            lanes = [0xFF << 8 * lane for lane in range(4) if inputs["avs_s0_byteenable"] >> lane & 1]
            self.bus |= {"bus_data": inputs["avs_s0_writedata"], "bus_mask": sum(lanes)}


@pytest.mark.parametrize(
    "config",
    [
        sized(12),
        sized(1, reflections=0, fraction_bits=8, rounding="nearest", divider_bits=3, colour_bits=4),
        sized(32, reflections=2, units=320, rows=200),
    ],
    ids=lambda config: config.name,
)
def test_avalon_interface(config, tmp_path):
    width = address_bits(config.rectangles)
    leaf = Leaf(
        avalon_interface,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "avs_s0_address": unsigned(width),
            "avs_s0_read": bit(),
            "avs_s0_write": bit(),
            "avs_s0_writedata": unsigned(WORD_BITS),
            "avs_s0_byteenable": unsigned(4),
            "avs_s0_readdata": unsigned(WORD_BITS),
            "avs_s0_readdatavalid": bit(),
            "avs_s0_waitrequest": bit(),
            "irq": bit(),
            "bus": SceneBus(width),
            "camera_word": unsigned(WORD_BITS),
            "rect_word": unsigned(WORD_BITS),
            "bad_rectangle": bit(),
            "run": bit(),
            "reflections": unsigned(2),
            "background": unsigned(COLOUR_BITS),
            "start_screen": bit(),
            "busy": bit(),
            "underrun": bit(),
            "row_cycles": unsigned(CYCLE_BITS),
            "group_cycles": unsigned(CYCLE_BITS),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    agent = Agent(config)
    registers = [register.address for name, register in agent.registers.items() if "rectangle" not in name]
    control = agent.registers["control"]
    stimulus = []
    for cycle in range(4000):
        address = int(random.choice([*registers, control.address, int(random.integers(1 << width))]))
        # Ones and zeros in what is cleared by ones, and often a commit.
        data = int(random.choice([0, 1, 2, 4, 6, 0x303, 0x102, EVERY_BIT, random.integers(1 << WORD_BITS)]))
        transfer = random.choice(["read", "write", "none"], p=[0.4, 0.4, 0.2])
        stimulus.append(
            {
                "reset": int(cycle < 2 or random.random() < 0.003),
                "avs_s0_address": address,
                "avs_s0_read": int(transfer == "read"),
                "avs_s0_write": int(transfer == "write"),
                "avs_s0_writedata": data,
                "avs_s0_byteenable": int(random.choice([0, 1, 2, 4, 8, 15, 15, 15])),
                "camera_word": int(random.integers(1 << WORD_BITS)),
                "rect_word": int(random.integers(1 << WORD_BITS)),
                "bad_rectangle": int(random.random() < 0.3),
                "start_screen": int(random.random() < 0.05),
                "busy": int(random.integers(2)),
                "underrun": int(random.random() < 0.05),
                "row_cycles": int(random.choice([0, 1, random.integers(1 << CYCLE_BITS), (1 << CYCLE_BITS) - 1])),
                "group_cycles": int(random.integers(1 << int(random.integers(1, CYCLE_BITS + 1)))),
            }
        )
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            assert output == agent.outputs(inputs), (cycle, repeat())
        agent.clock(inputs)
