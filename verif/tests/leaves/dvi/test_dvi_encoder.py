# SPDX-License-Identifier: MIT
"""Leaf tests of `dvi_encoder`: MyHDL and converted Verilog match the expected values on the same vectors."""

import random

import pytest
from vectors import check

from raycaster.golden.tmds import Sample, encode
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.dvi.dvi_encoder import dvi_encoder
from raycaster.rtl.system.ports import dvi_ports
from raycaster.verif.seeds import seed


@pytest.mark.parametrize("clocks_per_pixel", [1, 2])
def test_dvi_encoder(clocks_per_pixel, tmp_path):
    """Each symbol is shown during the clocks of a pixel, two pixels late; only blue carries the syncs."""
    rng = random.Random(seed())
    pixels = []
    for _ in range(30):
        for visible in (0, 1):
            for _ in range(rng.randrange(1, 20)):
                ports = {f"vga_{name}": rng.randrange(256) for name in "rgb"}
                pixels.append(ports | {"vga_hs": rng.randrange(2), "vga_vs": rng.randrange(2), "vga_blank_n": visible})
    clocks = range(clocks_per_pixel)
    stimulus = [
        {**pixel, "pixel_end": clock == clocks[-1], "ready": place > 0}
        for place, pixel in enumerate(pixels)
        for clock in clocks
    ]
    symbols = {
        channel: encode(
            [
                Sample(p["vga_blank_n"], p[f"vga_{channel[0]}"], (p["vga_vs"] << 1 | p["vga_hs"]) * (channel == "blue"))
                for p in pixels
            ]
        )
        for channel in ("blue", "green", "red")
    }
    shown = [dict(zip(symbols, each, strict=True)) for each in zip(*symbols.values(), strict=True)][:-2]
    expected = {
        clocks_per_pixel * (place + 2) + clock: {**each, "pixel": (place + 1) % 2}
        for place, each in enumerate(shown)
        for clock in clocks
    }
    check(Leaf(dvi_encoder, dvi_ports, tmp_path), stimulus, expected, settled=2 * clocks_per_pixel)
