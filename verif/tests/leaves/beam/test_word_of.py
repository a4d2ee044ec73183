# SPDX-License-Identifier: MIT
"""Leaf tests of `word_of`: MyHDL and converted Verilog match the expected values on the same vectors."""

from beam_vectors import beam_config
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import facet_of


def test_word_of(tmp_path, random):
    config = beam_config(screen="tiny")
    bits = len(facet_of(config).word)
    leaf = Leaf(word_of, lambda: ports("", record=facet_of(config), word=unsigned(bits)), tmp_path)
    words = [int.from_bytes(random.bytes(8)) % (1 << bits) for _ in range(50)]
    layout = facet_of(config)
    stimulus = [
        {f"record_{name}": w >> layout.slice(name)[1] & (1 << int(b)) - 1 for name, b in layout.layout.items()}
        for w in words
    ]
    assert [output["word"] for output in leaf.run_both(stimulus)] == words
