# SPDX-License-Identifier: MIT
"""The registers and the scene memories: MyHDL's simulator, the converted Verilog and a model on one stimulus."""

from __future__ import annotations

import numpy as np
import pytest
from myhdl import Signal, intbv

from raycaster.configuration import WORLD_SIZE, Configuration, configure
from raycaster.golden.random_world import EXTREMES, random_looks, random_rectangles
from raycaster.golden.world import Rectangles
from raycaster.registers import address_bits, register_map
from raycaster.rtl.bus.avalon_interface import avalon_interface
from raycaster.rtl.common.interfaces import AvalonPort, Picture, Progress, Rects, SceneBus
from raycaster.rtl.common.records import camera_of, rect_of
from raycaster.rtl.common.widths import CYCLE_BITS, WORD_BITS, bit, unsigned
from raycaster.rtl.scene.camera_mem import camera_mem
from raycaster.rtl.scene.rect_mem import rect_mem
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.rtl.scene.written_rect import PLACE_BITS, PLACES, Copies, written_of
from raycaster.scene import UNTURNED
from raycaster.sim.register_model import AXES, COLOURS, Agent, CameraWords, Table, Word
from raycaster.verif.leaf import Leaf, reset_signal, sorted_rect
from raycaster.verif.seeds import repeat, seed

CYCLES = 500
LOOKS = [
    {"engine": "exact"}, {"engine": "exact", "materials": True}, {"engine": "beam", "patterns": True},
    {"engine": "exact", "materials": True, "patterns": True},
]  # fmt: skip


def label(options) -> str:
    """A design's options as a test's name has them."""
    return "-".join([options["engine"], *(name for name in options if name != "engine")])


looks = pytest.mark.parametrize("options", LOOKS, ids=label)
EVERY_BIT = (1 << WORD_BITS) - 1
MASKS = (0, 0xFF, 0xFF00, 0xFF0000, 0xFF000000, 0xFFFF, EVERY_BIT, EVERY_BIT, EVERY_BIT)


def sized(rectangles: int, **options) -> Configuration:
    return configure(rectangles=rectangles, allow_underrun=True, **options)


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


@pytest.mark.parametrize(
    ("implemented", "first"), [(EVERY_BIT, 0), (0x1FF7FDFF, 0), (0x3FFFFFFF, 256), (1, 0), (0, 0), ("any", 3 << 10)]
)
def test_scene_word(implemented, first, tmp_path):
    leaf = Leaf(
        scene_word,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(7),
            "selected": bit(),
            "implemented": unsigned(WORD_BITS),
            "shadow": Signal(intbv(first)[WORD_BITS:]),
            "live": Signal(intbv(first)[WORD_BITS:]),
            "first": first,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = []
    for cycle in range(CYCLES):
        inputs = random_bus(random, [0]) | {"reset": int(cycle == 0 or random.random() < 0.05)}
        del inputs["bus_address"]
        # A module has no constants: whatever this input says when a word is written counts.
        bits = int(random.integers(1 << WORD_BITS)) if implemented == "any" else implemented
        stimulus.append(inputs | {"implemented": bits, "selected": int(random.random() < 0.8)})
    outputs = leaf.run_both(stimulus, settled=1)
    model = Word(0, first)
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            assert output == {"shadow": model.shadow, "live": model.live}, (cycle, repeat())
        model.implemented = inputs["implemented"]
        if inputs["reset"]:
            model.reset()
        else:
            model.clock(inputs, bool(inputs["selected"]))


@pytest.mark.parametrize("turn", [False, True])
def test_camera_mem(turn, tmp_path):
    config = sized(12, engine="exact", turn=turn)
    leaf = Leaf(
        camera_mem,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(address_bits(12)),
            "readback": unsigned(WORD_BITS),
            "camera": camera_of(config),
            "config": config,
        },
        tmp_path,
    )
    addresses = [register_map(12)[name].address for name in ("camera", "forward", "right", "up")]
    position = register_map(12)["camera"]
    random = np.random.default_rng(seed())
    neighbours = [address ^ 1 << place for address in addresses for place in range(address_bits(12))]
    stimulus = []
    for cycle in range(3 * CYCLES):
        place = {axis: int(random.choice([*EXTREMES, random.integers(WORLD_SIZE)])) for axis in AXES}
        data = position.pack(**place) if random.random() < 0.5 else None
        bus = random_bus(random, addresses * 10 + neighbours, data)
        stimulus.append({**bus, "reset": int(cycle == 0 or random.random() < 0.01)})
    outputs = leaf.run_both(stimulus, settled=1)
    model = CameraWords(config)
    bases = set()
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            expected = {f"camera_{axis}": value for axis, value in zip(AXES, model.position, strict=True)}
            if word := model.by_address.get(inputs["bus_address"]):
                expected["readback"] = word.shadow
            if turn:
                for name, vector in zip(("forward", "right", "up"), model.basis, strict=True):
                    # A negative component is its bits.
                    expected |= {f"camera_{name}_{axis}": part % 1024 for axis, part in zip(AXES, vector, strict=True)}
            assert {name: output[name] for name in expected} == expected, (cycle, repeat())
            assert set(output) == {*expected, "readback"}
            bases.add(model.basis)
        for address, word in model.by_address.items():
            if inputs["reset"]:
                word.reset()
            else:
                word.clock(inputs, inputs["bus_address"] == address)
    assert UNTURNED in bases
    assert (len(bases) > 50) == turn


