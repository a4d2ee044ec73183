# SPDX-License-Identifier: MIT
"""Leaf tests of the words and tables of a scene."""

import dataclasses
import re

import pytest
from myhdl import Signal, intbv
from scene_vectors import CYCLES, EVERY_BIT, fixed_config, label, random_bus, rectangle_words, sized
from vectors import Bench, basis_inputs, by, by_axis, named

from raycaster.configuration import WORLD_SIZE
from raycaster.fixed import FixedRectangle, varying_bits
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.camera_mem import camera_mem
from raycaster.rtl.scene.rect_rom import rect_rom
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.rtl.scene.written_rect import BANK_BITS, BANKS, Copies, WrittenRect
from raycaster.runs.tools import run_yosys
from raycaster.scene import UNTURNED
from raycaster.sim.register_model import AXES, CameraWords, Table, Word
from raycaster.verif.expected import sorted_rect
from raycaster.verif.random_world import EXTREMES
from raycaster.verif.seeds import repeat


@pytest.mark.parametrize(
    ("implemented", "first"), [(EVERY_BIT, 0), (0x1FF7FDFF, 0), (0x3FFFFFFF, 256), (1, 0), (0, 0), ("any", 3 << 10)]
)
def test_scene_word(implemented, first, leaf_of, random):
    """Writes to some byte lanes, commits and frames; the shadow and the live word after each."""
    words = dict.fromkeys(("shadow", "live"), lambda: Signal(intbv(first)[WORD_BITS:]))
    leaf = leaf_of(scene_word, bus=lambda: SceneBus(7), implemented=WORD_BITS, **words, first=first)
    model = Word(0, first)
    for cycle in range(CYCLES):
        inputs = random_bus(random, [0]) | {"reset": int(cycle == 0 or random.random() < 0.05)}
        del inputs["bus_address"]
        # In a separate module this input is no constant: its value at each write counts.
        bits = int(random.integers(1 << WORD_BITS)) if implemented == "any" else implemented
        inputs |= {"implemented": bits, "selected": int(random.random() < 0.8)}
        leaf.case(inputs, {"shadow": model.shadow, "live": model.live})
        model.implemented = bits
        if inputs["reset"]:
            model.reset()
        else:
            model.clock(inputs, bool(inputs["selected"]))
    leaf.check(settled=1)


@pytest.mark.parametrize("light", [False, True], ids=["no light", "light"])
@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
def test_camera_mem(turn, light, leaf_of, random):
    """The position, the basis and the light, after writes to their words and to neighbouring addresses."""
    config = sized(12, engine="exact", turn=turn, light=light)
    leaf = leaf_of(camera_mem, config)
    registers = register_map(12)
    addresses = [registers[name].address for name in ("camera", "forward", "right", "up", "light")]
    neighbours = [address ^ 1 << place for address in addresses for place in range(address_bits(12))]
    model, bases, lights = CameraWords(config), set(), set()
    for cycle in range(4 * CYCLES):
        place = {axis: int(random.choice([*EXTREMES, random.integers(WORLD_SIZE)])) for axis in AXES}
        data = registers["camera"].pack(**place) if random.random() < 0.5 else None
        inputs = random_bus(random, addresses * 10 + neighbours, data)
        inputs["reset"] = int(cycle == 0 or random.random() < 0.01)
        leaf.case(inputs)
        word = model.by_address.get(inputs["bus_address"])
        wanted = by_axis("camera_", model.position) | {"readback": word.shadow if word else None}
        wanted |= basis_inputs(model.basis) if turn else {}
        if light:
            live = registers["light"].unpack(model["light"].live)
            wanted |= named("camera_light", live)
            lights.add(tuple(live.values()))
        leaf.expect(wanted)
        bases.add(model.basis)
        for address, word in model.by_address.items():
            if inputs["reset"]:
                word.reset()
            else:
                word.clock(inputs, inputs["bus_address"] == address)
    assert set(leaf.seen) == set(leaf.expected[0])
    leaf.check(settled=1)
    assert UNTURNED in bases
    assert (len(bases) > 50) == turn
    assert (len(lights) > 50) == light


