# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks at a bus: registers, a memory, and the decoder of addresses."""

import pytest
from scene_vectors import EVERY_BIT, sized
from vectors import any_strobe, any_word, designs, named

from raycaster.hdl.signals import bits_for
from raycaster.memory_map import BUTTONS, MEMORY_WORDS, RAY_TRACER, UART
from raycaster.registers import address_bits, register_map
from raycaster.rtl.bus.avalon_interface import avalon_interface
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.bus.frame_registers import frame_registers
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.interfaces import Access, AvalonPort, FrameEvents, ProcessorBus, SceneBus
from raycaster.rtl.common.widths import CYCLE_BITS, LANES, WORD_BITS
from raycaster.sim.register_model import Agent


@designs(
    sized(12),
    sized(1, reflections=0, fraction_bits=8, rounding="nearest", divider_bits=3, colour_bits=4),
    sized(32, reflections=2, units=320, rows=200),
    sized(2, engine="exact", turn=True, patterns=True),
    sized(2, engine="exact", materials=True),
    sized(100, engine="span"),
)
def test_avalon_interface(config, leaf_of, random):
    """Any transfers, resets and counts of cycles; all outputs are those of the register model."""
    width = address_bits(*config.map)
    words = dict.fromkeys(("camera_readback", "rect_readback"), WORD_BITS)
    leaf, agent = leaf_of(avalon_interface, config, avs_s0=lambda: AvalonPort(width), **words), Agent(config)
    registers = [one.address for name, one in agent.registers.items() if not name.startswith(("rectangle", "frames"))]
    elsewhere = agent.registers["frames.cycles"].address if config.facts.whole_frames else 1 << width
    control = agent.registers["control"]
    row, group, committing = 0, 0, False
    for cycle in range(7500):
        # Counts mostly stay near the previous ones, a little above or below.
        row, group = (max(0, value + int(random.integers(-9, 10))) % (1 << CYCLE_BITS) for value in (row, group))
        if random.random() < 0.05:
            row = int(random.choice([0, 1, random.integers(1 << CYCLE_BITS), (1 << CYCLE_BITS) - 1]))
            group = int(random.integers(1 << int(random.integers(1, CYCLE_BITS + 1))))
        # After 3000 cycles: enough frames without a reset to change the counter's upper bits.
        busy_bus = cycle < 3000
        address = int(random.choice([*registers, control.address, int(random.integers(elsewhere))]))
        # Ones and zeros in the write-1-to-clear bits, and often a commit.
        data = int(random.choice([0, 1, 2, 4, 6, 0x303, 0x102, EVERY_BIT, random.integers(1 << WORD_BITS)]))
        transfer = random.choice(["read", "write", "none"], p=[0.4, 0.4, 0.2])
        # Reset often while a commit is in flight.
        reset = random.random() < (0.1 if committing else 0.003)
        committing = transfer == "write" and address == control.address
        inputs = {
            "reset": int(cycle < 2 or (busy_bus and reset)),
            "avs_s0_address": address,
            "avs_s0_read": transfer == "read",
            "avs_s0_write": transfer == "write",
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
        if config.facts.whole_frames:
            inputs["progress_take_scene"] = int(inputs["progress_start_screen"] and random.random() < 0.7)
            inputs = {name: value for name, value in inputs.items() if name in leaf.given}
        waits = cycle and leaf.stimulus[-1]["reset"]
        leaf.case(inputs, agent.outputs(inputs) | {"avs_s0_waitrequest": waits})
        agent.clock(inputs)
    assert set(leaf.seen) == set(leaf.expected[0])
    leaf.check(settled=1)


RECTANGLES = 2
EVENTS = {"drawn": 0.3, "shown": 0.2, "again": 0.3, "late": 0.03, "list_full": 0.1}
NONE = 0xFFFFFFFF


def test_frame_registers(leaf_of, random):
    """Events and writes in any cycle, often in the same one; bytes that are not written."""
    registers = register_map(RECTANGLES, lists=True)
    words = {name: registers[f"frames.{name}"] for name in ("cycles", "left", "counts", "status")}
    made = {"bus": lambda: SceneBus(address_bits(RECTANGLES, lists=True)), "events": FrameEvents}
    leaf = leaf_of(frame_registers, rectangles=RECTANGLES, rect_readback=WORD_BITS, readback=WORD_BITS, **made)
    initial = {"cycles": 0, "least": NONE, "drawn": 0, "again": 0, "late": 0, "list_full": 0}
    kept, both = dict(initial), set()
    leaf.case({"reset": 1})
    for _ in range(6000):
        reset, write = int(random.random() < 0.002), int(random.random() < 0.3)
        name = str(random.choice(["left", "status", "cycles", "counts", "other"], p=[0.3, 0.3, 0.15, 0.15, 0.1]))
        address = words[name].address if name in words else int(random.choice([0, 1, 0x301 ^ 0x40, 0x304]))
        data, mask = int(random.integers(1 << 32)), int(random.choice([0, NONE, 0xFF, 0xFF00]))
        events = {event: int(random.random() < chance) for event, chance in EVENTS.items()}
        # The times of 32 bits are near each other, or at their limits.
        time = int(random.choice([0, 1, NONE - 1, NONE, random.integers(100, 110)], p=[0.05, 0.05, 0.1, 0.1, 0.7]))
        traffic = named("bus", {"write": write, "address": address, "data": data, "mask": mask})
        other = int(random.integers(1 << 32))
        leaf.case({"reset": reset, **traffic, **named("events", events), "events_time": time, "rect_readback": other})
        read = {"cycles": kept["cycles"], "left": kept["least"]}
        read["counts"] = words["counts"].pack(drawn=kept["drawn"], again=kept["again"])
        read["status"] = words["status"].pack(late=kept["late"], list_full=kept["list_full"])
        leaf.expect({"readback": read.get(name, other)})
        clears = write and name == "left" and mask
        ones = data & mask if write and name == "status" else 0
        both |= {flag for number, flag in enumerate(("late", "list_full")) if ones >> number & 1 and events[flag]}
        if clears and events["shown"]:
            both.add("left")
        if events["drawn"]:
            kept["cycles"] = time
        times = [NONE if clears else kept["least"], *[time] * events["shown"], *[0] * events["late"]]
        kept["least"] = min(times)
        for count in ("drawn", "again"):
            kept[count] = (kept[count] + events[count]) % (1 << 16)
        for number, flag in enumerate(("late", "list_full")):
            kept[flag] = events[flag] or (kept[flag] and not ones >> number & 1)
        if reset:
            kept = dict(initial)
    leaf.check(settled=1, spare=True)
    assert both == {"late", "list_full", "left"}


def test_frame_counts_wrap(leaf_of):
    """Each counter wraps after 65,535; in Verilog only, as MyHDL would take too long."""
    words = register_map(RECTANGLES, lists=True)
    address = words["frames.counts"].address
    made = {"bus": lambda: SceneBus(address_bits(RECTANGLES, lists=True)), "events": FrameEvents}
    leaf = leaf_of(frame_registers, rectangles=RECTANGLES, rect_readback=WORD_BITS, readback=WORD_BITS, **made)
    both, drawn = {"events_drawn": 1, "events_again": 1}, {"events_again": 0}
    stimulus = [{"reset": 1, "bus_address": address}, {"reset": 0, **both}, *[{}] * 0xFFFE, drawn, both, {}]
    *_, last, first, second = (output["readback"] for output in leaf.run_verilog(stimulus))
    assert [last, first, second] == [0xFFFF_FFFF, 0xFFFF_0000, 0x0000_0001]


@pytest.mark.parametrize("tracer_address_bits", [5, 6])
def test_bus_decoder(tracer_address_bits, leaf_of, random):
    """Addresses next to every edge, with one wrong bit, and anywhere."""
    asked = ("memory", "tracer", "uart")
    words, readies = [f"{name}_word" for name in (*asked, "buttons")], [f"{name}_ready" for name in asked]
    ports = {"bus": ProcessorBus, **dict.fromkeys(asked, Access), "buttons_word": WORD_BITS}
    leaf = leaf_of(bus_decoder, **ports, tracer_address_bits=tracer_address_bits)
    tracer_end = RAY_TRACER + (4 << tracer_address_bits)
    edges = [0, 4 * MEMORY_WORDS, RAY_TRACER, tracer_end, BUTTONS, UART, 1 << WORD_BITS]
    addresses = [(edge + 4 * step) % (1 << WORD_BITS) for edge in edges for step in (-2, -1, 0, 1, 2)]
    addresses += [edge ^ 1 << index for edge in edges[:-1] for index in range(2, WORD_BITS)]
    addresses += 30 * edges[:-1]
    addresses += [4 * int(random.integers(1 << WORD_BITS - 2)) for _ in range(200)]
    for address in addresses:
        valid = int(random.random() < 0.8)
        inputs = {name: any_word(random) for name in words} | {name: int(random.integers(2)) for name in readies}
        leaf.case({"bus_address": address, "bus_valid": valid, **inputs})
        if address < 4 * MEMORY_WORDS:
            owner = "memory"
        elif RAY_TRACER <= address < tracer_end:
            owner = "tracer"
        else:
            owner = {BUTTONS: "buttons", UART: "uart"}.get(address, "")
        wanted = {f"{name}_select": valid and owner == name for name in asked}
        if valid:
            wanted |= {"bus_ready": inputs.get(f"{owner}_ready", 1), "bus_word": inputs.get(f"{owner}_word", 0)}
        leaf.expect(wanted)
    leaf.check()


@pytest.fixture
def memory_of(leaf_of):
    """Return a function that makes a memory, whose Verilog names the program's file."""

    def made(words: int, program: str):
        leaf = leaf_of(word_memory, address=bits_for(words), words=words, program=program)
        assert f'$readmemh("{program}", memory);' in leaf.verilog[-1].read_text()
        return leaf

    return made


@pytest.mark.parametrize("words", [16, 64])
def test_word_memory(words, memory_of, tmp_path, random):
    """Reads, and writes of any lanes, at any distance."""
    model = [any_word(random) for _ in range(words)]
    program = tmp_path / "program.hex"
    program.write_text("".join(f"{word:08x}\n" for word in model))
    leaf = memory_of(words, str(program))
    # A reset in the first cycle of an access restarts it; the first read makes `word` known.
    leaf.case({"reset": 1, "access_select": 1, "strobe": 0, "address": 3}, {"access_ready": 0})
    leaf.case({"reset": 0}, {"access_ready": 0})
    leaf.case({}, {"access_ready": 1, "access_word": model[3]})
    for _ in range(20 * words):
        if random.random() < 0.3:
            idle = {"access_select": 0, "strobe": any_strobe(random), "data": any_word(random)}
            leaf.case(idle, {"access_ready": 0})
            continue
        strobe, address, data = any_strobe(random), int(random.integers(words)), any_word(random)
        access = {"access_select": 1, "strobe": strobe, "address": address, "data": data}
        leaf.case(access, {"access_ready": 0})
        mask = sum(0xFF << 8 * lane for lane in range(LANES) if strobe >> lane & 1)
        model[address] = model[address] & ~mask | data & mask
        leaf.case({}, {"access_ready": 1, "access_word": None if strobe else model[address]})
    leaf.check(settled=2)


def test_word_memory_without_a_program(memory_of):
    """Conversion needs no program file; only running the Verilog does."""
    outputs = memory_of(8, "nowhere.hex").run_myhdl([{"reset": 1}, {"reset": 0, "access_select": 1}, {}])
    assert outputs[-1] == {"access_ready": 1, "access_word": 0}
