# SPDX-License-Identifier: MIT
"""Leaf tests of `word_of`: MyHDL and converted Verilog match the expected values on the same vectors."""

from beam_vectors import any_facets, beam_config
from vectors import check, leaf_of, named

from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import facet_of


def test_word_of(tmp_path, random):
    """A record as one word, its first field in the highest bits."""
    config = beam_config(screen="tiny", rectangles=1)
    leaf = leaf_of(word_of, tmp_path, record=lambda: facet_of(config), word=len(facet_of(config).word))
    cases = [any_facets(random, config) for _ in range(50)]
    stimulus = [named("record", facet) for (facet,), _ in cases]
    check(leaf, stimulus, [{"word": word} for _, word in cases])
