# SPDX-License-Identifier: MIT
"""Leaf tests of `dvi_encoder`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import random

import pytest

from raycaster.golden.tmds import Sample, encode
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.dvi.dvi_encoder import dvi_encoder
from raycaster.rtl.system.ports import dvi_ports
from raycaster.verif.seeds import repeat, seed


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