def rectangle_words(random: np.random.Generator) -> tuple[Rectangles, list[tuple[int, ...]]]:
    """Rectangles, some of them none, and their words with something in the bits that do not exist."""
    registers = register_map(1)
    point, surface, pattern = (registers[f"rectangle[0].{name}"] for name in ("corner_0", "surface", "pattern"))
    table = random_looks(random, random_rectangles(random, 12))
    words = []
    for index, corners in enumerate(table.corners):
        first, second = (
            point.pack(**dict(zip(AXES, map(int, corner), strict=True)))
            | int(random.integers(1 << WORD_BITS)) & ~point.implemented
            for corner in corners
        )
        channels, channels_2 = (
            dict(zip(COLOURS, map(int, colours[index]), strict=True)) for colours in (table.colours, table.colours_2)
        )
        # 4 and all that is more are the same.
        mirror = int(random.integers(4, 8) if table.mirrors[index] == 4 else table.mirrors[index])
        cell = int(table.cells[index]).bit_length() - 4
        words.append(
            (
                first,
                second,
                surface.pack(enable=int(table.enabled[index]), mirror=mirror, **channels),
                pattern.pack(kind=int(table.kinds[index]), cell=cell, **channels_2),
            )
        )
    return table, words


def almost_flat(random: np.random.Generator) -> tuple[int, ...]:
    """The words of an enabled rectangle whose corners differ by one bit in each coordinate, or in none of an axis."""
    first = int(random.integers(1 << WORD_BITS))
    second = first ^ int(random.integers(1 << WORD_BITS)) & ~register_map(1)["rectangle[0].corner_0"].implemented
    for field in register_map(1)["rectangle[0].corner_0"].fields.values():
        if random.random() < 0.75:
            second ^= 1 << field.lsb + int(random.integers(field.width))
    surface = int(random.integers(1 << 27)) | register_map(1)["rectangle[0].surface"].pack(enable=1)
    return first, second, surface, int(random.integers(1 << WORD_BITS))


