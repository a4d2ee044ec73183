# SPDX-License-Identifier: MIT
"""Leaf test of `tmds_encoder`."""

import random

from raycaster.golden.tmds import Sample, encode
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
