# SPDX-License-Identifier: MIT
"""Leaf tests of `tmds_encoder`: MyHDL and converted Verilog match the expected values on the same vectors."""

import random

from vectors import check, leaf_of

from raycaster.golden.tmds import Sample, encode
from raycaster.rtl.dvi.tmds_encoder import SYMBOL_BITS, tmds_encoder
from raycaster.verif.seeds import seed


def test_tmds_encoder(tmp_path):
    leaf = leaf_of(tmds_encoder, tmp_path, data=8, control=2, symbol=SYMBOL_BITS)
    rng = random.Random(seed())
    samples = [Sample(False, 0, 0)] * 2
    for _ in range(60):
        samples += [Sample(False, rng.randrange(256), rng.randrange(4)) for _ in range(rng.randrange(1, 4))]
        # Runs of one byte, or of a few different bytes, lead far from balance.
        few = [rng.randrange(256) for _ in range(rng.choice([1, 2, 256]))]
        samples += [Sample(True, rng.choice(few), rng.randrange(4)) for _ in range(rng.randrange(60))]
    stimulus, taken = [], []
    for sample in samples:
        ports = {"data": sample.data, "control": sample.control, "visible": sample.visible}
        for _ in range(rng.choice([0, 1, 1, 2])):
            stimulus.append({**ports, "enable": 0, "data": rng.randrange(256)})
        taken.append(len(stimulus))
        stimulus.append({**ports, "enable": 1})
    expected = {cycle: {"symbol": symbol} for cycle, symbol in zip(taken[1:], encode(samples), strict=False)}
    check(leaf, [*stimulus, *stimulus[-1:] * 2], expected, latency=1, settled=taken[1] + 1)
