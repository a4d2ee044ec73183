# SPDX-License-Identifier: MIT
"""What stands around a processor: MyHDL's simulator, the converted Verilog and a model on one stimulus."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from raycaster.memory_map import BUTTON_NAMES, BUTTONS, INTERRUPT_BIT, MEMORY_WORDS, RAY_TRACER, UART, clocks_per_bit
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.interfaces import Access, AvalonPort, ProcessorBus
from raycaster.rtl.common.widths import LANES, WORD_BITS, bit, bits_for, unsigned
from raycaster.rtl.system.button_port import button_port
from raycaster.rtl.system.uart_transmitter import DATA_BITS, FRAME_BITS, uart_transmitter
from raycaster.verif.leaf import Leaf, reset_signal
from raycaster.verif.seeds import repeat, seed

EVERY_LANE = (1 << LANES) - 1


def any_word(random: np.random.Generator) -> int:
    return int(random.integers(1 << WORD_BITS))


def any_strobe(random: np.random.Generator) -> int:
    """A read as often as not."""
    return int(random.integers(1, EVERY_LANE + 1)) if random.random() < 0.5 else 0


def mask_of(strobe: int) -> int:
    return sum(0xFF << 8 * lane for lane in range(LANES) if strobe >> lane & 1)


# word_memory ----------------------------------------------------------------------------------------------------------


def memory_leaf(words: int, program: str, directory: Path) -> Leaf:
    return Leaf(
        word_memory,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "access": Access(),
            "strobe": unsigned(LANES),
            "address": unsigned(bits_for(words)),
            "data": unsigned(WORD_BITS),
            "words": words,
            "program": program,
        },
        directory,
    )


@pytest.mark.parametrize("words", [16, 64])
def test_word_memory(words, tmp_path):
    random = np.random.default_rng(seed())
    model = [any_word(random) for _ in range(words)]
    program = tmp_path / "program.hex"
    program.write_text("".join(f"{word:08x}\n" for word in model))
    leaf = memory_leaf(words, str(program), tmp_path)
    assert f'$readmemh("{program}", memory);' in leaf.verilog[-1].read_text()
    # Reset in the first cycle of an access starts that anew; the first read makes `word` known.
    stimulus = [{"reset": 1, "access_select": 1, "strobe": 0, "address": 3}, {"reset": 0}, {}]
    expected = {2: model[3]}
    for _ in range(20 * words):
        if random.random() < 0.3:
            stimulus.append({"access_select": 0, "strobe": any_strobe(random), "data": any_word(random)})
            continue
        strobe, address, data = any_strobe(random), int(random.integers(words)), any_word(random)
        stimulus += [{"access_select": 1, "strobe": strobe, "address": address, "data": data}, {}]
        mask = mask_of(strobe)
        model[address] = model[address] & ~mask | data & mask
        expected[len(stimulus) - 1] = None if strobe else model[address]
    outputs = leaf.run_both(stimulus, settled=2)
    for cycle, output in enumerate(outputs[2:], 2):
        assert output["access_ready"] == (cycle in expected), (cycle, repeat())
        if expected.get(cycle) is not None:
            assert output["access_word"] == expected[cycle], (cycle, repeat())


def test_word_memory_without_a_program(tmp_path):
    """It converts all the same: the file is only looked for where the Verilog runs."""
    leaf = memory_leaf(8, "nowhere.hex", tmp_path)
    assert '$readmemh("nowhere.hex", memory);' in leaf.verilog[-1].read_text()
    outputs = leaf.run_myhdl([{"reset": 1}, {"reset": 0, "access_select": 1}, {}])
    assert outputs[-1] == {"access_ready": 1, "access_word": 0}


# avalon_host ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("patience", "latency"), [(0.0, 1), (0.3, 4), (0.8, 9)])
def test_avalon_host(patience, latency, tmp_path):
    """Every access is one transfer, whatever the agent's waitrequest and however late its answers."""
    address_bits = 6
    leaf = Leaf(
        avalon_host,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "access": Access(),
            "strobe": unsigned(LANES),
            "address": unsigned(address_bits),
            "data": unsigned(WORD_BITS),
            "avm_m0": AvalonPort(address_bits),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [{"reset": 1}]
    expected = [{}]
    request = None  # strobe, address, data
    answer_in = None  # cycles until a read that was taken is answered
    for _ in range(1000):
        if request is None and random.random() < 0.7:
            request = any_strobe(random), int(random.integers(1 << address_bits)), any_word(random)
        strobe, address, data = request or (any_strobe(random), 0, 0)
        wait, word = int(random.random() < patience), any_word(random)
        answered = answer_in == 0
        reading, writing = request is not None and strobe == 0, request is not None and strobe != 0
        stimulus.append(
            {
                "reset": 0,
                "access_select": int(request is not None),
                "strobe": strobe,
                "address": address,
                "data": data,
                "avm_m0_readdata": word,
                "avm_m0_readdatavalid": int(answered),
                "avm_m0_waitrequest": wait,
            }
        )
        read = reading and answer_in is None
        outputs = {
            "access_ready": int(answered or (writing and not wait)),
            "avm_m0_read": int(read),
            "avm_m0_write": int(writing),
        }
        if answered:
            outputs["access_word"] = word
        if read or writing:
            outputs |= {"avm_m0_address": address, "avm_m0_byteenable": strobe or EVERY_LANE}
        if writing:
            outputs["avm_m0_writedata"] = data
        expected.append(outputs)
        if outputs["access_ready"]:
            request = answer_in = None
        elif answer_in is not None:
            answer_in -= 1
        elif read and not wait:
            answer_in = int(random.integers(latency))
    for cycle, (output, wanted) in enumerate(zip(leaf.run_both(stimulus, settled=1), expected, strict=True)):
        assert wanted.items() <= output.items(), (cycle, repeat())


# uart_transmitter -----------------------------------------------------------------------------------------------------


def test_clocks_per_bit():
    """A receiver takes a few per cent."""
    assert [clocks_per_bit(hz) for hz in (50_000_000, 25_000_000, 6_000_000)] == [434, 217, 52]


@pytest.mark.parametrize("clocks", [2, 5, 16])
def test_uart_transmitter(clocks, tmp_path):
    leaf = Leaf(
        uart_transmitter,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "access": Access(),
            "strobe": unsigned(LANES),
            "data": unsigned(DATA_BITS),
            "uart_tx": bit(),
            "clocks_per_bit": clocks,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [{"reset": 1}]
    line, busy, ready = [None], [None], [None]
    request, sending = None, []  # levels of the line that are still due
    for _ in range(400 * clocks):
        if request is None and random.random() < 0.1:
            request = any_strobe(random), int(random.integers(1 << DATA_BITS))
        strobe, data = request or (any_strobe(random), 0)
        reset = int(random.random() < 0.2 / (FRAME_BITS * clocks))
        stimulus.append({"reset": reset, "access_select": int(request is not None), "strobe": strobe, "data": data})
        writes = request is not None and strobe & 1
        line.append(sending[0] if sending else 1)
        busy.append(int(bool(sending)))
        ready.append(int(request is not None and not (writes and sending)))
        if ready[-1]:
            request = None
        if reset:
            sending = []
        elif sending:
            sending = sending[1:]
        elif writes:
            levels = [0, *(data >> index & 1 for index in range(DATA_BITS)), 1]
            sending = [level for level in levels for _ in range(clocks)]
    for cycle, output in enumerate(leaf.run_both(stimulus, settled=1)):
        if cycle:
            wanted = {"uart_tx": line[cycle], "access_word": busy[cycle], "access_ready": ready[cycle]}
            assert output == wanted, (cycle, repeat())


# button_port ----------------------------------------------------------------------------------------------------------


def test_button_port(tmp_path):
    leaf = Leaf(
        button_port,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "buttons": unsigned(len(BUTTON_NAMES)),
            "irq": bit(),
            "word": unsigned(WORD_BITS),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [
        {"reset": int(cycle == 0 or random.random() < 0.05)}
        | {"buttons": int(random.integers(1 << len(BUTTON_NAMES))), "irq": int(random.integers(2))}
        for cycle in range(300)
    ]
    for cycle, output in enumerate(leaf.run_both(stimulus, settled=1)):
        if cycle > 1:
            before, last = stimulus[cycle - 2 : cycle]
            held = 0 if before["reset"] or last["reset"] else before["buttons"]
            assert output["word"] == held | stimulus[cycle]["irq"] << INTERRUPT_BIT, (cycle, repeat())


# bus_decoder ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tracer_address_bits", [5, 6])
def test_bus_decoder(tracer_address_bits, tmp_path):
    asked = ("memory", "tracer", "uart")
    words, readies = [f"{name}_word" for name in (*asked, "buttons")], [f"{name}_ready" for name in asked]
    leaf = Leaf(
        bus_decoder,
        lambda: {
            "bus": ProcessorBus(),
            **{name: Access() for name in asked},
            "buttons_word": unsigned(WORD_BITS),
            "tracer_address_bits": tracer_address_bits,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    tracer_end = RAY_TRACER + (4 << tracer_address_bits)
    edges = [0, 4 * MEMORY_WORDS, RAY_TRACER, tracer_end, BUTTONS, UART, 1 << WORD_BITS]
    # Next to every edge, and where one bit of an address is wrong.
    addresses = [(edge + 4 * step) % (1 << WORD_BITS) for edge in edges for step in (-2, -1, 0, 1, 2)]
    addresses += [edge ^ 1 << index for edge in edges[:-1] for index in range(2, WORD_BITS)]
    addresses += 30 * edges[:-1]
    addresses += [4 * int(random.integers(1 << WORD_BITS - 2)) for _ in range(200)]
    stimulus = []
    for address in addresses:
        cycle = {"bus_address": address, "bus_valid": int(random.random() < 0.8)}
        cycle |= {name: any_word(random) for name in words}
        cycle |= {name: int(random.integers(2)) for name in readies}
        stimulus.append(cycle)
    for inputs, output in zip(stimulus, leaf.run_both(stimulus), strict=True):
        address, valid = inputs["bus_address"], inputs["bus_valid"]
        if address < 4 * MEMORY_WORDS:
            owner = "memory"
        elif RAY_TRACER <= address < tracer_end:
            owner = "tracer"
        else:
            owner = {BUTTONS: "buttons", UART: "uart"}.get(address, "")
        for name in asked:
            assert output[f"{name}_select"] == int(valid and owner == name), (hex(address), repeat())
        if valid:
            assert output["bus_ready"] == inputs.get(f"{owner}_ready", 1), (hex(address), repeat())
            assert output["bus_word"] == inputs.get(f"{owner}_word", 0), (hex(address), repeat())
