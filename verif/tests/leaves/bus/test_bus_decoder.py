# SPDX-License-Identifier: MIT
"""Leaf tests of `bus_decoder`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from vectors import any_word, ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.memory_map import BUTTONS, MEMORY_WORDS, RAY_TRACER, UART
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.common.interfaces import Access, ProcessorBus
from raycaster.rtl.common.widths import WORD_BITS


@pytest.mark.parametrize("tracer_address_bits", [5, 6])
def test_bus_decoder(tracer_address_bits, tmp_path, random):
    asked = ("memory", "tracer", "uart")
    words, readies = [f"{name}_word" for name in (*asked, "buttons")], [f"{name}_ready" for name in asked]
    leaf = Leaf(bus_decoder, lambda: ports(
        "", bus=ProcessorBus(), **{name: Access() for name in asked}, buttons_word=unsigned(WORD_BITS),
        tracer_address_bits=tracer_address_bits
    ), tmp_path)  # fmt: skip
    tracer_end = RAY_TRACER + (4 << tracer_address_bits)
    edges = [0, 4 * MEMORY_WORDS, RAY_TRACER, tracer_end, BUTTONS, UART, 1 << WORD_BITS]
    # Addresses next to every edge, and with one wrong bit.
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
            assert output[f"{name}_select"] == int(valid and owner == name), hex(address)
        if valid:
            assert output["bus_ready"] == inputs.get(f"{owner}_ready", 1), hex(address)
            assert output["bus_word"] == inputs.get(f"{owner}_word", 0), hex(address)
