# SPDX-License-Identifier: MIT
"""Leaf test of `word_of`: a record as one word, its first field in the highest bits."""

from beam_vectors import any_facets, beam_config
from vectors import named

from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import Facet


def test_word_of(leaf_of, random):
    config = beam_config(screen="tiny", rectangles=1)
    leaf = leaf_of(word_of, record=lambda: Facet(config), word=len(Facet(config).word))
    for _ in range(50):
        [facet], word = any_facets(random, config)
        leaf.case(named("record", facet), {"word": word})
    leaf.check()
