# SPDX-License-Identifier: MIT
"""Leaf test of `bus_decoder`: addresses next to every edge, with one wrong bit, and anywhere."""

import pytest
from vectors import any_word

from raycaster.memory_map import BUTTONS, MEMORY_WORDS, RAY_TRACER, UART
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.common.interfaces import Access, ProcessorBus
from raycaster.rtl.common.widths import WORD_BITS


@pytest.mark.parametrize("tracer_address_bits", [5, 6])
def test_bus_decoder(tracer_address_bits, leaf_of, random):
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
