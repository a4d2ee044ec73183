# SPDX-License-Identifier: MIT
"""Leaf tests of `tmds_encoder`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import random

from raycaster.golden.tmds import Sample, encode
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.dvi.tmds_encoder import SYMBOL_BITS, tmds_encoder
from raycaster.verif.seeds import repeat, seed


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
        # Runs of one byte, or of a few different bytes, lead far from balance.
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
