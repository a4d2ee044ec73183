# SPDX-License-Identifier: MIT
"""Leaf tests of the DVI encoder and its parts."""

import random

from vectors import by

from raycaster.configuration import CHANNEL_BITS
from raycaster.golden.tmds import Sample, encode
from raycaster.hdl.signals import bit
from raycaster.rtl.common.interfaces import Vga
from raycaster.rtl.dvi.dvi_encoder import dvi_encoder
from raycaster.rtl.dvi.tmds_encoder import SYMBOL_BITS, tmds_encoder
from raycaster.verif.seeds import seed


def test_tmds_encoder(leaf_of):
    leaf = leaf_of(tmds_encoder, data=8, control=2, symbol=SYMBOL_BITS)
    rng = random.Random(seed())
    samples = [Sample(False, 0, 0)] * 2
    for _ in range(60):
        samples += [Sample(False, rng.randrange(256), rng.randrange(4)) for _ in range(rng.randrange(1, 4))]
        # Runs of one byte, or of a few different bytes, lead far from balance.
        few = [rng.randrange(256) for _ in range(rng.choice([1, 2, 256]))]
        samples += [Sample(True, rng.choice(few), rng.randrange(4)) for _ in range(rng.randrange(60))]
    taken = []
    for sample in samples:
        ports = {"data": sample.data, "control": sample.control, "visible": sample.visible}
        for _ in range(rng.choice([0, 1, 1, 2])):
            leaf.case({**ports, "enable": 0, "data": rng.randrange(256)})
        taken.append(leaf.cycle)
        leaf.case({**ports, "enable": 1})
    for cycle, symbol in zip(taken[1:], encode(samples), strict=False):
        leaf.expected[cycle]["symbol"] = symbol
    leaf.stimulus += leaf.stimulus[-1:] * 2
    leaf.check(latency=1, settled=taken[1] + 1)


@by(clocks_per_pixel=[1, 2])
def test_dvi_encoder(clocks_per_pixel, leaf_of):
    """Each symbol is shown during the clocks of a pixel, two pixels late; only blue carries the syncs."""
    rng = random.Random(seed())
    pixels = []
    for _ in range(30):
        for visible in (0, 1):
            for _ in range(rng.randrange(1, 20)):
                ports = {f"vga_{name}": rng.randrange(256) for name in "rgb"}
                pixels.append(ports | {"vga_hs": rng.randrange(2), "vga_vs": rng.randrange(2), "vga_blank_n": visible})
    symbols = dict.fromkeys(("blue", "green", "red"), SYMBOL_BITS)
    leaf = leaf_of(dvi_encoder, vga=lambda: Vga(CHANNEL_BITS), **symbols, pixel=bit)
    for pixel in pixels:
        for clock in range(clocks_per_pixel):
            leaf.case({**pixel, "pixel_end": clock == clocks_per_pixel - 1})
    for channel in symbols:
        samples = [
            Sample(p["vga_blank_n"], p[f"vga_{channel[0]}"], (p["vga_vs"] << 1 | p["vga_hs"]) * (channel == "blue"))
            for p in pixels
        ]
        for place, symbol in enumerate(list(encode(samples))[:-2]):
            for clock in range(clocks_per_pixel):
                leaf.expected[clocks_per_pixel * (place + 2) + clock] |= {channel: symbol, "pixel": place % 2}
    leaf.check()  # pixel goes on from its value at power-up
