# SPDX-License-Identifier: MIT
"""TMDS: the golden code, and the encoder in MyHDL's simulator and the converted Verilog."""

from __future__ import annotations

import random
from collections import deque

import pytest

from raycaster.golden.tmds import CONTROL_SYMBOLS, Sample, decode, encode, minimise_transitions
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.dvi.dvi_encoder import dvi_encoder
from raycaster.rtl.dvi.ones_count import ones_count
from raycaster.rtl.dvi.tmds_encoder import DISPARITY_BITS, SYMBOL_BITS, tmds_encoder
from raycaster.rtl.system.ports import dvi_ports
from raycaster.verif.leaf import Leaf
from raycaster.verif.seeds import repeat, seed


def test_every_byte_at_every_disparity_decodes():
    """All that can be sent, by following every byte from every disparity that is reached."""
    found, reached, todo = set(), {0: ()}, deque([0])
    while todo:
        path = reached[todo.popleft()]
        for data in range(256):
            *_, symbol = encode(Sample(True, byte, 0) for byte in (*path, data))
            assert decode(symbol) == Sample(True, data, 0)
            found.add(symbol)
            balance = sum(2 * one.bit_count() - 10 for one in encode(Sample(True, byte, 0) for byte in (*path, data)))
            if balance not in reached:
                reached[balance] = (*path, data)
                todo.append(balance)
    assert set(reached) == set(range(-8, 9, 2))
    # The sum of half of it and of half a word's excess, which is at most 4.
    assert max(reached) // 2 + 4 < 1 << DISPARITY_BITS - 1
    assert len(found) == 460
    assert not found & set(CONTROL_SYMBOLS)
    refused = 0
    for symbol in set(range(1 << SYMBOL_BITS)) - set(CONTROL_SYMBOLS):
        try:
            decode(symbol)
        except ValueError:
            refused += 1
            assert symbol not in found
    # All but each byte's word and its complement.
    assert refused == (1 << SYMBOL_BITS) - len(CONTROL_SYMBOLS) - 512


def test_known_symbols():
    """Zero and all ones from a balanced start: XOR keeps zeros as they are, and XNOR turns all ones into all ones."""
    assert list(encode([Sample(True, 0, 0)] * 3)) == [0b0100000000, 0b1111111111, 0b0100000000]
    assert list(encode([Sample(True, 255, 0)] * 3)) == [0b1000000000, 0b0011111111, 0b0011111111]
    assert [decode(symbol).control for symbol in CONTROL_SYMBOLS] == [0, 1, 2, 3]


def test_transitions_are_few():
    for data in range(256):
        low = minimise_transitions(data) & 0xFF
        assert (low ^ low >> 1 & 0x7F).bit_count() - (low >> 7) <= 4


def test_ones_count(tmp_path):
    leaf = Leaf(ones_count, lambda: {"bits": unsigned(8), "count": unsigned(4)}, tmp_path)
    outputs = leaf.run_both([{"bits": bits} for bits in range(256)])
    assert [output["count"] for output in outputs] == [bits.bit_count() for bits in range(256)]


def test_tmds_encoder(tmp_path):
    leaf = Leaf(
        tmds_encoder,
        lambda: {
            "clk": bit(),
            "enable": bit(),
            "data": unsigned(8),
            "control": unsigned(2),
            "visible": bit(),
            "symbol": unsigned(SYMBOL_BITS),
        },
        tmp_path,
    )
    rng = random.Random(seed())
    samples = [Sample(False, 0, 0)] * 2
    for _ in range(60):
        samples += [Sample(False, rng.randrange(256), rng.randrange(4)) for _ in range(rng.randrange(1, 4))]
        # Runs of one byte, and of few different ones, lead far from balance.
        few = [rng.randrange(256) for _ in range(rng.choice([1, 2, 256]))]
        samples += [Sample(True, rng.choice(few), rng.randrange(4)) for _ in range(rng.randrange(60))]
    stimulus, taken = [], []
    for sample in samples:
        ports = {"data": sample.data, "control": sample.control, "visible": int(sample.visible)}
        for _ in range(rng.choice([0, 1, 1, 2])):
            stimulus.append({**ports, "enable": 0, "data": rng.randrange(256)})
        taken.append(len(stimulus))
        stimulus.append({**ports, "enable": 1})
    outputs = leaf.run_both([*stimulus, *stimulus[-1:] * 3], settled=taken[1] + 1)
    for place, symbol in zip(taken[1:], encode(samples), strict=False):
        assert outputs[place + 1]["symbol"] == symbol, (place, repeat())


@pytest.mark.parametrize("clocks_per_pixel", [1, 2])
def test_dvi_encoder(clocks_per_pixel, tmp_path):
    leaf = Leaf(dvi_encoder, dvi_ports, tmp_path)
    rng = random.Random(seed())
    pixels = []
    for _ in range(30):
        for visible in (0, 1):
            for _ in range(rng.randrange(1, 20)):
                ports = {f"vga_{name}": rng.randrange(256) for name in "rgb"}
                pixels.append(ports | {"vga_hs": rng.randrange(2), "vga_vs": rng.randrange(2), "vga_blank_n": visible})
    halves = range(clocks_per_pixel)
    stimulus = [
        {**pixel, "pixel_end": int(half == halves[-1]), "ready": int(place > 0)}
        for place, pixel in enumerate(pixels)
        for half in halves
    ]
    outputs = leaf.run_both(stimulus, settled=2 * clocks_per_pixel)
    links = {
        "blue": [Sample(p["vga_blank_n"], p["vga_b"], p["vga_vs"] << 1 | p["vga_hs"]) for p in pixels],
        "green": [Sample(p["vga_blank_n"], p["vga_g"], 0) for p in pixels],
        "red": [Sample(p["vga_blank_n"], p["vga_r"], 0) for p in pixels],
    }
    for channel, samples in links.items():
        for place, symbol in enumerate(list(encode(samples))[:-2]):
            first = clocks_per_pixel * (place + 2)
            shown = outputs[first : first + clocks_per_pixel]
            assert all(output[channel] == symbol for output in shown), (channel, place, repeat())
            assert {output["pixel"] for output in shown} == {(place + 1) % 2}