@looks
def test_rect_sorter(options, tmp_path):
    config = sized(1, **options)
    leaf = Leaf(
        rect_sorter,
        lambda: {"written": written_of(config), "rect": rect_of(config), "config": config},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, expected = [], []
    for _ in range(150):
        table, words = rectangle_words(random)
        for index, written in enumerate(words):
            if table.axes[index] >= 0:
                names = Table(config).names
                stimulus.append({f"written_{name}": word for name, word in zip(names, written, strict=False)})
                expected.append(sorted_rect(table, index, "rect", config))
                if config.patterns and random.random() < 0.2:
                    # A cell as large as the world, and one that is larger, have no pattern.
                    size = int(random.integers(6, 8))
                    cell = register_map(1)["rectangle[0].pattern"].fields["cell"]
                    others = written[-1] & ~((1 << cell.width) - 1 << cell.lsb)
                    stimulus[-1][f"written_{names[3]}"] = others | size << cell.lsb
                    expected[-1] |= {"rect_kind": 0, "rect_cell": size}
    outputs = leaf.run_both(stimulus)
    assert {rect["rect_axis"] for rect in expected} == {0, 1, 2}
    for inputs, output, rect in zip(stimulus, outputs, expected, strict=True):
        assert output == rect, (inputs, repeat())


def table_stimulus(random: np.random.Generator, table: Table, rectangles: int) -> list[dict[str, int]]:
    """Rectangles written one after the other, in part too, at random and to neighbouring addresses; others whole, then
    read, and shown; others whole, again and again, with commits and frames in between."""
    stimulus = [{**random_bus(random, [0]), "reset": 1}] * 2
    last = 1 << address_bits(rectangles)
    written = list(table.words)
    # Many rectangles take their time.
    while len(stimulus) < (CYCLES * 5 if rectangles <= 4 else CYCLES):
        _, words = rectangle_words(random)
        slot, size = int(random.integers(rectangles)), len(table.names)
        data = words[int(random.integers(len(words)))]
        addresses = written[size * slot : size * (slot + 1)]
        idle = {"bus_write": 0, "bus_commit": 0, "bus_go_live": 0, "bus_mask": EVERY_BIT, "reset": 0}
        if random.random() < 0.25:
            # The shadow's, the pending and the live rectangle are each in one of three places.
            for _, data in zip(range(8), words, strict=False):
                for address, word in zip(addresses, data, strict=False):
                    stimulus.append({**idle, "bus_write": 1, "bus_address": address, "bus_data": word})
                stimulus += [{**idle, "bus_address": addresses[0], "bus_data": 0}] * 2
                show = {name: int(random.random() < 0.5) for name in ("bus_commit", "bus_go_live")}
                stimulus.append({**stimulus[-1], **show, "reset": int(random.random() < 0.05)})
            continue
        if random.random() < 0.5:
            if random.random() < 0.8:
                data = almost_flat(random)
            for address, word in zip(addresses, data, strict=False):
                stimulus.append({**idle, "bus_write": 1, "bus_address": address, "bus_data": word})
            stimulus += [{**idle, "bus_address": address, "bus_data": 0} for address in addresses]
            stimulus[-2]["bus_commit"] = stimulus[-1]["bus_go_live"] = 1
            continue
        for address, word in zip(written[size * slot : size * (slot + 1)], data, strict=False):
            bus = random_bus(random, [address] * 8 + [address ^ 1, int(random.integers(last))], word)
            stimulus.append({**bus, "reset": int(random.random() < 0.01)})
        stimulus.append({**random_bus(random, [int(random.integers(last))]), "reset": 0})
    return stimulus


@pytest.mark.parametrize("number", [0, 3])
def test_rect_slot(number, tmp_path):
    leaf = Leaf(
        rect_slot,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(7),
            "storing": bit(),
            "index": unsigned(2),
            "number": unsigned(2),
            "place": unsigned(PLACE_BITS),
            "enable": bit(),
            "flat": bit(),
            "copies": Copies(),
            "usable": bit(),
            "bad": bit(),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [
        {
            "reset": int(cycle == 0 or random.random() < 0.05),
            "bus_commit": int(random.random() < 0.3),
            "bus_go_live": int(random.random() < 0.3),
            "storing": int(random.random() < 0.4),
            "index": int(random.choice([number, random.integers(4)])),
            "number": number,
            "place": int(random.integers(PLACES)),
            "enable": int(random.integers(2)),
            "flat": int(random.integers(2)),
        }
        for cycle in range(2 * CYCLES)
    ]
    outputs = leaf.run_both(stimulus, settled=1)
    # Of each copy its place, and in the bit above whether it is usable.
    usable_bit = 1 << PLACE_BITS
    model, bad = Word(EVERY_BIT), False
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            expected = {
                f"copies_{stage}": getattr(model, stage) % usable_bit for stage in ("shadow", "pending", "live")
            }
            expected |= {"usable": model.live >= usable_bit, "bad": bad}
            assert output == expected, (cycle, repeat())
        if inputs["reset"]:
            model.reset()
            bad = False
            continue
        storing = bool(inputs["storing"] and inputs["index"] == number)
        good = usable_bit if inputs["enable"] and inputs["flat"] else 0
        model.clock({**inputs, "bus_write": 1, "bus_data": inputs["place"] | good, "bus_mask": EVERY_BIT}, storing)
        if storing:
            bad = bool(inputs["enable"] and not inputs["flat"])


def fill_places(random: np.random.Generator, table: Table) -> list[dict[str, int]]:
    """A reset, and writes that reach all places of all slots, so that a memory which starts unknown is known."""
    idle = random_bus(random, [0]) | {"bus_write": 0, "bus_commit": 0, "bus_go_live": 0, "reset": 0}
    writes = [
        {**idle, "bus_write": 1, "bus_address": address, "bus_data": int(random.integers(1 << WORD_BITS))}
        for address in table.words
    ]
    commit, go_live = {**idle, "bus_commit": 1}, {**idle, "bus_go_live": 1}
    return [{**idle, "reset": 1}, *writes, idle, commit, *writes, idle, commit, go_live, *writes, idle, idle, idle]


@pytest.mark.slow_sets("2", "3-", "32")
@pytest.mark.parametrize(
    ("rectangles", "options"),
    [
        *((rectangles, {"engine": engine}) for rectangles in (1, 2, 3, 12, 32) for engine in ("seed", "beam")),
        (3, {"engine": "beam", "materials": True}), (2, {"engine": "exact", "patterns": True}),
        (3, {"engine": "seed", "materials": True, "patterns": True}),
    ],
    ids=lambda value: label(value) if isinstance(value, dict) else str(value),
)  # fmt: skip
def test_rect_mem(rectangles, options, tmp_path):
    config = sized(rectangles, **options)
    latency = config.facts.rect_latency
    leaf = Leaf(
        rect_mem,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(address_bits(rectangles)),
            "readback": unsigned(WORD_BITS),
            "bad_rectangle": bit(),
            "rects": Rects(config),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    table = Table(config)
    filling = fill_places(random, table)
    stimulus = filling + table_stimulus(random, table, rectangles)
    for cycle, inputs in enumerate(stimulus):
        stimulus[cycle] = inputs | {
            "rects_fetch": int(cycle < len(filling) or random.random() < 0.6),
            "rects_index": int(random.integers(rectangles)),
        }
        # A commit is asked for by a write of another word in the cycle before it.
        if inputs["bus_commit"] and cycle:
            stimulus[cycle - 1]["bus_write"] = 0
    outputs = leaf.run_both(stimulus, settled=len(filling))
    # What was asked for, and what is at the port; with a latency of two it is in between for a cycle.
    presented, on_the_way = None, None
    checked, bad = 0, False
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        live, shadow = table.rectangles("live"), table.rectangles("shadow")
        if cycle >= len(filling):
            word = table.words.get(inputs["bus_address"])
            expected = {
                "readback": word.shadow if word else 0,
                "bad_rectangle": int(bad),
                "rects_usable": bits_of(live.visible),
            }
            if presented is not None:
                checked += 1
                expected |= presented
            assert {name: output[name] for name in expected} == expected, (cycle, repeat())
        if latency == 2:
            presented = on_the_way
        if inputs["rects_fetch"]:
            presentable = live.visible[inputs["rects_index"]]
            on_the_way = sorted_rect(live, inputs["rects_index"], "rects_rect", config) if presentable else None
        if latency == 1:
            presented = on_the_way
        # It is known a cycle after the shadow.
        bad = bool(np.any(shadow.enabled & (shadow.axes < 0))) and not inputs["reset"]
        table.clock(inputs)
    assert checked > 50


# avalon_interface ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "config",
    [
        sized(12),
        sized(1, reflections=0, fraction_bits=8, rounding="nearest", divider_bits=3, colour_bits=4),
        sized(32, reflections=2, units=320, rows=200),
        sized(2, engine="exact", turn=True, patterns=True),
        sized(2, engine="beam", materials=True),
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
            "avs_s0": AvalonPort(width),
            "irq": bit(),
            "bus": SceneBus(width),
            "camera_readback": unsigned(WORD_BITS),
            "rect_readback": unsigned(WORD_BITS),
            "bad_rectangle": bit(),
            "picture": Picture(),
            "progress": Progress(),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    agent = Agent(config)
    registers = [register.address for name, register in agent.registers.items() if "rectangle" not in name]
    control = agent.registers["control"]
    stimulus = []
    row = group = 0
    committing = False
    for cycle in range(7500):
        # Now and then what stands a little above, or below, what stood.
        row, group = (max(0, value + int(random.integers(-9, 10))) % (1 << CYCLE_BITS) for value in (row, group))
        if random.random() < 0.05:
            row = int(random.choice([0, 1, random.integers(1 << CYCLE_BITS), (1 << CYCLE_BITS) - 1]))
            group = int(random.integers(1 << int(random.integers(1, CYCLE_BITS + 1))))
        # Then so many frames without a reset that the counter's upper bits change.
        busy_bus = cycle < 3000
        address = int(random.choice([*registers, control.address, int(random.integers(1 << width))]))
        # Ones and zeros in what is cleared by ones, and often a commit.
        data = int(random.choice([0, 1, 2, 4, 6, 0x303, 0x102, EVERY_BIT, random.integers(1 << WORD_BITS)]))
        transfer = random.choice(["read", "write", "none"], p=[0.4, 0.4, 0.2])
        # Often while a commit is on its way.
        reset = random.random() < (0.1 if committing else 0.003)
        committing = transfer == "write" and address == control.address
        stimulus.append(
            {
                "reset": int(cycle < 2 or (busy_bus and reset)),
                "avs_s0_address": address,
                "avs_s0_read": int(transfer == "read"),
                "avs_s0_write": int(transfer == "write"),
                "avs_s0_writedata": data,
                "avs_s0_byteenable": int(random.choice([0, 1, 2, 4, 8, 15, 15, 15])),
                "camera_readback": int(random.integers(1 << WORD_BITS)),
                "rect_readback": int(random.integers(1 << WORD_BITS)),
                "bad_rectangle": int(random.random() < 0.3),
                "progress_start_screen": int(random.random() < (0.05 if busy_bus else 0.95)),
                "progress_busy": int(random.integers(2)),
                "progress_underrun": int(random.random() < 0.05),
                "progress_row_cycles": row,
                "progress_group_cycles": group,
            }
        )
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            assert output["avs_s0_waitrequest"] == stimulus[cycle - 1]["reset"], (cycle, repeat())
            assert output == agent.outputs(inputs), (cycle, repeat())
        agent.clock(inputs)