@by(number=[0, 3])
def test_rect_slot(number, leaf_of, random):
    """The bank of each copy, and whether it is usable, after writes, commits and frames in any order."""
    ports = {"bus": lambda: SceneBus(7), "copies": Copies, "index": 2, "number": 2, "bank": BANK_BITS}
    leaf = leaf_of(rect_slot, **ports)
    # Each copy is its bank, with a bit above that says whether it is usable.
    usable_bit = 1 << BANK_BITS
    model, bad = Word(EVERY_BIT), False
    for cycle in range(2 * CYCLES):
        inputs = {"reset": int(cycle == 0 or random.random() < 0.05)}
        inputs |= {name: int(random.random() < 0.3) for name in ("bus_commit", "bus_go_live")}
        inputs |= {"storing": int(random.random() < 0.4), "index": int(random.choice([number, random.integers(4)]))}
        inputs |= {"number": number, "bank": int(random.integers(BANKS))}
        inputs |= {name: int(random.integers(2)) for name in ("enable", "flat")}
        copies = {f"copies_{stage}": getattr(model, stage) % usable_bit for stage in ("shadow", "pending", "live")}
        leaf.case(inputs, copies | {"usable": model.live >= usable_bit, "bad": bad})
        storing = bool(inputs["storing"] and inputs["index"] == number)
        good = usable_bit if inputs["enable"] and inputs["flat"] else 0
        if inputs["reset"]:
            model.reset()
            bad = False
        else:
            model.clock({**inputs, "bus_write": 1, "bus_data": inputs["bank"] | good, "bus_mask": EVERY_BIT}, storing)
            bad = bool(inputs["enable"] and not inputs["flat"]) if storing else bad
    leaf.check(settled=1)


SORTED_LOOKS = [
    {"engine": "exact"}, {"engine": "exact", "materials": True}, {"engine": "span", "patterns": True},
    {"engine": "exact", "materials": True, "patterns": True},
]  # fmt: skip


@pytest.mark.parametrize("options", SORTED_LOOKS, ids=label)
def test_rect_sorter(options, leaf_of, random):
    """Rectangles on each axis with corners in any order, and every look."""
    config = sized(1, **options)
    leaf = leaf_of(rect_sorter, config, written=lambda: WrittenRect(config))
    names, cell = Table(config).names, register_map(1)["rectangle[0].pattern"].fields["cell"]
    for _ in range(150):
        table, words = rectangle_words(random)
        for index, written in enumerate(words):
            if table.axes[index] >= 0:
                leaf.case({f"written_{name}": word for name, word in zip(names, written, strict=False)})
                leaf.expect(sorted_rect(table, index, "rect", config))
                if config.patterns and random.random() < 0.2:
                    # Cells as large as the world or larger have no pattern.
                    size = int(random.integers(6, 8))
                    others = written[-1] & ~((1 << cell.width) - 1 << cell.lsb)
                    leaf.stimulus[-1][f"written_{names[3]}"] = others | size << cell.lsb
                    leaf.expect({"rect_kind": 0, "rect_cell": size})
    assert {rect["rect_axis"] for rect in leaf.expected.values()} == {0, 1, 2}
    leaf.check()


FIELDS = [field.name for field in dataclasses.fields(FixedRectangle)]

LOOKS = {"materials": ("mirror",), "patterns": ("kind", "cell", "colour_2")}
"""Fields of each option."""


@pytest.mark.slow_sets("2-", "7", "8")
@pytest.mark.parametrize("engine", ["seed", "exact"])
@pytest.mark.parametrize(
    ("count", "alike", "options"),
    [
        *((count, count == 12, {}) for count in (1, 2, 7, 8, 12, 32)),
        (7, False, {"materials": True}),
        (3, False, {"patterns": True}),
        (8, True, {"materials": True, "patterns": True}),
    ],
    ids=["1", "2", "7", "8", "12-alike", "32", "7-materials", "3-patterns", "8-alike-materials-patterns"],
)  # fmt: skip
def test_rect_rom(count, alike, options, engine, leaf_of, random):
    """Each fetched rectangle in the next cycle; the port keeps the last one."""
    config = fixed_config(count, engine, False, alike, **options)
    leaf = leaf_of(rect_rom, config)
    left_out = [name for option, names in LOOKS.items() if option not in options for name in names]
    fields = [name for name in FIELDS if name not in left_out]
    assert set(leaf.seen) == {f"rects_rect_{name}" for name in fields}
    shown = {}
    for _ in range(300):
        index, fetch = int(random.integers(count)), int(random.integers(2))
        leaf.case({"rects_index": index, "rects_fetch": fetch}, shown)
        now = {f"rects_rect_{name}": getattr(config.fixed.rectangles[index], name) for name in fields}
        shown = now if fetch else shown
    leaf.check(settled=8)


@by(engine=["seed", "exact"])
def test_rect_rom_needs_no_registers_for_equal_fields(engine, tmp_path):
    """With all rectangles on one axis, its two bits need no registers; a single rectangle needs none at all."""
    for count, alike in ((12, True), (1, False)):
        config = fixed_config(count, engine, False, alike)
        directory = tmp_path / str(count)
        directory.mkdir()
        Bench(rect_rom, directory, config)
        run_yosys(directory, "alike", ["read_verilog rect_rom.v", "synth -top rect_rom", "tee -o stat.txt stat"])
        kinds = re.findall(r"^ +(\d+) .*_DFF\w*_|\$_DFF\w*_ +(\d+)", (directory / "stat.txt").read_text(), re.M)
        registers = sum(int(number) for pair in kinds for number in pair if number)
        most = sum(varying_bits([getattr(one, name) for one in config.fixed.rectangles]).bit_count() for name in FIELDS)
        assert registers <= most, repeat()
        assert (registers > 0) == (count > 1)
